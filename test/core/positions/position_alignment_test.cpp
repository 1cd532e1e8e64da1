// Stations that are off, from local tracks to positions.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "support/simulated_field.h"

namespace sightline::core {
namespace {

using test::FieldMessage;
using test::Path;
using test::SimulatedField;
using Vector = Eigen::Vector3d;

Path circle(const Vector& centre, double radius, double rate, double phase) {
  return [=](double t) {
    return Vector(centre.x() + radius * std::cos(rate * t + phase),
                  centre.y() + radius * std::sin(rate * t + phase),
                  centre.z() + 2.0 * std::sin(0.7 * rate * t + phase));
  };
}

const std::vector<Path> kPaths{circle({45, 55, 25}, 15, 0.4, 0.0), circle({35, 45, 20}, 10, 0.5, 2.0),
                               circle({50, 40, 30}, 12, 0.3, 4.0)};
const Vector kTurned = 5e-3 * Vector(0.5, -0.6, 0.62).normalized();  // [rad]
constexpr double kLate = 0.05;                                       // [s]

void disturb(FieldMessage& message) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(kTurned.norm(), kTurned.normalized()).toRotationMatrix();
  message.tracks.time += durationOf(kLate);
  message.tracks.pose.R_metric_station = R * message.tracks.pose.R_metric_station;
  for (StationTracklet& tracklet : message.tracklets) {
    tracklet.tracklet.time += durationOf(kLate);
    tracklet.pose.R_metric_station = R * tracklet.pose.R_metric_station;
  }
}

/// The last report after `duration` [s] of `stations` stations, of which the one named is off.
PositionOutput run(int stations, const std::string& faulty, double duration, std::uint64_t seed,
                   const std::vector<Path>& paths = kPaths) {
  SimulatedField field(test::fieldStations(stations), paths, seed);
  PositionTracker tracker;
  std::optional<PositionOutput> output;
  double next = 0.0;
  for (FieldMessage message = field.next(); message.time < duration; message = field.next()) {
    if (message.tracks.tracker == faulty) disturb(message);
    tracker.onTracklets(message.tracklets);
    tracker.onTracks(message.tracks);
    if (message.time < next) continue;
    next += 0.1;
    output = tracker.report();
  }
  return *output;
}

TEST(PositionAlignment, AStationTurnedBy5MilliradAnd50MillisecondsLateIsPutRightAndSupportsTheTargets) {
  for (const char* faulty : {"station_1", "station_4"}) {
    const PositionOutput output = run(4, faulty, 15.0, 3);
    ASSERT_EQ(output.report.stations.size(), 4u);
    for (const StationReport& station : output.report.stations) {
      EXPECT_EQ(station.is_corrected, station.tracker == faulty) << station.tracker;
      if (station.tracker != faulty) continue;
      EXPECT_NEAR(station.alignment->clock, kLate, 3.5 * station.alignment->clock_sigma);
      EXPECT_LT(station.alignment->clock_sigma, 0.01);
      for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(station.alignment->orientation(i), kTurned(i),
                    3.5 * station.alignment->orientation_sigma(i));
    }
    ASSERT_EQ(output.tracks.tracks.size(), 3u) << faulty;
    for (const PositionTrack& track : output.tracks.tracks) {
      EXPECT_EQ(track.sources.size(), 4u) << faulty << " " << track.id;
      double nearest = 1e9;
      for (const Path& path : kPaths)
        nearest =
            std::min(nearest, (path(seconds(output.tracks.time.time_since_epoch())) - track.position).norm());
      EXPECT_LT(nearest, 0.15);
    }
  }
}

TEST(PositionAlignment, StationsThatAreRightAreNotCorrected) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    for (const StationReport& station : run(4, "", 10.0, seed).report.stations) {
      EXPECT_FALSE(station.is_corrected) << station.tracker;
      EXPECT_FALSE(station.is_undecided) << station.tracker;
    }
  }
}

TEST(PositionAlignment, OneTargetThatStationsSeeElsewhereSaysNothingOfThem) {
  const PositionOutput output = run(4, "station_4", 10.0, 4, {kPaths[0]});
  for (const StationReport& station : output.report.stations) EXPECT_FALSE(station.is_corrected);
}

}  // namespace
}  // namespace sightline::core
