#pragma once

#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/estimators/revisit_time.h"
#include "sightline/core/model/sighting.h"
#include "sightline/core/model/time.h"

namespace sightline::core {

/// What is configured for the sensors whose scans do not state it.
struct DetectionParams {
  double probability = 0.0;       ///< P_D of a target in view, in [0, 1]; 0 = learned, sensor by sensor
  double clutter_density = -1.0;  ///< false sightings [1/sr a scan], >= 0; negative = learned
  double memory = 300.0;          ///< scans over which is learned, >= 10
  double births = 0.1;            ///< new targets expected in the view of a sensor [1/unit of time], > 0
  double first_targets = 1.0;     ///< expected there when it looks for the first time, > 0

  friend bool operator==(const DetectionParams& a, const DetectionParams& b) {
    return std::tie(a.probability, a.clutter_density, a.memory, a.births, a.first_targets) ==
           std::tie(b.probability, b.clutter_density, b.memory, b.births, b.first_targets);
  }
};

/// What is known of one sensor.
struct CalibratedDetection {
  std::string sensor;
  double seen = 0.0, looked = 0.0;  ///< scans of mature targets in which they were seen, of how many
  double clutter = 0.0;             ///< sightings that are no track's [1], fading as ...
  double scans = 0.0;               ///< ... the scans [1]
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< sum of those sightings' directions [1]
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();    ///< sum of their outer products [1]
  Time last_scan{};
  RevisitTime interval;       ///< between its scans
  double undiscovered = 0.0;  ///< targets in view that are in no track yet, expected before the last scan
};

/// The detection probability of each sensor and its false sightings in which solid angle, (S-46) to (S-48),
/// learned from the scans themselves: the log-likelihood ratios of association and existence need them, and
/// few sensors state them. Plain state, copied with the tracker's.
///
/// The solid angle is the field of view, where that is known; else what the false sightings are scattered
/// over, as if evenly over a rectangle, which is at least ten standard deviations of a sighting wide: a
/// target that is seen by a coarse sensor is not the clutter that explains it.
class DetectionCalibration {
 public:
  /// Throws std::invalid_argument for parameters out of range.
  explicit DetectionCalibration(const DetectionParams& params);

  /// P_D of a target that the scan's sensor can see, in [0.05, 0.99]: by the scan, the parameter, or what has
  /// been learned; the last at most 0.9, because misses come in runs more often than chance alone has it.
  double probability(const Scan& scan) const;

  /// Density of false sightings [1/sr], > 0: by the scan, the parameter, or what has been learned.
  double clutterDensity(const Scan& scan) const;

  /// False sightings expected in the whole of the scan, > 0.
  double clutter(const Scan& scan) const;

  /// Odds that a sighting of no track, of a scan that has been taken already, is of a new target: the
  /// expected number of those over that of false sightings, > 0. Targets that a sensor has not seen in scan
  /// after scan are not there, but for those that have come since.
  double newTargetOdds(const Scan& scan) const;

  /// The usual time between the scans of this scan's sensor, this one included.
  RevisitTime interval(const Scan& scan) const;

  /// New targets expected in `duration` [s] in a solid angle of 1 sr of the scan's view.
  double birthDensity(const Scan& scan, double duration) const;

  /// Takes a scan in order of time. `looked`, `seen`: mature targets in view, and how many of them were
  /// seen; `falseness`: of each sighting, the probability that it is of no target, in [0, 1].
  void take(const Scan& scan, int looked, int seen, const std::vector<double>& falseness);

  /// By name.
  const std::vector<CalibratedDetection>& sensors() const { return sensors_; }

 private:
  double clutterDensity(const Scan& scan, double area) const;
  std::optional<double> statedDensity(const Scan& scan) const;
  double learnedClutter(const Scan& scan) const;
  const CalibratedDetection* find(const std::string& sensor) const;
  double solidAngle(const Scan& scan) const;

  DetectionParams params_;
  std::vector<CalibratedDetection> sensors_;
};

}  // namespace sightline::core
