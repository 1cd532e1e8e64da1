#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/model/refusal.h"
#include "sightline/core/model/time.h"
#include "sightline/core/model/track.h"
#include "sightline/core/positions/stations/station_alignment.h"

/// What the position tracker reports. Metric frame, m and s.
namespace sightline::core {

/// A target's position: the fields of sightline/PositionTrack.
struct PositionTrack {
  std::uint32_t id = 0;  ///< never reused within a run
  TrackStatus status = TrackStatus::tentative;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();                            ///< [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();                            ///< [m/s]
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  ///< (position, velocity)
  double existence = 0.0;                                                        ///< probability [1]
  Time last_sighting{};
  double parallax = 0.0;             ///< largest angle between the rays that support it now [rad]
  std::vector<std::string> sources;  ///< `tracker/id` of the local tracks that support it, sorted
};

struct PositionTrackArray {
  Time time{};                        ///< at which every state is valid
  std::vector<PositionTrack> tracks;  ///< ascending id
};

/// A crossing of local tracks that is not taken for a target.
struct RefusedCrossingReport {
  std::vector<std::string> sources;                    ///< `tracker/id`
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< of the crossing [m]
  double score = 0.0;                                  ///< log likelihood ratio
  double margin = 0.0;  ///< to the best explanation without it; negative: the other is better
  Refusal reason;
};

/// A local track without a position.
struct UnlocatedTrack {
  std::string source;  ///< `tracker/id`
  Refusal reason;
};

/// What is known of a sensor.
struct StationReport {
  std::string tracker, sensor;
  double slow_scale = 1.0;     ///< sigma of its slow error over what is stated and not white noise [1]
  double time_constant = 3.0;  ///< of it [s]
  std::optional<StationAlignmentEstimate>
      alignment;              ///< of its station, when targets have told something of it
  bool is_corrected = false;  ///< its directions are put right by `alignment`
  bool is_undecided = false;  ///< it or another station is off, and nobody can tell which
};

struct PositionReport {
  Time time{};  ///< of the last decision
  std::vector<RefusedCrossingReport> refused;
  std::vector<UnlocatedTrack> unlocated;  ///< by source
  std::vector<StationReport> stations;    ///< by tracker and sensor
  bool is_complete = true;                ///< false: more crossings than can be scored; the rest waits
};

struct PositionOutput {
  PositionTrackArray tracks;
  PositionReport report;
};

}  // namespace sightline::core
