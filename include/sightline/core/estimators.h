#pragma once

#include <memory>

#include "sightline/core/estimator.h"
#include "sightline/core/imm.h"
#include "sightline/core/kalman.h"
#include "sightline/core/noga.h"
#include "sightline/core/twbls.h"

namespace sightline::core {

enum class EstimatorKind { twbls, noga, kalman, imm };

/// Which estimator a tracker runs, and the settings of each.
struct EstimatorParams {
  EstimatorKind kind = EstimatorKind::twbls;
  TwblsParams twbls;
  NogaParams noga;
  KalmanParams kalman;
  ImmParams imm;
};

/// A new estimator that knows nothing yet. Throws std::invalid_argument for settings that cannot work.
std::unique_ptr<Estimator> makeEstimator(const EstimatorParams& params);

}  // namespace sightline::core
