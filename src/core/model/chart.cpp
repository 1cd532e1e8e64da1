#include "sightline/core/model/chart.h"

#include <cmath>

#include <Eigen/Geometry>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kTiltAbove = 75.0 * kDegree;       // elevation from which a new chart is tilted
constexpr double kTiltStaysAbove = 45.0 * kDegree;  // the same after a tilted one
constexpr double kUprightHolds =
    80.0 * kDegree;  // elevation up to which an upright chart is kept (hysteresis)
constexpr double kUprightAzimuth = 120.0 * kDegree;  // far enough from its wrap at 180
constexpr double kTiltedHolds =
    30.0 * kDegree;  // distance from its origin up to which a tilted chart is kept

/// The motion in a frame whose x axis lies at -`azimuth` in that of `state`, z axes alike: azimuths differ by
/// a constant, and nothing else does.
AngularState shifted(const AngularState& state, double azimuth) {
  AngularState there = state;
  there.mean(0) = wrapAngle(state.mean(0) + azimuth);
  there.covariance = symmetric(state.covariance);
  return there;
}

/// A prediction may go beyond a pole, where its coordinates are no azimuth and elevation.
bool areAngles(const AngularState& state) {
  return std::abs(state.mean(1)) <= kPi / 2.0;
}

}  // namespace

Chart Chart::around(const Eigen::Vector3d& direction) {
  return around(direction, kTiltAbove);
}

Chart Chart::centredOn(const Eigen::Vector3d& direction) {
  return around(direction, -1.0);
}

Chart Chart::following(const Eigen::Vector3d& direction) const {
  return around(direction, tilted_ ? kTiltStaysAbove : kTiltAbove);
}

Chart Chart::around(const Eigen::Vector3d& direction, double tilt_above) {
  const Eigen::Vector2d angles = anglesOf(direction);
  Chart chart;
  chart.azimuth_ = angles.x();
  chart.tilted_ = std::abs(angles.y()) > tilt_above;
  chart.R_chart_tracking_ = Eigen::AngleAxisd(-angles.x(), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  if (chart.tilted_) {  // a positive turn about y lowers x: it brings the elevation to zero
    chart.R_chart_tracking_ =
        Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()).toRotationMatrix() * chart.R_chart_tracking_;
  }
  return chart;
}

bool Chart::holds(const Eigen::Vector2d& coordinates) const {
  const double azimuth_limit = tilted_ ? kTiltedHolds : kUprightAzimuth;
  const double elevation_limit = tilted_ ? kTiltedHolds : kUprightHolds;
  return std::abs(coordinates.x()) <= azimuth_limit && std::abs(coordinates.y()) <= elevation_limit;
}

Eigen::Vector2d Chart::coordinatesOf(const Eigen::Vector3d& direction_tracking) const {
  return anglesOf(R_chart_tracking_ * direction_tracking);
}

Eigen::Matrix2d Chart::covarianceOf(const Sighting& sighting_tracking) const {  // (S-12)
  const Eigen::Vector3d& direction = sighting_tracking.direction;
  Eigen::Matrix<double, 2, 3> A;
  if (tilted_) {
    A = anglesJacobian(R_chart_tracking_ * direction) * R_chart_tracking_;
  } else {
    A = anglesJacobian(direction);
  }
  return symmetric(A * sighting_tracking.covariance * A.transpose());
}

Eigen::Vector3d Chart::directionAt(const Eigen::Vector2d& coordinates) const {
  return R_chart_tracking_.transpose() * directionOf(coordinates);
}

AngularState Chart::toTracking(const AngularState& state_chart) const {
  if (!tilted_ && areAngles(state_chart)) return shifted(state_chart, azimuth_);
  return rotateState(state_chart, R_chart_tracking_.transpose());
}

AngularState Chart::fromTracking(const AngularState& state_tracking) const {
  if (!tilted_ && areAngles(state_tracking)) return shifted(state_tracking, -azimuth_);
  return rotateState(state_tracking, R_chart_tracking_);
}

}  // namespace sightline::core
