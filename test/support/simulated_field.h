#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "sightline/core/positions/position_tracker.h"
#include "sightline/core/simulation/random_stream.h"
#include "sightline/core/tracking/local_tracker.h"
#include "sightline/core/tracking/tracklet_builder.h"

/// Stations round a field with a local tracker each, and what they send to a position tracker.
namespace sightline::test {

using Path = std::function<Eigen::Vector3d(double)>;  // of the time [s]; not finite = not there

struct FieldStation {
  std::string name;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  double sigma = 5e-4;  // of each angle [rad]
  double detection_probability = 1.0;
  double clutter = 0.0;                                            // false sightings a scan, mean
  double interval = 1.0 / 30.0;                                    // [s]
  double phase = 0.0;                                              // of the first scan [s]
  std::function<bool(double)> sees = [](double) { return true; };  // at a time [s]
};

/// What came out of one scan of one station.
struct FieldMessage {
  double time = 0.0;
  std::vector<core::StationTracklet> tracklets;
  core::StationTracks tracks;
};

class SimulatedField {
 public:
  SimulatedField(const std::vector<FieldStation>& stations, const std::vector<Path>& paths,
                 std::uint64_t seed, double tracklet_interval = 0.1)
      : paths_(paths) {
    for (const FieldStation& station : stations) {
      // The station's x axis looks at the middle of the field.
      const double azimuth = std::atan2(50.0 - station.origin.y(), 40.0 - station.origin.x());
      core::StationPose pose;
      pose.origin = station.origin;
      pose.R_metric_station = Eigen::AngleAxisd(azimuth, Eigen::Vector3d::UnitZ()).toRotationMatrix();
      core::TrackletParams tracklets;
      tracklets.interval = tracklet_interval;  // [s]
      stations_.push_back({station, pose, core::LocalTracker(core::LocalTrackerParams{}),
                           core::TrackletBuilder(tracklets),
                           core::RandomStream(core::seedOf(seed, station.name)), station.phase});
    }
  }

  /// The next scan in order of time.
  FieldMessage next() {
    Station& s = *std::min_element(stations_.begin(), stations_.end(),
                                   [](const Station& a, const Station& b) { return a.next < b.next; });
    const double t = s.next;
    s.next += s.station.interval;
    core::Scan scan;
    scan.time = core::Time(core::durationOf(t));
    scan.sensor = "camera of " + s.station.name;
    scan.detection_probability = s.station.detection_probability;
    const Eigen::Matrix2d R = s.station.sigma * s.station.sigma * Eigen::Matrix2d::Identity();
    for (const Path& path : paths_) {
      const Eigen::Vector3d target = path(t);
      const bool is_seen = s.random.uniform() < s.station.detection_probability && s.station.sees(t);
      const Eigen::Vector2d error = s.station.sigma * s.random.normalPair();
      if (!target.allFinite() || !is_seen) continue;
      const Eigen::Vector2d angles =
          core::anglesOf(s.pose.R_metric_station.transpose() * (target - s.station.origin));
      scan.sightings.push_back(core::sightingOf(
          angles + Eigen::Vector2d(error.x() / std::cos(angles.y()), error.y()),
          Eigen::Vector2d(R(0, 0) / std::pow(std::cos(angles.y()), 2), R(1, 1)).asDiagonal()));
    }
    for (unsigned i = s.random.poisson(s.station.clutter); i > 0; --i) {
      const Eigen::Vector2d angles(1.4 * s.random.uniform() - 0.7, 0.8 * s.random.uniform() - 0.1);
      scan.sightings.push_back(core::sightingOf(angles, R));
    }
    const core::ScanReport report = s.tracker.onScan(scan);
    FieldMessage message;
    message.time = t;
    message.tracks = {s.station.name, report.time, s.pose, {}, report.tracks};
    if (const auto tracklets = s.builder.onScan(scan, report)) {
      for (const core::TrackTracklet& tracklet : tracklets->tracklets)
        message.tracklets.push_back({s.station.name, tracklet.track, tracklet.tracklet, s.pose});
    }
    return message;
  }

 private:
  struct Station {
    FieldStation station;
    core::StationPose pose;
    core::LocalTracker tracker;
    core::TrackletBuilder builder;
    core::RandomStream random;
    double next = 0.0;
  };

  std::vector<Path> paths_;
  std::vector<Station> stations_;
};

/// Up to four stations about a field of 100 m, not synchronous.
inline std::vector<FieldStation> fieldStations(int count) {
  const std::vector<Eigen::Vector3d> origins{{0, 0, 0}, {100, 0, 2}, {90, 110, 5}, {-30, 90, 1}};
  std::vector<FieldStation> stations;
  for (int i = 0; i < count; ++i) {
    FieldStation station;
    station.name = "station_" + std::to_string(i + 1);
    station.origin = origins[static_cast<std::size_t>(i)];
    station.phase = 0.007 * i;
    stations.push_back(station);
  }
  return stations;
}

}  // namespace sightline::test
