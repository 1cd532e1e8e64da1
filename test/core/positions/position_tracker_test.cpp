#include "sightline/core/positions/position_tracker.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "support/simulated_field.h"

namespace sightline::core {
namespace {

using test::FieldMessage;
using test::FieldStation;
using test::Path;
using test::SimulatedField;
using Vector = Eigen::Vector3d;

Path circle(const Vector& centre, double radius, double rate, double phase) {
  return [=](double t) {
    return Vector(centre.x() + radius * std::cos(rate * t + phase),
                  centre.y() + radius * std::sin(rate * t + phase),
                  centre.z() + 2.0 * std::sin(0.5 * rate * t + phase));
  };
}

void feed(PositionTracker& tracker, const FieldMessage& message) {
  EXPECT_TRUE(tracker.onTracklets(message.tracklets).empty()) << message.time;
  EXPECT_FALSE(tracker.onTracks(message.tracks)) << message.time;
}

std::optional<std::size_t> nearestTarget(const std::vector<Path>& paths, double t, const Vector& position,
                                         double reach) {
  std::optional<std::size_t> nearest;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const double distance = (paths[i](t) - position).norm();
    if (distance > reach) continue;
    nearest = i;
    reach = distance;
  }
  return nearest;
}

TEST(PositionTracker, OneTargetOfTwoStationsGetsOneConfirmedPositionWithAnHonestCovariance) {
  const std::vector<Path> paths{circle({45, 55, 25}, 15, 0.4, 0.0)};
  SimulatedField field(test::fieldStations(2), paths, 1);
  PositionTracker tracker;
  std::set<std::uint32_t> ids;
  double nees = 0.0, squares = 0.0, next = 2.0;
  int count = 0, missed = 0;
  for (FieldMessage message = field.next(); message.time < 15.0; message = field.next()) {
    feed(tracker, message);
    if (message.time < next) continue;
    next += 0.2;
    const auto output = tracker.report();
    ASSERT_TRUE(output);
    ASSERT_LE(output->tracks.tracks.size(), 1u);
    if (output->tracks.tracks.empty()) {
      ++missed;
      continue;
    }
    const PositionTrack& track = output->tracks.tracks[0];
    ids.insert(track.id);
    const Vector error = track.position - paths[0](seconds(output->tracks.time.time_since_epoch()));
    nees += error.dot(track.covariance.topLeftCorner<3, 3>().llt().solve(error)) / 3.0;
    squares += error.squaredNorm();
    ++count;
    if (message.time > 3.0) {
      EXPECT_EQ(track.status, TrackStatus::confirmed);
      EXPECT_EQ(track.sources.size(), 2u);
      EXPECT_GT(track.parallax, 0.5);
    }
  }
  EXPECT_EQ(missed, 0);
  EXPECT_EQ(ids, std::set<std::uint32_t>{1});
  EXPECT_LT(std::sqrt(squares / count), 0.1);
  EXPECT_GT(nees / count, 0.1);
  EXPECT_LT(nees / count, 1.6);
}

TEST(PositionTracker, PositionsAreForATimeNotBeforeWhatWasTakenThoughAStationsTracksComeLate) {
  const std::vector<Path> paths{circle({45, 55, 25}, 15, 1.0, 0.0)};  // 15 m/s
  SimulatedField field(test::fieldStations(3), paths, 1);
  PositionTracker tracker;
  std::vector<StationTracks> late;
  double next = 3.0;
  int count = 0;
  for (FieldMessage message = field.next(); message.time < 6.0; message = field.next()) {
    EXPECT_TRUE(tracker.onTracklets(message.tracklets).empty()) << message.time;
    late.push_back(message.tracks);
    while (!late.empty() && message.time - seconds(late.front().time.time_since_epoch()) > 0.2) {
      EXPECT_FALSE(tracker.onTracks(late.front())) << message.time;
      late.erase(late.begin());
    }
    if (message.time < next) continue;
    next += 0.1;
    const auto output = tracker.report();
    ASSERT_TRUE(output);
    for (const PositionTrack& track : output->tracks.tracks) {
      const double time = seconds(output->tracks.time.time_since_epoch());
      EXPECT_GE(output->tracks.time, track.last_sighting);
      EXPECT_LT((track.position - paths[0](time)).norm(), 0.4) << "15 m/s in 0.2 s are 3 m";
      ++count;
    }
  }
  EXPECT_GT(count, 20);
}

struct SwarmFigures {
  double found = 0.0, ghosts = 0.0;  // share of the targets' time; of the tracks' time
  int changes = 0;                   // of id
};

SwarmFigures swarm(int stations_count, int targets, double seconds_long, double detection, double clutter,
                   std::uint64_t seed, double from) {
  RandomStream random(seed);
  std::vector<Path> paths;
  for (int i = 0; i < targets; ++i) {
    const Vector centre(25 + 30 * random.uniform(), 35 + 30 * random.uniform(), 15 + 20 * random.uniform());
    paths.push_back(
        circle(centre, 8 + 12 * random.uniform(), 0.3 + 0.3 * random.uniform(), 6.28 * random.uniform()));
  }
  std::vector<FieldStation> stations = test::fieldStations(stations_count);
  for (FieldStation& station : stations) {
    station.detection_probability = detection;
    station.clutter = clutter;
  }
  SimulatedField field(stations, paths, seed);
  PositionTracker tracker;
  SwarmFigures figures;
  int looks = 0, found = 0, tracks = 0, ghosts = 0;
  std::map<std::size_t, std::uint32_t> id_of;
  double next = from;
  for (FieldMessage message = field.next(); message.time < seconds_long; message = field.next()) {
    feed(tracker, message);
    if (message.time < next) continue;
    next += 0.25;
    const auto output = tracker.report();
    std::set<std::size_t> seen;
    for (const PositionTrack& track : output->tracks.tracks) {
      if (track.status != TrackStatus::confirmed) continue;
      ++tracks;
      const auto target =
          nearestTarget(paths, seconds(output->tracks.time.time_since_epoch()), track.position, 2.0);
      if (!target || !seen.insert(*target).second) {
        ++ghosts;
        continue;
      }
      auto [it, is_new] = id_of.emplace(*target, track.id);
      if (!is_new && it->second != track.id) {
        ++figures.changes;
        it->second = track.id;
      }
    }
    looks += targets;
    found += static_cast<int>(seen.size());
  }
  figures.found = static_cast<double>(found) / looks;
  figures.ghosts = tracks ? static_cast<double>(ghosts) / tracks : 0.0;
  return figures;
}

TEST(PositionTracker, ASwarmInClutterIsFoundWithoutGhosts) {
  const SwarmFigures figures = swarm(4, 10, 15.0, 0.9, 2.0, 3, 4.0);
  EXPECT_GE(figures.found, 0.97);
  EXPECT_LE(figures.ghosts, 0.01);
  EXPECT_LE(figures.changes, 1);
}

TEST(PositionTracker, TheSamePositionsComeOutInWhateverOrderTheMessagesCome) {
  const std::vector<Path> paths{circle({45, 55, 25}, 15, 0.4, 0.0), circle({35, 45, 20}, 10, 0.5, 2.0)};
  SimulatedField field(test::fieldStations(3), paths, 4);
  std::vector<FieldMessage> messages;
  for (FieldMessage message = field.next(); message.time < 6.0; message = field.next())
    messages.push_back(message);

  PositionTracker in_order;
  in_order.keepMeasurements();
  std::vector<TakenMeasurement> taken, taken_shuffled;
  const auto handOut = [](PositionTracker& tracker, bool all, std::vector<TakenMeasurement>& to) {
    for (const TakenMeasurement& one : tracker.handOut(all)) to.push_back(one);
  };
  for (const FieldMessage& message : messages) {
    feed(in_order, message);
    in_order.report();
    handOut(in_order, false, taken);
  }
  // Each message is late by up to 0.4 s.
  std::mt19937 random(2);
  std::vector<std::pair<double, std::size_t>> arrival;
  for (std::size_t i = 0; i < messages.size(); ++i)
    arrival.emplace_back(messages[i].time + 0.4 * static_cast<double>(random() % 1000) / 1000.0, i);
  std::sort(arrival.begin(), arrival.end());
  PositionTracker shuffled;
  shuffled.keepMeasurements();
  for (const auto& [time, i] : arrival) {
    feed(shuffled, messages[i]);
    shuffled.report();
    handOut(shuffled, false, taken_shuffled);
  }
  const auto a = in_order.report(), b = shuffled.report();
  ASSERT_TRUE(a && b);
  ASSERT_EQ(a->tracks.tracks.size(), 2u);
  ASSERT_EQ(b->tracks.tracks.size(), 2u);
  EXPECT_EQ(a->tracks.time, b->tracks.time);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(a->tracks.tracks[i].id, b->tracks.tracks[i].id);
    EXPECT_EQ(a->tracks.tracks[i].position, b->tracks.tracks[i].position);
    EXPECT_EQ(a->tracks.tracks[i].covariance, b->tracks.tracks[i].covariance);
    EXPECT_EQ(a->tracks.tracks[i].sources, b->tracks.tracks[i].sources);
  }
  // So are the measurements that they came of, handed out once.
  handOut(in_order, true, taken);
  handOut(shuffled, true, taken_shuffled);
  ASSERT_EQ(taken.size(), taken_shuffled.size());
  EXPECT_GT(taken.size(), 500u);
  for (std::size_t i = 0; i < taken.size(); ++i) {
    EXPECT_EQ(taken[i].target, taken_shuffled[i].target) << i;
    EXPECT_EQ(taken[i].measurement.time, taken_shuffled[i].measurement.time) << i;
    EXPECT_EQ(taken[i].measurement.ray.direction, taken_shuffled[i].measurement.ray.direction) << i;
  }
  EXPECT_TRUE(in_order.handOut(true).empty());
}

