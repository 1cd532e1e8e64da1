#include "sightline/core/estimators/estimators.h"

#include <stdexcept>

namespace sightline::core {

std::unique_ptr<Estimator> makeEstimator(const EstimatorParams& params) {
  switch (params.kind) {
    case EstimatorKind::twbls:
      if (params.twbls_form == EstimatorForm::paper) return std::make_unique<TwblsEstimator>(params.twbls);
      return std::make_unique<TwblsConsistentEstimator>(params.twbls_consistent);
    case EstimatorKind::noga:
      if (params.noga_form == EstimatorForm::paper) return std::make_unique<NogaEstimator>(params.noga);
      return std::make_unique<NogaConsistentEstimator>(params.noga_consistent);
    case EstimatorKind::kalman:
      return std::make_unique<KalmanEstimator>(params.kalman);
    case EstimatorKind::imm:
      return std::make_unique<ImmEstimator>(params.imm);
  }
  throw std::invalid_argument("EstimatorParams: kind is none of twbls, noga, kalman, imm");
}

}  // namespace sightline::core
