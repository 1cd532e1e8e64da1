#include "position_tables.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Cholesky>

#include "sightline/core/model/sphere.h"
#include "sightline/core/positions/position_bound.h"
#include "sightline/core/positions/position_tracker.h"
#include "sightline/core/simulation/random_stream.h"
#include "sightline/core/tracking/local_tracker.h"
#include "sightline/core/tracking/tracklet_builder.h"

#include "position_recordings.h"
#include "processor_time.h"
#include "quantiles.h"
#include "support/simulated_field.h"

namespace sightline::bench {
namespace {

using Vector = Eigen::Vector3d;

constexpr double kSeen = 0.1;     // [s] since its last sighting that a station counts as seeing the target
constexpr double kSettled = 1.0;  // [s] after the second station, from which a position is asked for

/// One camera of the recording with its local tracker.
struct Camera {
  core::LocalTracker tracker{core::LocalTrackerParams{}};
  core::TrackletBuilder builder{core::TrackletParams{}};
  std::optional<core::Time> last;
};

double neesOf(const core::PositionTrack& track, const Vector& error) {
  return error.dot(track.covariance.topLeftCorner<3, 3>().llt().solve(error)) / 3.0;
}

}  // namespace

void trackedDrone(const std::string& folder) {
  const auto [recording, path] = readDrone(folder);
  std::vector<Camera> cameras(recording.names.size());
  core::PositionTracker tracker;
  std::vector<Sample> samples;
  std::set<std::uint32_t> ids;
  std::size_t next = 0, asked = 0, told = 0, ghosts = 0;
  double together_since = std::nan(""), used = 0.0;
  for (const Seen& seen : recording.sightings) {
    for (; next < path.size() && timeAt(path[next].time) < seen.time; ++next) {
      const core::Time time = timeAt(path[next].time);
      const auto seeing = std::count_if(cameras.begin(), cameras.end(), [&](const Camera& camera) {
        return camera.last && core::seconds(time - *camera.last) < kSeen;
      });
      if (seeing < 2) together_since = std::nan("");
      if (seeing >= 2 && std::isnan(together_since)) together_since = path[next].time;
      const bool is_asked = path[next].time - together_since > kSettled;
      if (is_asked) ++asked;
      const double start = processorTime();
      const auto output = tracker.report();
      used += processorTime() - start;
      if (!output || output->tracks.tracks.empty()) continue;
      if (is_asked) ++told;
      ghosts += output->tracks.tracks.size() - 1;
      const core::PositionTrack& track = output->tracks.tracks.front();
      ids.insert(track.id);
      const double h = core::seconds(time - output->tracks.time);
      const Vector error = track.position + h * track.velocity - path[next].position;
      samples.push_back({static_cast<int>(seeing), error.norm(), neesOf(track, error),
                         (track.velocity - slopeOf(path, next)).norm()});
    }
    const auto station = static_cast<std::size_t>(seen.station);
    Camera& camera = cameras[station];
    camera.last = seen.time;
    core::Scan scan;
    scan.time = seen.time;
    scan.sensor = recording.names[station];
    core::Sighting sighting;
    sighting.direction = seen.direction;
    sighting.covariance =
        seen.variance * (Eigen::Matrix3d::Identity() - seen.direction * seen.direction.transpose());
    scan.sightings = {sighting};
    const core::ScanReport report = camera.tracker.onScan(scan);
    core::StationPose pose;
    pose.origin = recording.origins[station];
    const double start = processorTime();
    if (const auto tracklets = camera.builder.onScan(scan, report)) {
      std::vector<core::StationTracklet> posed;
      for (const core::TrackTracklet& tracklet : tracklets->tracklets)
        posed.push_back({scan.sensor, tracklet.track, tracklet.tracklet, pose});
      tracker.onTracklets(posed);
    }
    tracker.onTracks({scan.sensor, report.time, pose, {}, report.tracks});
    used += processorTime() - start;
  }
  printHead("drone_5_cameras: local trackers and position tracker, number of targets not told", "m/s");
  printByStations(samples, path.size());
  std::printf(
      "share of the time from 1 s after the second camera with a position: %.4f; ids: %zu; second positions: "
      "%zu of %zu looks; %.1f s of processor time for %.0f s\n",
      static_cast<double>(told) / static_cast<double>(asked), ids.size(), ghosts, samples.size(), used,
      path.back().time - path.front().time);
}

namespace {

struct FieldScenario {
  const char* name;
  int stations, targets;
  double duration, detection, clutter, settled;
};

/// Paths of white acceleration, kept every 20 ms, linear with the velocity in between.
struct WanderingPaths {
  static constexpr double kNode = 0.02;  // [s]
  std::vector<std::vector<Vector>> positions, velocities;