TEST(PositionTracker, OneStationLeftAloneHoldsThePositionForAWhileAndTheIdUntilASecondReturns) {
  const std::vector<Path> paths{circle({45, 55, 25}, 15, 0.4, 0.0)};
  auto stations = test::fieldStations(2);
  stations[1].sees = [](double t) { return t < 5.0 || t > 13.0; };
  SimulatedField field(stations, paths, 5);
  PositionTracker tracker;
  std::set<std::uint32_t> ids;
  double last_alone = 0.0, next = 1.0;
  bool is_back = false, was_direction = false;
  for (FieldMessage message = field.next(); message.time < 17.0; message = field.next()) {
    feed(tracker, message);
    if (message.time < next) continue;
    next += 0.1;
    const auto output = tracker.report();
    for (const PositionTrack& track : output->tracks.tracks) ids.insert(track.id);
    const bool has_position = !output->tracks.tracks.empty();
    if (message.time > 5.0 && message.time < 13.0 && has_position) last_alone = message.time;
    if (message.time > 9.0 && message.time < 13.0 && !has_position) {
      was_direction = true;
      ASSERT_EQ(output->report.unlocated.size(), 1u);
      EXPECT_EQ(output->report.unlocated[0].reason.kind, "one station only");
    }
    if (message.time > 16.0) is_back = has_position;
  }
  EXPECT_GT(last_alone, 6.0);
  EXPECT_TRUE(was_direction);
  EXPECT_TRUE(is_back);
  EXPECT_EQ(ids, std::set<std::uint32_t>{1});
}

