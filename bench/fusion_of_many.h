#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/fusion/track_fusion.h"
#include "sightline/core/tracking/local_tracker.h"

/// Many targets that cross, seen by several biased sensors, each with a tracker of its own; and what a fusion
/// makes of it.
namespace sightline::bench {

struct ManyTargets {
  int targets = 24;
  int sensors = 6;
  double duration = 20.0;  ///< [s]
  double rate = 10.0;      ///< scans of each sensor [Hz]
  double sigma = 1e-3;     ///< of the best sensor; the worst has twice that [rad]
  double bias = 1.0;       ///< of each sensor, in a direction of its own [its sigma]
  double detection_probability = 0.9;
  double clutter = 5.0;      ///< false sightings a scan
  double half_width = 0.15;  ///< of the square in which all this happens [rad]
  double fastest = 0.03;     ///< speed of a target [rad/s]
  std::uint64_t seed = 1;

  core::LocalTrackerParams tracker;
  core::TrackFusionParams fusion;
};

/// What is counted at every report of the fusion from `kSettled` on: the targets in view against the global
/// tracks within `kNear` of them, each of one at most; who was together stays together as long as possible.
struct ManyTargetsFigures {
  double looks = 0;                              ///< targets times reports
  double missed = 0;                             ///< of those, without a track
  double duplicates = 0;                         ///< tracks near a target that has one, times reports
  double astray = 0;                             ///< tracks near no target, times reports
  int label_changes = 0;                         ///< a target has another track than the last one that it had
  int local_label_changes = 0;                   ///< the same, in the mean over the local trackers
  double squares = 0.0;                          ///< of the errors of position [rad^2]
  double tracker_time = 0.0, fusion_time = 0.0;  ///< processor time of all trackers, of the fusion [s]

  void add(const ManyTargetsFigures& other);
  double rmse() const;  ///< of an angle [rad]
};

constexpr double kSettled = 3.0;  // [s]
constexpr double kNear = 6e-3;    // [rad]

ManyTargetsFigures followMany(const ManyTargets& scene);

}  // namespace sightline::bench