  WanderingPaths(int targets, double duration, double q, std::uint64_t seed) {
    core::RandomStream random(seed);
    for (int target = 0; target < targets; ++target) {
      Vector x(20 + 50 * random.uniform(), 30 + 50 * random.uniform(), 15 + 25 * random.uniform());
      Vector v(6 * random.uniform() - 3, 6 * random.uniform() - 3, random.uniform() - 0.5);
      positions.emplace_back();
      velocities.emplace_back();
      for (double t = 0.0; t <= duration + 1.0; t += kNode) {
        positions.back().push_back(x);
        velocities.back().push_back(v);
        for (int axis = 0; axis < 3; ++axis) {
          const Eigen::Vector2d n = random.normalPair();
          x(axis) += kNode * v(axis) +
                     std::sqrt(q * kNode * kNode * kNode) * (0.5 * n.x() + n.y() / std::sqrt(12.0));
          v(axis) += std::sqrt(q * kNode) * n.x();
        }
      }
    }
  }

  Vector at(int target, double t) const {
    const auto& nodes = positions[static_cast<std::size_t>(target)];
    const auto i = std::min(static_cast<std::size_t>(t / kNode), nodes.size() - 2);
    const double share = t / kNode - static_cast<double>(i);
    return (1.0 - share) * nodes[i] + share * nodes[i + 1];
  }
  Vector velocityAt(int target, double t) const {
    const auto& nodes = velocities[static_cast<std::size_t>(target)];
    return nodes[std::min(static_cast<std::size_t>(std::lround(t / kNode)), nodes.size() - 1)];
  }
};

std::vector<test::FieldStation> ringOf(int count) {
  std::vector<test::FieldStation> stations;
  for (int i = 0; i < count; ++i) {
    test::FieldStation station;
    station.name = "station_" + std::to_string(100 + i);
    const double angle = 2.0 * core::kPi * i / count;
    station.origin = Vector(40 + 90 * std::cos(angle), 50 + 90 * std::sin(angle), i % 4);
    station.phase = 0.0013 * i;
    stations.push_back(station);
  }
  return stations;
}

void simulate(const FieldScenario& scenario, int runs) {
  constexpr double kDensity = 0.3;  // of the targets' white acceleration [m^2/s^3]
  constexpr double kLook = 0.25;    // [s]
  double squares = 0.0, bound_squares = 0.0, velocity_squares = 0.0, velocity_bound = 0.0, nees = 0.0,
         used = 0.0;
  std::size_t looks = 0, found = 0, tracks = 0, ghosts = 0, matched = 0;
  std::vector<double> changes;
  for (int run = 1; run <= runs; ++run) {
    const auto seed = static_cast<std::uint64_t>(run);
    const WanderingPaths truth(scenario.targets, scenario.duration, kDensity, seed);
    std::vector<test::Path> paths;
    for (int i = 0; i < scenario.targets; ++i)
      paths.push_back([&truth, i](double t) { return truth.at(i, t); });
    auto stations =
        scenario.stations <= 4 ? test::fieldStations(scenario.stations) : ringOf(scenario.stations);
    for (test::FieldStation& station : stations) {
      station.detection_probability = scenario.detection;
      station.clutter = scenario.clutter;
    }
    test::SimulatedField field(stations, paths, seed, core::TrackletParams{}.interval);
    core::PositionTracker tracker;
    std::vector<core::PositionBound> bounds(static_cast<std::size_t>(scenario.targets),
                                            core::PositionBound(100.0, 10.0));
    std::map<int, std::uint32_t> id_of;
    double next = scenario.settled, next_report = 0.0, before = 0.0;
    int changed = 0;
    for (auto message = field.next(); message.time < scenario.duration; message = field.next()) {
      for (int i = 0; i < scenario.targets; ++i) {
        core::PositionBound& bound = bounds[static_cast<std::size_t>(i)];
        bound.predict(message.time - before, kDensity);
        const auto station = std::find_if(stations.begin(), stations.end(), [&](const test::FieldStation& s) {
          return s.name == message.tracks.tracker;
        });
        // A sighting with probability P_D is worth P_D sightings.
        bound.see(station->origin, truth.at(i, message.time),
                  station->sigma * station->sigma / scenario.detection);
      }
      before = message.time;
      const double start = processorTime();
      tracker.onTracklets(message.tracklets);
      tracker.onTracks(message.tracks);
      if (message.time < next_report) {
        used += processorTime() - start;
        continue;
      }
      next_report += 0.1;
      const auto output = tracker.report();
      used += processorTime() - start;
      if (!output || message.time < next) continue;
      next += kLook;
      const double t = secondsOf(output->tracks.time);
      std::set<int> seen;
      for (const core::PositionTrack& track : output->tracks.tracks) {
        if (track.status != core::TrackStatus::confirmed) continue;
        ++tracks;
        int target = -1;
        double reach = 2.0;  // [m]
        for (int i = 0; i < scenario.targets; ++i) {
          const double distance = (truth.at(i, t) - track.position).norm();
          if (distance >= reach) continue;
          reach = distance;
          target = i;
        }
        if (target < 0 || !seen.insert(target).second) {
          ++ghosts;
          continue;
        }
        const Vector error = track.position - truth.at(target, t);
        const auto P = bounds[static_cast<std::size_t>(target)].covariance();
        squares += error.squaredNorm();
        bound_squares += P.topLeftCorner<3, 3>().trace();
        velocity_squares += (track.velocity - truth.velocityAt(target, t)).squaredNorm();
        velocity_bound += P.bottomRightCorner<3, 3>().trace();
        nees += neesOf(track, error);
        ++matched;
        const auto [id, is_new] = id_of.emplace(target, track.id);
        if (!is_new && id->second != track.id) {
          ++changed;
          id->second = track.id;
        }
      }
      looks += static_cast<std::size_t>(scenario.targets);
      found += seen.size();
    }
    changes.push_back(changed);
  }
  const auto count = static_cast<double>(std::max<std::size_t>(matched, 1));
  std::printf("%-34s %8.4f %8.4f %6.0f %8.3f %8.2f %8.3f %8.2f %8.2f %8.3f\n", scenario.name,
              static_cast<double>(found) / static_cast<double>(looks),
              static_cast<double>(ghosts) / static_cast<double>(std::max<std::size_t>(tracks, 1)),
              median(changes), std::sqrt(squares / count), std::sqrt(squares / bound_squares),
              std::sqrt(velocity_squares / count), std::sqrt(velocity_squares / velocity_bound), nees / count,
              used / (scenario.duration * runs));
}

}  // namespace

void simulatedFields(int runs) {
  std::printf("\nsimulated: white acceleration of 0.3 m^2/s^3, sigma 0.5 mrad at 30 Hz, %d runs\n", runs);
  std::printf("%-34s %8s %8s %6s %8s %8s %8s %8s %8s %8s\n", "", "found", "ghosts", "ids", "rms m", "/bound",
              "m/s", "/bound", "ANEES", "of a core");
  const FieldScenario scenarios[] = {{"4 stations x 3 targets", 4, 3, 20.0, 1.0, 0.0, 4.0},
                                     {"4 x 10, P_D 0.9, 2 false a scan", 4, 10, 20.0, 0.9, 2.0, 4.0},
                                     {"2 x 10, P_D 0.9", 2, 10, 20.0, 0.9, 0.0, 10.0},
                                     {"20 x 10, P_D 0.9, 1 false a scan", 20, 10, 10.0, 0.9, 1.0, 4.0}};
  for (const FieldScenario& scenario : scenarios) simulate(scenario, scenario.stations > 4 ? 1 : runs);
}

}  // namespace sightline::bench
