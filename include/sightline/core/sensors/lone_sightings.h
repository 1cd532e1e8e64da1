#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "sightline/core/model/sighting.h"
#include "sightline/core/model/time.h"

namespace sightline::core {

/// Looks whether the noise that a sensor states can be right at all, where its sightings make no track
/// (S-96): scans that hold one sighting each, at even intervals, are of one target, or the sensor is not
/// worth tracking with. If these scatter by many stated sigmas about straight lines through their neighbours,
/// and yet over a small part of the sky, the stated sigma is wrong: a variance given for a sigma, degrees
/// given for radians. Plain state of a fixed size.
class LoneSightings {
 public:
  /// Takes a scan of the sensor while no track is established. Returns the factor on the stated variances
  /// that the scatter asks for, when it is far from 1 and the evidence is there.
  std::optional<double> take(const Scan& scan);

  /// The factor by what has come so far, be it one comparison: too little to believe it.
  std::optional<double> suspicion() const;

 private:
  static constexpr int kNeeded = 8;  // sightings compared with the line through the two before

  struct Look {
    Time time{};
    Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  };

  std::array<Look, 2> last_;  // the older first
  int looks_ = 0;             // in a row, at even intervals
  std::array<double, kNeeded> distances_squared_{};
};

}  // namespace sightline::core
