#pragma once

#include <vector>

#include <Eigen/Core>

#include "sightline/core/estimators/bank_step.h"
#include "sightline/core/estimators/mode_chain.h"
#include "sightline/core/estimators/noga_bank.h"
#include "sightline/core/estimators/noga_consistent.h"
#include "sightline/core/estimators/noga_models.h"
#include "sightline/core/model/sphere.h"

/// Backward smoothing of NOGA's bank: the recursion of Rauch, Tung and Striebel 1965 for each response model,
/// and the mode chain followed back (Kim 1994; Barber 2006; Nadarajah, Tharmarasa, McDonald, Kirubarajan
/// 2012).
namespace sightline::core {

/// What each response model believes of the target at one time, by sightings before and after it. Angles in
/// one chart [rad], times in seconds.
struct SmoothedBank {
  ResponseBank bank{1};       ///< covariances for the noise that is in it; of models of weight 0 nothing
  ModeArray weights;          ///< probability of each model; they sum to one
  ModeArray noise[2];         ///< by the sightings up to then, of each channel and model [1] ...
  double noise_weight = 0.0;  ///< ... and what that counts for: NoiseLearning::weight
  ModeArray later_noise[2];   ///< evidence of later sightings of the same, times its weight ...
  double later_weight = 0.0;  ///< ... which is this
  bool is_coupled = false;    ///< whether covariances of azimuth with elevation are kept
  double left_out = 0.0;      ///< probability of the models that motionOf may leave out
};

/// What an estimator knows at its last sighting: nothing later is known.
SmoothedBank nothingLater(const NogaConsistentEstimator& estimator);

/// What is known at the beginning of a step, given what is known at its end. `models`: of the bank.
// (S-145)
SmoothedBank smoothedBack(const BankStep& step, const std::vector<ResponseModel>& models,
                          const SmoothedBank& later);

/// The part of a step that begins `h` seconds after the step, 0 < h < step.h.
BankStep remainderOf(const BankStep& step, const std::vector<ResponseModel>& models, double h);

/// Variance of the sightings' white noise over the stated one in each channel, by earlier and later sightings
/// [1].
Eigen::Vector2d noiseOf(const SmoothedBank& smoothed);

/// Mean and covariance of position and rates (S-6).
AngularState motionOf(const SmoothedBank& smoothed);

/// Goes over to a chart that is turned by `R_new_old`.
void turn(SmoothedBank& smoothed, const Eigen::Matrix3d& R_new_old);

}  // namespace sightline::core
