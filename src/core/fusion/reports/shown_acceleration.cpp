#include "sightline/core/fusion/reports/shown_acceleration.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace sightline::core {
namespace {

constexpr double kMemory = 8.0;  // reports that are averaged

}  // namespace

void ShownAcceleration::take(const AngularState& state_tracking, Time time) {
  if (reports_ == 0.0) first_ = time;
  const Eigen::Matrix<double, 3, 2> J = directionJacobian(state_tracking.angles());
  const Eigen::Vector3d direction = directionOf(state_tracking.angles());
  const Eigen::Vector3d velocity = J * state_tracking.mean.tail<2>();
  const double variance = (J * state_tracking.covariance.bottomRightCorner<2, 2>() * J.transpose()).trace();
  const double since_first = seconds(time - first_);

  if (reports_ > 0.0)  // along the great circle, on which a rate turns with its target
    velocity_ = Eigen::Quaterniond::FromTwoVectors(direction_, direction) * velocity_;
  direction_ = direction;
  value_.setZero();
  const double span = since_first - time_;
  if (reports_ > 0.0 && span > 0.0) {
    const Eigen::Vector3d change = velocity - velocity_;
    const double noise = variance + variance_;
    const double shown = 1.0 - noise / change.squaredNorm();
    if (shown > 0.0) value_ = std::sqrt(shown) / span * change;
  }

  reports_ = std::min(reports_ + 1.0, kMemory);
  velocity_ += (velocity - velocity_) / reports_;
  variance_ += (variance - variance_) / reports_;
  time_ += (since_first - time_) / reports_;
}

void allowFor(const Eigen::Vector3d& acceleration_tracking, double age, const Chart& chart,
              AngularState& state) {
  if (acceleration_tracking.isZero(0.0)) return;
  const Eigen::Vector3d direction = directionOf(state.angles());
  const Eigen::Vector2d acceleration =
      anglesJacobian(direction) * (chart.R_chart_tracking() * acceleration_tracking);
  Eigen::Vector4d off;
  off << 0.5 * age * age * acceleration, age * acceleration;
  state.covariance += off * off.transpose();
}

}  // namespace sightline::core
