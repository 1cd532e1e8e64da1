#include "sightline/core/estimators/estimators.h"

#include <algorithm>
#include <stdexcept>

namespace sightline::core {
namespace {

std::unique_ptr<Estimator> makeTwbls(const EstimatorParams& params) {
  if (params.twbls_form == EstimatorForm::paper) return std::make_unique<TwblsEstimator>(params.twbls);
  return std::make_unique<TwblsConsistentEstimator>(params.twbls_consistent);
}

std::unique_ptr<Estimator> makeNoga(const EstimatorParams& params) {
  if (params.noga_form == EstimatorForm::paper) return std::make_unique<NogaEstimator>(params.noga);
  return std::make_unique<NogaConsistentEstimator>(params.noga_consistent);
}

std::unique_ptr<Estimator> makeKalman(const EstimatorParams& params) {
  return std::make_unique<KalmanEstimator>(params.kalman);
}

std::unique_ptr<Estimator> makeImm(const EstimatorParams& params) {
  return std::make_unique<ImmEstimator>(params.imm);
}

const EstimatorEntry& entryOf(EstimatorKind kind) {
  for (const EstimatorEntry& entry : estimatorTable())
    if (entry.kind == kind) return entry;
  std::string names;
  for (const std::string& name : estimatorNames()) names += (names.empty() ? "" : ", ") + name;
  throw std::invalid_argument("EstimatorParams: kind is none of " + names);
}

}  // namespace

const std::vector<EstimatorEntry>& estimatorTable() {
  static const std::vector<EstimatorEntry> table = {
      {EstimatorKind::twbls, "twbls", "straight line through the last sightings, by weighted least squares",
       makeTwbls},
      {EstimatorKind::noga, "noga", "uncertainty reduction in a bank of response models", makeNoga},
      {EstimatorKind::kalman, "kalman", "Kalman filter with white acceleration", makeKalman},
      {EstimatorKind::imm, "imm", "interacting multiple models: Kalman filters of several motions", makeImm}};
  return table;
}

std::vector<std::string> estimatorNames() {
  std::vector<std::string> names;
  for (const EstimatorEntry& entry : estimatorTable()) names.emplace_back(entry.name);
  return names;
}

std::string estimatorName(EstimatorKind kind) {
  return entryOf(kind).name;
}

bool isEstimatorName(const std::string& name) {
  const std::vector<EstimatorEntry>& table = estimatorTable();
  return std::any_of(table.begin(), table.end(),
                     [&](const EstimatorEntry& entry) { return entry.name == name; });
}

std::unique_ptr<Estimator> makeEstimator(const EstimatorParams& params) {
  return entryOf(params.kind).make(params);
}

}  // namespace sightline::core
