#pragma once

#include <vector>

#include <Eigen/Core>

#include "sightline/core/estimators/mode_chain.h"
#include "sightline/core/positions/position_belief.h"
#include "sightline/core/positions/position_estimator.h"

/// Backward smoothing of the bank of position models: the recursion of Rauch, Tung and Striebel 1965 for each
/// model, and the mode chain followed back, as core/smoothing does it for directions (S-143) to (S-145).
namespace sightline::core {

/// What each model believes of the target at one time, by measurements before and after it.
struct SmoothedPositionBank {
  std::vector<PositionBelief> beliefs;  ///< of models of weight 0 nothing
  ModeArray weights;                    ///< probability of each model; they sum to one
  std::vector<int> stations;            ///< whose slow errors are in the slots
};

/// What is known at the beginning of a step by what came before it.
SmoothedPositionBank nothingLater(const PositionStep& step);

/// What is known at the beginning of a step, given what is known at its end. Slow errors that came into the
/// state there say nothing of the beginning; those that have left it are told by the rest. `models`: of the
/// bank.
// (P-18)
SmoothedPositionBank smoothedBack(const PositionStep& step, const std::vector<PositionModel>& models,
                                  const SmoothedPositionBank& later);

/// The part of a step that begins `h` seconds after it, 0 < h < step.h.
PositionStep remainderOf(const PositionStep& step, const std::vector<PositionModel>& models, double h);

/// Position [m] and velocity [m/s].
struct SmoothedPosition {
  Eigen::Matrix<double, 6, 1> mean = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

/// Mean and covariance of the mixture (S-6).
SmoothedPosition positionOf(const SmoothedPositionBank& smoothed);

}  // namespace sightline::core
