#pragma once

#include <Eigen/Core>

namespace sightline::core {

/// Where the next sighting of a track is expected, in the coordinates of whoever computed it.
struct Gate {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();          ///< predicted (azimuth, elevation) [rad]
  Eigen::Vector2d half_width = Eigen::Vector2d::Zero();      ///< the paper's rectangle [rad]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< of the innovation, S [rad^2]
};

}  // namespace sightline::core
