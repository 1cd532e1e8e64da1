#pragma once

#include <array>

#include <Eigen/Core>

#include "sightline/core/model/time.h"
#include "sightline/core/positions/position_belief.h"
#include "sightline/core/positions/rays.h"

namespace sightline::core {

/// What one station saw of the target: a sighting, or a tracklet's.
struct StationMeasurement {
  Time time{};
  int station = 0;  ///< number of the station, >= 0, the caller's
  Ray ray;  ///< from where, where to; `covariance` is of the white noise; motion: of the origin, if known
  SlowError slow;    ///< of the station
  double age = 0.0;  ///< it was seen so long before `time`: the station's clock is late by this [s]
};

/// A station that has seen the target.
struct SeenStation {
  int station = -1;
  Time last{};
  double interval = 0.0;                             ///< between measurements [s], 0 = not known
  double since = 0.0;                                ///< between the last two [s]
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< at the last measurement [m]
  double variance = 0.0;                             ///< of one measurement, with the slow error [rad^2]
  bool is_at_rest = true;  ///< has not moved enough since it is alone to tell a range
  Eigen::Vector3d alone_origin = Eigen::Vector3d::Zero();  ///< where it was when it was left alone [m]
};

/// The stations that have seen one target: which of them support it now, and what they resolve there. A
/// value; nothing is allocated. Of more than `kMostSeen` the one silent longest is forgotten.
class SeenStations {
 public:
  static constexpr int kMostSeen = 32;

  /// A station counts as gone when silent for `alone_after` [s] or for `alone_intervals` of its intervals,
  /// whichever is longer; both > 0.
  SeenStations(double alone_after, double alone_intervals)
      : alone_after_(alone_after), alone_intervals_(alone_intervals) {}

  /// Remembers that the station sees the target.
  SeenStation& note(const StationMeasurement& measurement);

  /// nullptr for a station that has not seen it.
  const SeenStation* find(int station) const;

  bool supports(const SeenStation& seen, Time now) const;

  /// Whether no other station supports a target at `point`; stations at one place count as one.
  bool isAlone(const SeenStation& seen, const Eigen::Vector3d& point, Time now) const;

  /// Whether the station, alone since `alone_origin`, has moved too little to tell the range of a target at
  /// `point` from `origin`.
  static bool isAtRest(const SeenStation& seen, const Eigen::Vector3d& origin, const Eigen::Vector3d& point);

  /// The square of what one measurement resolves at `point`, (sigma rho)^2 [m^2], of the stations that
  /// support the target: the harmonic mean, so that the best counts most (P-4).
  double unitSquared(const Eigen::Vector3d& point, Time now) const;

  /// How `point` is seen by the stations that support it.
  struct Support {
    int stations = 0;
    double nearest = 0.0;   ///< range of the nearest of them, of all when none supports it [m]
    double parallax = 0.0;  ///< largest angle between the lines to two of them [rad]
  };
  Support supportOf(const Eigen::Vector3d& point, Time now) const;

 private:
  double alone_after_, alone_intervals_;
  std::array<SeenStation, kMostSeen> seen_;
  int count_ = 0;
};

}  // namespace sightline::core
