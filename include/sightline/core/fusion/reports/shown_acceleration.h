#pragma once

#include <Eigen/Core>

#include "sightline/core/model/chart.h"
#include "sightline/core/model/sphere.h"
#include "sightline/core/model/time.h"

namespace sightline::core {

/// Acceleration of a target over the sphere, as far as the rates that its tracker has reported show it: the
/// newest rate against the average of the last ones, less what their covariances explain.
///
/// A report carries no acceleration, so it is predicted at constant rates. What is predicted further than
/// from one report to the next (it came late, or its tracker is slow) is off by what the target has turned
/// meanwhile, of which the report's covariance knows nothing when its tracker follows turns well.
class ShownAcceleration {
 public:
  /// A report's state, later than the last.
  void take(const AngularState& state_tracking, Time time);

  /// A vector in the tracking frame, tangent to the sphere [rad/s^2]; zero where none is shown.
  const Eigen::Vector3d& value() const { return value_; }

  /// By how much it takes a target off its straight path in `age` [s]: an angle [rad].
  double offsetAfter(double age) const { return 0.5 * age * age * value_.norm(); }

 private:
  Time first_{};
  double reports_ = 0.0;
  Eigen::Vector3d direction_ = Eigen::Vector3d::UnitX();  // of the last report
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();    // average of the reports, brought there [rad/s]
  double variance_ = 0.0;                                 // average of its trace [rad^2/s^2]
  double time_ = 0.0;                                     // average since `first_` [s]
  Eigen::Vector3d value_ = Eigen::Vector3d::Zero();
};

/// Adds to the covariance of a state in a chart, predicted at constant rates for `age` [s], what an
/// acceleration (as of `ShownAcceleration`) has made of it meanwhile, of whichever sign.
void allowFor(const Eigen::Vector3d& acceleration_tracking, double age, const Chart& chart,
              AngularState& state);

}  // namespace sightline::core
