// How many tracks and ids the fusion makes of its trackers' tracks.
#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "sightline/core/fusion/track_fusion.h"
#include "sightline/core/tracking/local_tracker.h"
#include "sightline/core/tracking/tracklet_builder.h"

#include "support/tracklet_platform.h"

namespace sightline::core {
namespace {

using Eigen::Vector2d;
using test::platformTime;

/// Counts how often the id of the track at a target changes.
class IdChanges {
 public:
  void take(const std::vector<Vector2d>& targets, const std::vector<Track>& tracks) {
    for (std::size_t k = 0; k < targets.size(); ++k) {
      double least = kReach;
      std::uint32_t id = 0;
      for (const Track& track : tracks) {
        const double distance = (track.state.angles() - targets[k]).norm();
        if (track.status == TrackStatus::tentative || distance >= least) continue;
        least = distance;
        id = track.id;
      }
      if (id == 0) continue;
      const auto last = last_.find(k);
      if (last != last_.end() && last->second != id) ++count;
      last_[k] = id;
    }
  }

  int count = 0;

 private:
  static constexpr double kReach = 5e-3;  // of a track of a target [rad]
  std::map<std::size_t, std::uint32_t> last_;
};

/// Targets that cross one another and hide for up to 3.5 s, before one sensor with clutter.
struct Scene {
  explicit Scene(unsigned seed) : random(seed), targets(2 + seed % 6), velocities(targets.size()) {
    hidden.assign(targets.size(), 0.0);
    for (std::size_t k = 0; k < targets.size(); ++k) {
      targets[k] = {inBox(random), inBox(random)};
      velocities[k] = 0.3 * Vector2d(inBox(random), inBox(random));
    }
    detection_probability = 0.6 + 0.1 * (seed % 4);
    clutter = static_cast<int>(seed % 5);
  }

  Scan next(int number) {
    Scan scan;
    scan.time = platformTime(kInterval * number);
    scan.sensor = "eye";
    const auto add = [&](const Vector2d& angles) {
      scan.sightings.push_back(sightingOf(angles, kSigma * kSigma * Eigen::Matrix2d::Identity()));
    };
    for (std::size_t k = 0; k < targets.size(); ++k) {
      targets[k] += kInterval * velocities[k];
      for (int c = 0; c < 2; ++c) {
        if (std::abs(targets[k](c)) > 0.03)
          velocities[k](c) = -std::copysign(velocities[k](c), targets[k](c));
      }
      if (hidden[k] > 0.0) {
        hidden[k] -= kInterval;
      } else if (share(random) < 0.004) {
        hidden[k] = 3.5 * share(random);
      }
      const Vector2d noise(normal(random), normal(random));
      if (hidden[k] <= 0.0 && share(random) < detection_probability) add(targets[k] + kSigma * noise);
    }
    for (int n = 0; n < clutter; ++n) add({inBox(random), inBox(random)});
    return scan;
  }

