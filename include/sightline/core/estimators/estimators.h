#pragma once

#include <memory>

#include "sightline/core/estimators/estimator.h"
#include "sightline/core/estimators/imm.h"
#include "sightline/core/estimators/kalman.h"
#include "sightline/core/estimators/noga.h"
#include "sightline/core/estimators/noga_consistent.h"
#include "sightline/core/estimators/twbls.h"
#include "sightline/core/estimators/twbls_consistent.h"

namespace sightline::core {

enum class EstimatorKind { twbls, noga, kalman, imm };

/// The two forms of the paper's estimators.
enum class EstimatorForm {
  paper,      ///< its equations with the repairs that make them executable
  consistent  ///< statistically honest: what is published can be believed
};

/// Which estimator a tracker runs, and the settings of each.
struct EstimatorParams {
  EstimatorKind kind = EstimatorKind::twbls;
  EstimatorForm twbls_form = EstimatorForm::consistent;
  TwblsParams twbls;  ///< form `paper`
  TwblsConsistentParams twbls_consistent;
  EstimatorForm noga_form = EstimatorForm::consistent;
  NogaParams noga;  ///< form `paper`
  NogaConsistentParams noga_consistent;
  KalmanParams kalman;
  ImmParams imm;
};

/// A new estimator that knows nothing yet. Throws std::invalid_argument for settings that cannot work.
std::unique_ptr<Estimator> makeEstimator(const EstimatorParams& params);

}  // namespace sightline::core
