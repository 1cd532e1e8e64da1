#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/model/sighting.h"
#include "sightline/core/tracking/local_tracker.h"

/// Many targets in clutter: recordings of them, simulated or read, and how a local tracker follows them.
namespace sightline::bench {

/// The scans of a recording in order of time, and the true directions at the time of each.
struct CrowdRecording {
  std::vector<core::Scan> scans;
  std::vector<std::map<std::uint32_t, Eigen::Vector2d>> truths;  ///< (azimuth, elevation) by target [rad]
  double stated_sigma = 1e-3;                                    ///< [rad]
};

/// A target that flies straight, and weaves about that line.
struct CrowdTarget {
  double from = 0.0, to = std::numeric_limits<double>::infinity();  ///< there in [from, to) [s]
  Eigen::Vector2d at{0.0, 0.0};                                     ///< at `meeting` [rad]
  Eigen::Vector2d rate{0.0, 0.0};                                   ///< [rad/s]
  double meeting = 0.0;                                             ///< [s]
  Eigen::Vector2d weave{0.0, 0.0};                                  ///< amplitude [rad]
  double period = 10.0;                                             ///< of the weave [s]
  double hidden_from = 0.0, hidden_to = 0.0;                        ///< there and not to be seen [s]

  Eigen::Vector2d placeAt(double time) const;
};

/// Staring sensors that see the same field, one after the other.
struct CrowdScenario {
  std::vector<CrowdTarget> targets;
  double duration = 60.0;                  ///< [s]
  int sensors = 1;                         ///< all alike
  double rate = 30.0;                      ///< of each sensor [Hz]
  double detection_probability = 0.9;      ///< in (0, 1]
  double clutter = 5.0;                    ///< mean number of false sightings in a scan
  double sigma = 1e-3;                     ///< of each angle, as it is stated [rad]
  Eigen::Vector2d half_field{0.35, 0.25};  ///< around `centre` [rad]
  Eigen::Vector2d centre{0.0, 0.3};        ///< [rad]
};

/// One recording of a scenario; the same seed gives the same.
CrowdRecording record(const CrowdScenario& scenario, std::uint64_t seed);

/// Reads sightings.csv and truth.csv of a folder: columns time,sensor,azimuth,elevation,sigma_azimuth,
/// sigma_elevation,scan and time,target,azimuth,elevation [s, rad]; exposures without sightings, which a CSV
/// cannot hold, are put where scan numbers are left out. Throws std::runtime_error for what cannot be read.
CrowdRecording readCrowd(const std::string& folder);

/// What a tracker made of it. An estimate further than 10 mrad from a target is a false one.
struct CrowdFigures {
  double gospa = 0.0;         ///< mean over scans, c = 10 mrad, p = 2 [rad]
  double localisation = 0.0;  ///< root mean square over pairs [rad]
  double missed = 0.0;        ///< targets without an established track, a scan
  double extra = 0.0;         ///< established tracks without a target, a scan
  int id_switches = 0, breaks = 0;
  int tracks = 0;         ///< established ones, by id
  int false_tracks = 0;   ///< of these, those that were on no target for half their life
  double hours = 0.0;     ///< of the recording
  double seconds = 0.0;   ///< of processor time that the tracker took [s]
  double coverage = 0.0;  ///< share of the target scans with a track
  double position_anees = 0.0, state_anees = 0.0;  ///< of the established tracks; 1 is honest
};

CrowdFigures follow(const CrowdRecording& recording, const core::LocalTrackerParams& params);

}  // namespace sightline::bench