/// Stations at (0, 0, 2), (100, 0, 2) and, from `third` [s] on, (50, 160, 4).
std::vector<FieldStation> stationsOfAPair(double third) {
  std::vector<FieldStation> stations = test::fieldStations(3);
  stations[0].origin = Vector(0, 0, 2);
  stations[1].origin = Vector(100, 0, 2);
  stations[2].origin = Vector(50, 160, 4);
  stations[2].sees = [third](double t) { return t >= third; };
  for (FieldStation& station : stations) station.detection_probability = 0.95;
  return stations;
}

// In one plane with the baseline of the only two stations, side by side or towards each other: all four
// crossings move as targets do, and the wrong ones are the sharper ones.
TEST(PositionTracker, APairInThePlaneOfTheBaselineIsAmbiguousUntilAThirdStationSolvesIt) {
  const std::vector<std::vector<Path>> pairs{{[](double t) { return Vector(20 + 0.7 * t, 60, 17); },
                                              [](double t) { return Vector(60 + 0.7 * t, 60, 17); }},
                                             {[](double t) { return Vector(20 + 0.7 * t, 60, 17); },
                                              [](double t) { return Vector(80 - 0.7 * t, 75, 20.75); }}};
  constexpr double kThird = 8.0;  // [s]
  for (const std::vector<Path>& paths : pairs) {
    SimulatedField field(stationsOfAPair(kThird), paths, 6);
    PositionTracker tracker;
    int looks = 0, ambiguous = 0;
    double next = 1.0;
    for (FieldMessage message = field.next(); message.time < 12.0; message = field.next()) {
      feed(tracker, message);
      if (message.time < next) continue;
      next += 0.1;
      const auto output = tracker.report();
      const double t = seconds(output->tracks.time.time_since_epoch());
      std::set<std::size_t> found;
      for (const PositionTrack& track : output->tracks.tracks) {
        const auto target = nearestTarget(paths, t, track.position, 3.0);
        EXPECT_TRUE(target || track.status == TrackStatus::tentative)
            << t << " s: " << track.position.transpose();
        if (target && track.status == TrackStatus::confirmed && track.sources.size() == 3)
          found.insert(*target);
      }
      if (t < kThird) {
        ++looks;
        const auto said =
            std::count_if(output->report.refused.begin(), output->report.refused.end(),
                          [](const auto& refused) { return refused.reason.kind == "ambiguous"; });
        if (said == 4) ++ambiguous;
        if (said == 4) {
          EXPECT_EQ(output->report.unlocated.size(), 4u) << t;
        }
      }
      if (t > kThird + 2.0) {
        EXPECT_EQ(found.size(), 2u) << t;
      }
    }
    EXPECT_GE(ambiguous, looks - 2) << "of " << looks;
  }
}

