#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/positions/rays.h"
#include "sightline/core/positions/stations/station_alignment.h"

namespace sightline::core {

/// When a station's clock or orientation counts as wrong (P-16).
struct StationCorrectionParams {
  bool enabled = true;
  double normal_clock_sigma = 1e-3;        ///< of the clocks of stations that are right [s], > 0
  double normal_orientation_sigma = 1e-4;  ///< of each angle of their orientations [rad], > 0
  double significance = 5.0;               ///< standard deviations from which a station is corrected [1], > 0
  double release = 3.0;                    ///< ... below which it no longer is [1], in (0, significance)
  double least_margin = 5.0;  ///< log likelihood ratio by which all other stations must be less likely to be
                              ///< the one that is wrong, >= 0
};

/// By how much a station is off.
struct StationCorrection {
  double clock = 0.0;  ///< its stamps are so much later than they should be [s]
  Eigen::Vector3d orientation =
      Eigen::Vector3d::Zero();  ///< rotation vector: what it sees is turned by this [rad]
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();  ///< over (clock, orientation); 0 where it is right
  bool has_clock = false, has_orientation = false;       ///< which of them is off
};

/// What a direction of the station would be if the station were right, with what is not known of the
/// correction in its covariance; needs the ray's rate where the clock is off.
Ray corrected(const Ray& ray, const StationCorrection& correction);

/// How the direction answers to the station's (clock, orientation).
Eigen::Matrix<double, 3, 4> alignmentJacobian(const Eigen::Vector3d& direction, const Eigen::Vector3d& rate);

/// Which stations are off, by evidence (P-16): all are right but the fewest that explain what rays of common
/// targets say. The prior of a station is narrow while it counts as right and wide while it does not; the
/// one that gains most evidence by the wide one is taken first, when no other explains as much. At most half
/// of the stations less one are found wrong: of two nobody can tell which is. A value.
class StationCorrections {
 public:
  /// Throws std::invalid_argument for a parameter out of range.
  StationCorrections(const StationCorrectionParams& params, const StationAlignmentParams& wide);

  /// Decides anew. Returns whether other stations are corrected than before, or others of their errors.
  bool decide(const StationAlignment& alignment);

  /// nullptr for a station that counts as right.
  const StationCorrection* of(int station) const;

  /// Stations of which one is off, but nobody can tell which; ascending.
  const std::vector<int>& undecided() const { return undecided_; }

 private:
  StationCorrectionParams params_;
  StationAlignmentParams wide_;
  std::vector<std::optional<StationCorrection>> corrections_;  // by station
  std::vector<int> undecided_;
};

}  // namespace sightline::core
