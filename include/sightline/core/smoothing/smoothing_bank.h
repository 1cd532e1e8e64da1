#pragma once

#include "sightline/core/estimators/estimators.h"
#include "sightline/core/estimators/noga_consistent.h"

namespace sightline::core {

/// The bank of response models by which the tracks of an estimator are smoothed. NOGA `consistent`: its own.
/// A Kalman filter is a bank of one model, the models of an IMM are models of the bank as they are; where
/// sightings couple azimuth with elevation, process noise in proportion to theirs is not coupled in the bank.
/// TWBLS `consistent`: its white accelerations take turns instead of forgetting. Throws std::invalid_argument
/// for the forms `paper`, which have no model of the motion, and for densities of which some are absolute and
/// some in proportion to the sightings' noise.
NogaConsistentParams smoothingBankOf(const EstimatorParams& params);

}  // namespace sightline::core