TEST(PositionTracker, APairThatCrossesThePlaneOfTheBaselineForAWhileKeepsItsPositionsAndIds) {
  const std::vector<Path> paths{
      [](double t) { return Vector(20 + 0.7 * t, 60, 17); },
      [](double t) {
        return Vector(60 + 0.7 * t, 60, 17 + 0.8 * (std::max(4.0 - t, 0.0) + std::max(t - 10.0, 0.0)));
      }};
  SimulatedField field(stationsOfAPair(1e9), paths, 7);
  PositionTracker tracker;
  std::map<std::size_t, std::set<std::uint32_t>> ids;
  double next = 2.0;
  for (FieldMessage message = field.next(); message.time < 14.0; message = field.next()) {
    feed(tracker, message);
    if (message.time < next) continue;
    next += 0.1;
    const auto output = tracker.report();
    const double t = seconds(output->tracks.time.time_since_epoch());
    ASSERT_EQ(output->tracks.tracks.size(), 2u) << t;
    for (const PositionTrack& track : output->tracks.tracks) {
      const auto target = nearestTarget(paths, t, track.position, 2.0);
      ASSERT_TRUE(target) << t;
      EXPECT_EQ(track.status, TrackStatus::confirmed);
      ids[*target].insert(track.id);
    }
  }
  EXPECT_EQ(ids[0].size(), 1u);
  EXPECT_EQ(ids[1].size(), 1u);
}

