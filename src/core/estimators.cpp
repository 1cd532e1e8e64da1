#include "sightline/core/estimators.h"

#include <stdexcept>

namespace sightline::core {

std::unique_ptr<Estimator> makeEstimator(const EstimatorParams& params) {
  switch (params.kind) {
    case EstimatorKind::twbls:
      return std::make_unique<TwblsEstimator>(params.twbls);
    case EstimatorKind::noga:
      return std::make_unique<NogaEstimator>(params.noga);
    case EstimatorKind::kalman:
      return std::make_unique<KalmanEstimator>(params.kalman);
    case EstimatorKind::imm:
      return std::make_unique<ImmEstimator>(params.imm);
  }
  throw std::invalid_argument("EstimatorParams: kind is none of twbls, noga, kalman, imm");
}

}  // namespace sightline::core
