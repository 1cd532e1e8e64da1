#pragma once

#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "sightline/core/estimators/estimator.h"
#include "sightline/core/estimators/imm.h"
#include "sightline/core/estimators/kalman.h"
#include "sightline/core/estimators/noga.h"
#include "sightline/core/estimators/noga_consistent.h"
#include "sightline/core/estimators/twbls.h"
#include "sightline/core/estimators/twbls_consistent.h"

namespace sightline::core {

/// In the order of the table below, from 0.
enum class EstimatorKind { twbls, noga, kalman, imm };

/// The two forms of the paper's estimators.
enum class EstimatorForm {
  paper,      ///< its equations with the repairs that make them executable
  consistent  ///< statistically honest: what is published can be believed
};

/// Which estimator a tracker runs, and the settings of each.
struct EstimatorParams {
  EstimatorKind kind = EstimatorKind::noga;
  EstimatorForm twbls_form = EstimatorForm::consistent;
  TwblsParams twbls;  ///< form `paper`
  TwblsConsistentParams twbls_consistent;
  EstimatorForm noga_form = EstimatorForm::consistent;
  NogaParams noga;  ///< form `paper`
  NogaConsistentParams noga_consistent;
  KalmanParams kalman;
  ImmParams imm;

  friend bool operator==(const EstimatorParams& a, const EstimatorParams& b) {
    return std::tie(a.kind, a.twbls_form, a.twbls, a.twbls_consistent, a.noga_form, a.noga, a.noga_consistent,
                    a.kalman, a.imm) == std::tie(b.kind, b.twbls_form, b.twbls, b.twbls_consistent,
                                                 b.noga_form, b.noga, b.noga_consistent, b.kalman, b.imm);
  }
};

/// One estimator that a tracker can run.
struct EstimatorEntry {
  EstimatorKind kind;
  const char* name;         ///< in parameters and in TrackArray.estimator
  const char* description;  ///< one line
  std::unique_ptr<Estimator> (*make)(const EstimatorParams& params);
};

/// All of them, in the order of EstimatorKind. What lists, names or makes estimators reads it from here.
const std::vector<EstimatorEntry>& estimatorTable();

std::vector<std::string> estimatorNames();

/// Throws std::invalid_argument for a kind that is not in the table.
std::string estimatorName(EstimatorKind kind);

bool isEstimatorName(const std::string& name);

/// A new estimator that knows nothing yet. Throws std::invalid_argument for settings that cannot work.
std::unique_ptr<Estimator> makeEstimator(const EstimatorParams& params);

}  // namespace sightline::core
