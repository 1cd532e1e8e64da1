#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "sightline/core/fusion/track_fusion.h"
#include "sightline/core/model/sphere.h"
#include "sightline/core/tracking/local_tracker.h"
#include "sightline/core/tracking/tracklet_builder.h"

/// Sensors with trackers of their own, a link with delays and losses, and a fusion of their tracks and
/// tracklets: for tests of the fusion against one tracker that is given every sighting.
namespace sightline::test {

/// A sensor that sights one target.
struct PlatformSensor {
  std::string tracker;     // whose sighting it is
  std::string name;        // of the sensor
  double interval = 0.03;  // [s]
  double phase = 0.0;      // of the first scan [s]
  double sigma = 1e-3;     // [rad]
  double latency = 0.0;    // of the tracker's messages [s]
};

/// Trackers of their own sightings would learn the sensors' noise a little differently.
inline core::LocalTrackerParams trackerThatLearnsNoSensorsNoise() {
  core::LocalTrackerParams params;
  params.noise_calibration.enabled = false;
  return params;
}

struct Platform {
  core::LocalTrackerParams tracker = trackerThatLearnsNoSensorsNoise();
  core::TrackletParams tracklets;
  core::TrackFusionParams fusion;
  std::vector<PlatformSensor> sensors;
  std::function<Eigen::Vector2d(double)> path;  // (azimuth, elevation) [rad] at t [s]
  double duration = 4.0;                        // [s]
  unsigned seed = 1;

  /// Whether the sensor sights at t; whether the tracker's tracklets of this stamp are lost on the way.
  std::function<bool(const PlatformSensor&, double)> sights = [](const PlatformSensor&, double) {
    return true;
  };
  std::function<bool(const std::string&, double)> loses = [](const std::string&, double) { return false; };
  /// Added to what a sensor sees [rad].
  std::function<Eigen::Vector2d(const PlatformSensor&, double)> bias = [](const PlatformSensor&, double) {
    return Eigen::Vector2d::Zero().eval();
  };
  /// Delay of one message beyond the sensor's latency [s].
  std::function<double(std::mt19937_64&)> delay = [](std::mt19937_64&) { return 0.0; };
};

/// What a tracker sends, and when it arrives.
struct Message {
  double arrival = 0.0;
  core::LocalReport tracks;
  std::optional<core::TrackletReport> tracklets;
};

inline core::Time platformTime(double t) {
  return core::Time(std::chrono::seconds(1000)) + core::durationOf(t);
}

struct PlatformRun {
  std::vector<core::FusionReport> fused;  // after every message
  std::vector<core::Track> central;       // of the tracker that is given every sighting, at every scan
  std::vector<core::Time> central_times;
};

/// Scans in order of time, each with its sensor.
inline std::vector<std::pair<const PlatformSensor*, core::Scan>> scansOf(const Platform& platform) {
  std::mt19937_64 random(platform.seed);
  std::normal_distribution<double> normal;
  std::vector<std::pair<const PlatformSensor*, core::Scan>> scans;
  for (const PlatformSensor& sensor : platform.sensors) {
    for (double t = sensor.phase; t <= platform.duration; t += sensor.interval) {
      const double n1 = normal(random), n2 = normal(random);
      if (!platform.sights(sensor, t)) continue;
      core::Scan scan;
      scan.time = platformTime(t);
      scan.sensor = sensor.name;
      const Eigen::Vector2d angles =
          platform.path(t) + sensor.sigma * Eigen::Vector2d(n1, n2) + platform.bias(sensor, t);
      scan.sightings = {core::sightingOf(angles, sensor.sigma * sensor.sigma * Eigen::Matrix2d::Identity())};
      scans.emplace_back(&sensor, scan);
    }
  }
  std::stable_sort(scans.begin(), scans.end(),
                   [](const auto& a, const auto& b) { return a.second.time < b.second.time; });
  return scans;
}

inline PlatformRun run(const Platform& platform) {
  PlatformRun result;
  core::LocalTracker central(platform.tracker);
  std::map<std::string, core::LocalTracker> trackers;
  std::map<std::string, core::TrackletBuilder> builders;
  std::mt19937_64 random(platform.seed + 1000);
  std::vector<Message> messages;
  for (const auto& [sensor, scan] : scansOf(platform)) {
    const core::ScanReport whole = central.onScan(scan);
    if (whole.tracks.size() == 1) {
      result.central.push_back(whole.tracks[0]);
      result.central_times.push_back(whole.time);
    }
    auto& tracker = trackers.try_emplace(sensor->tracker, platform.tracker).first->second;
    auto& builder = builders.try_emplace(sensor->tracker, platform.tracklets).first->second;
    const core::ScanReport report = tracker.onScan(scan);
    const double t = core::seconds(scan.time - platformTime(0.0));
    Message message{t + sensor->latency + platform.delay(random),
                    {sensor->tracker, report.time, report.tracks},
                    builder.onScan(scan, report)};
    if (message.tracklets) message.tracklets->tracker = sensor->tracker;
    if (platform.loses(sensor->tracker, t)) message.tracklets.reset();
    messages.push_back(message);
  }
  std::stable_sort(messages.begin(), messages.end(),
                   [](const Message& a, const Message& b) { return a.arrival < b.arrival; });
  core::TrackFusion fusion(platform.fusion);
  for (const Message& message : messages) {
    if (message.tracklets) fusion.onTracklets(*message.tracklets);
    result.fused.push_back(fusion.onReport(message.tracks));
  }
  // The newest once more: what came after it is in the last fusion, too.
  const auto newest =
      std::max_element(messages.begin(), messages.end(),
                       [](const Message& a, const Message& b) { return a.tracks.time < b.tracks.time; });
  if (newest != messages.end()) result.fused.push_back(fusion.onReport(newest->tracks));
  return result;
}

/// Largest difference of two states, in units of `b`'s standard deviations.
inline double disagreement(const core::AngularState& a, const core::AngularState& b) {
  const Eigen::Vector4d sigma = b.covariance.diagonal().cwiseSqrt();
  Eigen::Vector4d mean = a.mean - b.mean;
  mean(0) = core::wrapAngle(mean(0));
  const Eigen::Matrix4d covariance =
      sigma.cwiseInverse().asDiagonal() * (a.covariance - b.covariance) * sigma.cwiseInverse().asDiagonal();
  return std::max(mean.cwiseQuotient(sigma).cwiseAbs().maxCoeff(), covariance.cwiseAbs().maxCoeff());
}

}  // namespace sightline::test