  static constexpr double kInterval = 0.05, kSigma = 5e-4;
  std::mt19937_64 random;
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> inBox{-0.03, 0.03}, share{0.0, 1.0};
  std::vector<Vector2d> targets, velocities;
  std::vector<double> hidden;  // for so long [s]
  double detection_probability = 1.0;
  int clutter = 0;
};

TEST(TrackFusionIds, TheFusionOfOneTrackerHasNoMoreChangesThanTheTracker) {
  int of_tracker = 0;
  for (unsigned seed = 1; seed <= 24; ++seed) {
    Scene scene(seed);
    LocalTracker tracker{LocalTrackerParams{}};
    TrackletBuilder builder{TrackletParams{}};
    TrackFusion fusion{TrackFusionParams{}};
    IdChanges source, fused;
    for (int k = 0; k < 600; ++k) {
      const Scan scan = scene.next(k);
      const ScanReport report = tracker.onScan(scan);
      if (auto tracklets = builder.onScan(scan, report)) {
        tracklets->tracker = "a";
        fusion.onTracklets(*tracklets);
      }
      std::vector<Track> global;
      for (const FusedTrack& track : fusion.onReport({"a", report.time, report.tracks}).tracks)
        global.push_back(track.track);
      source.take(scene.targets, report.tracks);
      fused.take(scene.targets, global);
    }
    EXPECT_LE(fused.count, source.count) << "seed " << seed;
    of_tracker += source.count;
  }
  EXPECT_GT(of_tracker, 100) << "there was something to tell";
}

TEST(TrackFusionIds, ATrackThatReturnsAfterItsGlobalTrackWasDeletedHasItsIdAgain) {
  TrackFusion fusion{TrackFusionParams{}};
  const auto report = [&fusion](double t, const std::vector<std::uint32_t>& ids, std::uint32_t hits) {
    LocalReport local{"a", platformTime(t), {}};
    for (const std::uint32_t id : ids) {
      Track track;
      track.id = id;
      track.status = TrackStatus::confirmed;
      track.state.mean << 0.1 * id, 0.0, 0.0, 0.0;
      track.state.covariance = 1e-6 * Eigen::Matrix4d::Identity();
      track.hits = hits;
      track.last_sighting = local.time;
      local.tracks.push_back(track);
    }
    std::vector<std::uint32_t> global;
    for (const FusedTrack& track : fusion.onReport(local).tracks) global.push_back(track.track.id);
    return global;
  };
  using Ids = std::vector<std::uint32_t>;
  EXPECT_EQ(report(0.0, {1, 2}, 10), (Ids{1, 2}));
  for (double t = 10.0; t < 60.0; t += 10.0) EXPECT_EQ(report(t, {2}, 10), Ids{2});
  EXPECT_EQ(report(60.0, {1, 2}, 11), (Ids{1, 2})) << "a sensor of one look in ten seconds";
  report(70.0, {2}, 12);
  report(80.0, {2}, 12);
  EXPECT_EQ(report(90.0, {1, 2}, 3), (Ids{2, 3})) << "fewer hits: another track under the same id";
}

TEST(TrackFusionIds, ASensorThatBecomesBiasedMakesNoSecondTrackBesideTheTarget) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    test::Platform platform;
    platform.tracker = LocalTrackerParams{};
    platform.tracker.estimator.kind = EstimatorKind::noga;
    platform.fusion.tracklets.estimator.kind = EstimatorKind::noga;
    platform.duration = 10.0;
    platform.seed = seed;
    for (int k = 0; k < 6; ++k) {
      platform.sensors.push_back({"tracker " + std::to_string(k), "sensor " + std::to_string(k), 0.033,
                                  0.0055 * k, k < 3 ? 1e-3 : 5e-4, 0.01});
    }
    platform.path = [](double t) {
      return Vector2d(0.1 * std::sin(0.8 * t), 0.2 + 0.05 * std::sin(1.3 * t));
    };
    platform.bias = [](const test::PlatformSensor& sensor, double t) {
      const bool is_biased = sensor.name == "sensor 5" && t >= 5.0;
      return Vector2d::Constant(is_biased ? 4.0 * sensor.sigma : 0.0).eval();
    };
    std::size_t doubled = 0;
    double worst = 0.0;  // [rad]
    for (const FusionReport& report : test::run(platform).fused) {
      if (report.tracks.empty()) continue;
      const double t = seconds(report.time - platformTime(0.0));
      doubled += t >= 5.0 && report.tracks.size() > 1 ? 1 : 0;
      const Vector2d truth = platform.path(t);
      worst = std::max(worst, (report.tracks[0].track.state.angles() - truth).norm());
      EXPECT_EQ(report.tracks[0].track.id, 1u);
    }
    EXPECT_EQ(doubled, 0u) << "seed " << seed;
    EXPECT_LT(worst, 3e-3) << "seed " << seed;
  }
}

}  // namespace
}  // namespace sightline::core
