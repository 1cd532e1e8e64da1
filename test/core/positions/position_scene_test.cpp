#include "sightline/core/positions/position_scene.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "sightline/core/simulation/random_stream.h"

namespace sightline::core {
namespace {

using Vector = Eigen::Vector3d;

constexpr double kSigma = 5e-4;  // [rad]
constexpr double kStep = 0.05;   // [s]

const std::vector<Vector> kOrigins{{0, 0, 0}, {100, 0, 2}, {90, 110, 5}, {-30, 90, 1}};

/// What one station says of a target, as track 1 unless told otherwise.
struct Voice {
  PositionScene& scene;
  RandomStream random{7};
  double existence = std::numeric_limits<double>::quiet_NaN();  // that local trackers state

  void say(int station, double time, const Vector& target, const Vector& velocity, std::uint32_t id = 1,
           bool is_reported = true) {
    const Vector& origin = kOrigins[static_cast<std::size_t>(station)];
    const std::string name = "station_" + std::to_string(station);
    const Eigen::Vector2d angles = anglesOf(target - origin) + kSigma * random.normalPair();
    StationTracklet tracklet;
    tracklet.tracker = name;
    tracklet.track = id;
    tracklet.tracklet.time = Time(durationOf(time));
    tracklet.tracklet.sensor = "camera of " + name;
    tracklet.tracklet.sighting = sightingOf(angles, kSigma * kSigma * Eigen::Matrix2d::Identity());
    tracklet.pose.origin = origin;
    scene.take(tracklet);
    StationTracks tracks;
    tracks.tracker = name;
    tracks.time = tracklet.tracklet.time;
    tracks.pose.origin = origin;
    if (is_reported) {
      Track track;
      track.id = id;
      track.status = TrackStatus::confirmed;
      track.state.mean << anglesOf(target - origin),
          anglesJacobian((target - origin).normalized()) * velocity / (target - origin).norm();
      track.state.covariance.diagonal() << 1e-7, 1e-7, 1e-5, 1e-5;
      track.last_sighting = tracks.time;
      track.existence = existence;
      tracks.tracks = {track};
    }
    scene.take(tracks);
  }
};

Vector along(double t) {
  return Vector(40, 50, 20) + t * Vector(2, 1, 0);
}

const Vector kVelocity(2, 1, 0);

std::vector<PositionTrack> tracksAt(const PositionScene& scene, double time) {
  return scene.output(Time(durationOf(time))).tracks.tracks;
}

TEST(PositionScene, AFurtherStationSupportsTheTargetThatItAgreesWith) {
  PositionScene scene{PositionSceneParams{}};
  Voice voice{scene};
  for (int i = 1; i < 80; ++i)
    for (int station = 0; station < (i < 40 ? 2 : 3); ++station)
      voice.say(station, i * kStep, along(i * kStep), kVelocity);
  const auto tracks = tracksAt(scene, 79 * kStep);
  ASSERT_EQ(tracks.size(), 1u);
  EXPECT_EQ(tracks[0].sources, (std::vector<std::string>{"station_0/1", "station_1/1", "station_2/1"}));
  EXPECT_EQ(tracks[0].id, 1u);
}

// Two pairs of stations find the same target at once: four stations, of which each pair comes up for itself.
TEST(PositionScene, ExistenceIsThatOneOfTheTracksIsNotFalseAndThatTheyAreOfOneTarget) {
  PositionScene scene{PositionSceneParams{}};
  Voice voice{scene};
  voice.existence = 0.9;
  for (int i = 1; i < 40; ++i)
    for (int station = 0; station < 2; ++station) voice.say(station, i * kStep, along(i * kStep), kVelocity);
  const auto pair = tracksAt(scene, 39 * kStep);
  ASSERT_EQ(pair.size(), 1u);
  EXPECT_LT(pair[0].existence, 0.99) << "1 - 0.1^2, and the tracks may be of two targets";
  EXPECT_GT(pair[0].existence, 0.98);
  for (int i = 40; i < 80; ++i)
    for (int station = 0; station < 3; ++station) voice.say(station, i * kStep, along(i * kStep), kVelocity);
  const auto three = tracksAt(scene, 79 * kStep);
  ASSERT_EQ(three.size(), 1u);
  EXPECT_NEAR(three[0].existence, 0.999, 1e-3);
  EXPECT_GT(three[0].existence, pair[0].existence);
  EXPECT_LT(three[0].existence, 0.999);
}

/// Existence of a target that two stations see, while a third one without a track of it looks at `half_width`
/// [rad] round a direction of its own; nothing known of its view where that is 0.
double existenceWith(const Vector& looks_along, double half_width) {
  PositionScene scene{PositionSceneParams{}};
  Voice voice{scene};
  voice.existence = 0.999;
  for (int i = 1; i < 40; ++i) {
    for (int station = 0; station < 2; ++station) voice.say(station, i * kStep, along(i * kStep), kVelocity);
    StationTracks nothing;
    nothing.tracker = "station_2";
    nothing.time = Time(durationOf(i * kStep));
    nothing.pose.origin = kOrigins[2];
    if (half_width > 0.0) {
      FieldOfView view;
      view.R_sensor_tracking =
          Eigen::Quaterniond::FromTwoVectors(looks_along, Vector::UnitX()).toRotationMatrix();
      view.half_widths = {half_width, half_width};
      nothing.views = {view};
    }
    scene.take(nothing);
  }
  const auto tracks = tracksAt(scene, 39 * kStep);
  return tracks.size() == 1 ? tracks[0].existence : std::nan("");
}

TEST(PositionScene, AStationThatLooksAtATargetWithoutATrackOfItMakesItsExistenceLess) {
  const Vector to_target = along(2.0) - kOrigins[2];
  const double away = existenceWith(-to_target, 0.3), unknown = existenceWith(to_target, 0.0),
               there = existenceWith(to_target, 0.3);
  EXPECT_LT(there, unknown);
  EXPECT_LT(unknown, away);
  EXPECT_GT(away, 0.999) << "what it does not look at is not missed";
  // By (1 - P_D) of 0.1 and, half of the time, 0.55; odds that the tracks are of two targets.
  const auto odds = [](double existence) { return 1.0 / existence - 1.0; };
  EXPECT_NEAR(odds(there) - odds(away), (odds(unknown) - odds(away)) * 9.0 / (1.0 / 0.55 - 1.0),
              0.02 * odds(there));
}

TEST(PositionScene, TrackersThatStateNoExistenceTellHalfOfIt) {
  PositionScene scene{PositionSceneParams{}};
  Voice voice{scene};
  for (int i = 1; i < 40; ++i)
    for (int station = 0; station < 2; ++station) voice.say(station, i * kStep, along(i * kStep), kVelocity);
  const auto tracks = tracksAt(scene, 39 * kStep);
  ASSERT_EQ(tracks.size(), 1u);
  EXPECT_NEAR(tracks[0].existence, 0.75, 1e-3);
}

TEST(PositionScene, TwoTargetsThatAreOneAreMergedIntoTheOlder) {
  PositionScene scene{PositionSceneParams{}};
  Voice voice{scene};
  for (int i = 1; i < 120; ++i) {
    const double t = i * kStep;
    // Until 2 s stations 2 and 3 see another target, then their local track goes over to the first.
    const Vector other = along(t) + Vector(0, 0, i < 40 ? 15.0 : std::max(0.0, 15.0 - 0.5 * (i - 40)));
    const Vector other_velocity = kVelocity + Vector(0, 0, i < 40 || i > 70 ? 0.0 : -10.0);
    voice.say(0, t, along(t), kVelocity);
    voice.say(1, t, along(t), kVelocity);
    voice.say(2, t, other, other_velocity);
    voice.say(3, t, other, other_velocity);
    if (i == 39) {
      EXPECT_EQ(tracksAt(scene, t).size(), 2u);
    }
  }
  const auto tracks = tracksAt(scene, 119 * kStep);
  ASSERT_EQ(tracks.size(), 1u);
  EXPECT_EQ(tracks[0].id, 1u);
  EXPECT_EQ(tracks[0].sources.size(), 4u);
}

/// What a station says when it sees two targets, as tracks 1 and 2.
void sayBoth(PositionScene& scene, RandomStream& random, int station, const Vector& origin, double time,
             const std::vector<Vector>& targets, const Vector& velocity,
             const std::vector<std::uint32_t>& seen) {
  StationTracks tracks;
  tracks.tracker = "station_" + std::to_string(station);
  tracks.time = Time(durationOf(time));
  tracks.pose.origin = origin;
  for (const std::uint32_t id : seen) {
    const Vector to = targets[id - 1] - origin;
    StationTracklet tracklet;
    tracklet.tracker = tracks.tracker;
    tracklet.track = id;
    tracklet.tracklet.time = tracks.time;
    tracklet.tracklet.sensor = "camera of " + tracks.tracker;
    tracklet.tracklet.sighting = sightingOf(anglesOf(to) + kSigma * random.normalPair(),
                                            kSigma * kSigma * Eigen::Matrix2d::Identity());
    tracklet.pose.origin = origin;
    scene.take(tracklet);
    Track track;
    track.id = id;
    track.status = TrackStatus::confirmed;
    track.state.mean << anglesOf(to), anglesJacobian(to.normalized()) * velocity / to.norm();
    track.state.covariance.diagonal() << 1e-7, 1e-7, 1e-5, 1e-5;
    track.last_sighting = tracks.time;
    tracks.tracks.push_back(track);
  }
  scene.take(tracks);
}

// Station 0 sees only the first target for long, station 1 only the second, in one plane with the baseline:
// their only crossing is no target, and nothing says so. Then both see both, and at last a third station
// does.
TEST(PositionScene, ConfirmedPositionsThatALaterStationContradictsAreGivenUpForTheRightCrossings) {
  PositionScene scene{PositionSceneParams{}};
  RandomStream random(5);
  const std::vector<Vector> origins{{0, 0, 2}, {100, 0, 2}, {50, 160, 4}};
  const Vector velocity(0.7, 0, 0);
  std::set<std::uint32_t> ghosts, right;
  for (int i = 1; i < 400; ++i) {
    const double t = i * kStep;
    const std::vector<Vector> targets{Vector(20, 60, 17) + t * velocity, Vector(60, 60, 17) + t * velocity};
    const bool both = t > 5.0;
    sayBoth(scene, random, 0, origins[0], t, targets, velocity,
            both ? std::vector<std::uint32_t>{1, 2} : std::vector<std::uint32_t>{1});
    sayBoth(scene, random, 1, origins[1], t, targets, velocity,
            both ? std::vector<std::uint32_t>{1, 2} : std::vector<std::uint32_t>{2});
    if (t > 10.0) sayBoth(scene, random, 2, origins[2], t, targets, velocity, {1, 2});
    const auto tracks = tracksAt(scene, t);
    for (const PositionTrack& track : tracks) {
      const bool is_right = std::any_of(targets.begin(), targets.end(), [&](const Vector& target) {
        return (track.position - target).norm() < 2.0;
      });
      (is_right ? right : ghosts).insert(track.id);
      if (t > 11.5) {
        EXPECT_TRUE(is_right) << t << ": " << track.position.transpose();
        EXPECT_EQ(track.sources.size(), 3u) << t;
      }
    }
    if (t > 11.5) {
      EXPECT_EQ(tracks.size(), 2u) << t;
    }
  }
  EXPECT_FALSE(ghosts.empty()) << "nobody can tell before the third station";
  EXPECT_EQ(right.size(), 2u);
  for (const std::uint32_t id : right) EXPECT_EQ(ghosts.count(id), 0u) << "an id is not used again";
}

TEST(PositionScene, ASupporterThatContradictsTheOthersIsTakenOut) {
  PositionScene scene{PositionSceneParams{}};
  Voice voice{scene};
  for (int i = 1; i < 120; ++i) {
    const double t = i * kStep;
    for (int station = 0; station < 3; ++station) voice.say(station, t, along(t), kVelocity);
    const Vector off =
        i < 40 ? Vector::Zero() : Vector(0, 0, 0.2 * (i - 40));  // its local track follows another one
    voice.say(3, t, along(t) + off, kVelocity + (i < 40 ? Vector::Zero() : Vector(0, 0, 4.0)));
    if (i == 39) {
      EXPECT_EQ(tracksAt(scene, t).at(0).sources.size(), 4u);
    }
  }
  const auto tracks = tracksAt(scene, 119 * kStep);
  ASSERT_EQ(tracks.size(), 1u);
  EXPECT_EQ(tracks[0].sources, (std::vector<std::string>{"station_0/1", "station_1/1", "station_2/1"}));
  EXPECT_LT((tracks[0].position - along(119 * kStep)).norm(), 0.3);
}

TEST(PositionScene, TargetsThatNobodySeesCoastAndAreDeletedAndTheirIdsAreNotUsedAgain) {
  PositionScene scene{PositionSceneParams{}};
  Voice voice{scene};
  for (int i = 1; i < 60; ++i)
    for (int station = 0; station < 2; ++station) voice.say(station, i * kStep, along(i * kStep), kVelocity);
  ASSERT_EQ(tracksAt(scene, 3.0).size(), 1u);
  ASSERT_EQ(tracksAt(scene, 3.6).size(), 1u);
  EXPECT_EQ(tracksAt(scene, 3.6)[0].status, TrackStatus::coasting);
  for (int i = 160; i < 220; ++i)
    for (int station = 0; station < 2; ++station) voice.say(station, i * kStep, along(0), Vector::Zero(), 2);
  const auto tracks = tracksAt(scene, 219 * kStep);
  ASSERT_EQ(tracks.size(), 1u);
  EXPECT_EQ(tracks[0].id, 2u);
}

TEST(PositionScene, SaysWhyALocalTrackHasNoPosition) {
  PositionScene scene{PositionSceneParams{}};
  Voice voice{scene};
  for (int i = 1; i < 40; ++i) voice.say(0, i * kStep, along(i * kStep), kVelocity);
  const PositionReport report = scene.output(Time(durationOf(2.0))).report;
  ASSERT_EQ(report.unlocated.size(), 1u);
  EXPECT_EQ(report.unlocated[0].source, "station_0/1");
  EXPECT_EQ(report.unlocated[0].reason.kind, "one station only");
  ASSERT_EQ(report.stations.size(), 1u);
  EXPECT_EQ(report.stations[0].sensor, "camera of station_0");
}

TEST(PositionScene, ACopyIsASnapshot) {
  PositionScene scene{PositionSceneParams{}};
  Voice voice{scene};
  for (int i = 1; i < 40; ++i)
    for (int station = 0; station < 2; ++station) voice.say(station, i * kStep, along(i * kStep), kVelocity);
  const PositionScene copy = scene;
  const Vector before = tracksAt(copy, 2.0).at(0).position;
  for (int i = 40; i < 60; ++i)
    for (int station = 0; station < 2; ++station) voice.say(station, i * kStep, along(i * kStep), kVelocity);
  EXPECT_EQ(tracksAt(copy, 2.0).at(0).position, before);
}

TEST(PositionScene, LocalTracksAndTargetsAreBounded) {
  PositionSceneParams params;
  params.max_local_tracks = 1;
  PositionScene scene(params);
  Voice voice{scene};
  for (int i = 1; i < 40; ++i)
    for (int station = 0; station < 2; ++station) voice.say(station, i * kStep, along(i * kStep), kVelocity);
  EXPECT_TRUE(tracksAt(scene, 2.0).empty());
  params.max_local_tracks = 0;
  EXPECT_THROW(PositionScene{params}, std::invalid_argument);
}

}  // namespace
}  // namespace sightline::core