TEST(PositionTracker, AStationWhoseClockIsLateIsFoundAndSaid) {
  const std::vector<Path> paths{circle({45, 55, 25}, 20, 0.6, 0.0), circle({40, 50, 15}, 18, 0.5, 2.0),
                                circle({50, 45, 35}, 15, 0.7, 4.0)};
  SimulatedField field(test::fieldStations(3), paths, 8);
  PositionTracker tracker;
  const Duration late = durationOf(0.05);
  double next = 1.0;
  std::optional<PositionOutput> output;
  for (FieldMessage message = field.next(); message.time < 20.0; message = field.next()) {
    if (message.tracks.tracker == "station_2") {
      message.tracks.time += late;
      for (StationTracklet& tracklet : message.tracklets) tracklet.tracklet.time += late;
    }
    feed(tracker, message);
    if (message.time < next) continue;
    next += 0.2;
    output = tracker.report();
  }
  ASSERT_EQ(output->report.stations.size(), 3u);
  const auto& late_one = output->report.stations[1].alignment;
  const auto& other = output->report.stations[0].alignment;
  ASSERT_TRUE(late_one && other);
  EXPECT_EQ(output->report.stations[1].tracker, "station_2");
  const double difference = late_one->clock - other->clock;
  EXPECT_NEAR(difference, 0.05, 3.0 * std::hypot(late_one->clock_sigma, other->clock_sigma));
  EXPECT_LT(late_one->clock_sigma, 0.02);
  EXPECT_GT(difference, 0.025);
}

TEST(PositionTracker, LateDoubleAndBadInputIsRefusedWithItsReason) {
  SimulatedField field(test::fieldStations(2), {circle({45, 55, 25}, 15, 0.4, 0.0)}, 7);
  PositionTracker tracker;
  EXPECT_FALSE(tracker.report());
  std::vector<FieldMessage> messages;
  for (FieldMessage message = field.next(); message.time < 4.0; message = field.next())
    messages.push_back(message);
  for (const FieldMessage& message : messages) feed(tracker, message);
  tracker.report();
  EXPECT_EQ(tracker.onTracks(messages.back().tracks)->kind, "duplicate");
  EXPECT_EQ(tracker.onTracks(messages.front().tracks)->kind, "late");
  StationTracks bad = messages.back().tracks;
  bad.time += durationOf(1.0);
  bad.pose.origin.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(tracker.onTracks(bad)->kind, "invalid");
  const auto with_tracklets = std::find_if(messages.begin(), messages.end(),
                                           [](const FieldMessage& m) { return !m.tracklets.empty(); });
  ASSERT_NE(with_tracklets, messages.end());
  StationTracklet tracklet = with_tracklets->tracklets.front();
  tracklet.tracklet.sighting.covariance.setZero();
  ASSERT_EQ(tracker.onTracklets({tracklet}).size(), 1u);
  EXPECT_EQ(tracker.onTracklets({tracklet})[0].kind, "invalid");

  PositionTrackerParams params;
  params.max_lag = -1.0;
  EXPECT_THROW(PositionTracker{params}, std::invalid_argument);
  params = {};
  params.scene.claim_decisions = 0;
  EXPECT_THROW(PositionTracker{params}, std::invalid_argument);
}

TEST(PositionTracker, NamesOfTrackersAndSensorsAreBounded) {
  PositionTracker tracker;
  int refused = 0;
  for (int i = 0; i < 3000; ++i) {
    StationTracks tracks;
    tracks.tracker = "station " + std::to_string(i);
    tracks.time = Time(std::chrono::milliseconds(i));
    const auto refusal = tracker.onTracks(tracks);
    if (!refusal) continue;
    EXPECT_EQ("limit", refusal->kind);
    ++refused;
  }
  EXPECT_EQ(3000 - 1024, refused);
  StationTracks known;
  known.tracker = "station 5";
  known.time = Time(std::chrono::seconds(3));
  EXPECT_FALSE(tracker.onTracks(known));
}

}  // namespace
}  // namespace sightline::core
