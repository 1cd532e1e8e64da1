#include "sightline/ros/components/position_tracker_component.h"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <diagnostic_msgs/DiagnosticStatus.h>

#include "sightline/ros/components/position_tracker_health.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/messages/position_messages.h"

#include "support/diagnostics.h"
#include "support/scratch_folder.h"
#include "support/seen_stations.h"
#include "support/times.h"

namespace {

namespace core = sightline::core;
using sightline::test::at;
using sightline::test::SeenStation;
using sightline::test::targetAt;
using sightline::test::targetVelocityAt;
using sightline::test::valueOf;
using sightline_ros::ParamReader;
using sightline_ros::PositionResult;
using sightline_ros::PositionTrackerComponent;
using sightline_ros::PositionTrackerHealth;

constexpr double kStart = 100.0;  // [s]

/// A position tracker with stations round the target, whose frames stand and are turned.
class PositionTrackerComponentTest : public testing::Test {
 protected:
  void use(const std::string& yaml) {
    const ScratchFolder folder;
    const ParamReader reader = ParamReader::fromYaml(folder.write("params.yaml", yaml));
    component_ = std::make_unique<PositionTrackerComponent>(reader, "positions", *transforms_);
    reader.finish();
  }

  /// A position tracker that knows no place of a station.
  void useWithoutPlaces(const std::string& yaml = "{}") {
    component_.reset();
    transforms_ = std::make_unique<tf2::BufferCore>();
    use(yaml);
  }

  void SetUp() override {
    use("{}");
    for (const SeenStation& station : stations_)
      transforms_->setTransform(station.transform(ros::Time(kStart), "world"), "test", true);
  }

  /// What each station says of the target at a time, `shift` [s] later by its stamps.
  void see(double t, double shift = 0.0) {
    const ros::Time stamp(kStart + t + shift);
    for (SeenStation& station : stations_) {
      keep(component_->onTracklets(
          boost::make_shared<sightline::TrackletArray>(station.tracklets(stamp, targetAt(t))),
          "/" + station.name() + "/tracklets", {}));
      keep(component_->onTracks(
          boost::make_shared<sightline::TrackArray>(station.tracks(stamp, targetAt(t), targetVelocityAt(t))),
          "/" + station.name() + "/tracks", {}));
    }
  }

  void keep(std::vector<PositionResult> results) {
    for (PositionResult& result : results) {
      for (const core::Refusal& refusal : result.refusals) refusals_.push_back(refusal);
      if (!result.notice.empty()) notices_.push_back(result.notice);
      if (result.tracks) latest_ = std::move(result);
    }
  }

  std::string kindOfLast() const { return refusals_.empty() ? "" : refusals_.back().kind; }
  std::string detailOfLast() const { return refusals_.empty() ? "" : refusals_.back().detail; }

  void expectTarget(double t) const {
    ASSERT_TRUE(latest_.tracks);
    ASSERT_EQ(latest_.tracks->tracks.size(), 1u);
    const core::PositionTrack track = sightline_ros::toCore(latest_.tracks->tracks[0]);
    EXPECT_EQ(track.status, core::TrackStatus::confirmed);
    EXPECT_EQ(track.sources, (std::vector<std::string>{"east/5", "west/5"}));
    const Eigen::Vector3d error = track.position - targetAt(t);
    const double distance = error.dot(track.covariance.topLeftCorner<3, 3>().llt().solve(error));
    EXPECT_LT(std::sqrt(distance), 3.5) << error.transpose();  // of a chi distribution of 3
    EXPECT_LT(error.norm(), 0.5);
    EXPECT_LT((track.velocity - targetVelocityAt(t)).norm(), 1.5);
    EXPECT_GT(track.parallax, 0.3);
  }

  std::unique_ptr<tf2::BufferCore> transforms_ = std::make_unique<tf2::BufferCore>();
  std::vector<SeenStation> stations_{{"west", {0.0, 0.0, 2.0}, 0.4, 1}, {"east", {80.0, 0.0, 1.0}, 2.5, 2}};
  std::unique_ptr<PositionTrackerComponent> component_;
  PositionResult latest_;
  std::vector<core::Refusal> refusals_;
  std::vector<std::string> notices_;
};

TEST_F(PositionTrackerComponentTest, TwoTurnedStationsGiveTheTargetsPosition) {
  for (int i = 0; i <= 100; ++i) see(0.05 * i);
  expectTarget(5.0);
  EXPECT_TRUE(refusals_.empty()) << kindOfLast();
  EXPECT_EQ(latest_.tracks->header.frame_id, "world");
  EXPECT_EQ(latest_.tracks->header.stamp, ros::Time(kStart + 5.0));
  EXPECT_EQ(latest_.tracks->tracker, "positions");
  EXPECT_EQ(latest_.report->header, latest_.tracks->header);
  ASSERT_EQ(latest_.report->positions.size(), 1u);
  EXPECT_EQ(latest_.report->positions[0].id, latest_.tracks->tracks[0].id);
  EXPECT_EQ(latest_.report->positions[0].sources, latest_.tracks->tracks[0].sources);
  EXPECT_EQ(latest_.report->stations.size(), 2u);
  ASSERT_EQ(latest_.poses->poses.size(), 1u);
  EXPECT_EQ(latest_.poses->poses[0].position.x, latest_.tracks->tracks[0].position.x);
}

TEST_F(PositionTrackerComponentTest, OneStationAloneHasNoPositionAndTheReportSaysWhy) {
  stations_.pop_back();
  for (int i = 0; i <= 40; ++i) see(0.05 * i);
  ASSERT_TRUE(latest_.tracks);
  EXPECT_TRUE(latest_.tracks->tracks.empty());
  ASSERT_EQ(latest_.report->unlocated.size(), 1u);
  EXPECT_EQ(latest_.report->unlocated[0].source, "west/5");
  EXPECT_EQ(latest_.report->unlocated[0].kind, "one station only");
}

TEST_F(PositionTrackerComponentTest, MovingStationCountsFromWhereItIsAtTheStamp) {
  useWithoutPlaces();
  const auto shipAt = [](double t) { return Eigen::Vector3d(80.0 - 6.0 * t, -4.0, 1.0); };
  for (int i = -10; i <= 70; ++i) {
    const ros::Time stamp(kStart + 0.1 * i);
    stations_[1].moveTo(shipAt(0.1 * i));
    for (const SeenStation& station : stations_)
      transforms_->setTransform(station.transform(stamp, "world"), "test", false);
  }
  for (int i = 0; i <= 100; ++i) {
    stations_[1].moveTo(shipAt(0.05 * i));
    see(0.05 * i);
  }
  expectTarget(5.0);
  EXPECT_EQ(component_->stations().at("east").x(), latest_.tracks ? shipAt(5.0).x() : 0.0);
}

/// One more station sees nothing while the other two see the target.
TEST_F(PositionTrackerComponentTest, TargetOutsideTheFieldOfViewOfAStationIsNotMissedByIt) {
  const auto existenceWith = [this](const std::string& yaml) {
    SetUp();
    use(yaml);
    stations_ = {{"west", {0.0, 0.0, 2.0}, 0.4, 1}, {"east", {80.0, 0.0, 1.0}, 2.5, 2}};
    SeenStation north("north", {40.0, 90.0, 0.0}, 0.0, 3);
    transforms_->setTransform(north.transform(ros::Time(kStart), "world"), "test", true);
    // The eyes look south, to the target, and north.
    for (const bool is_south : {true, false}) {
      const SeenStation eye(is_south ? "south_eye" : "north_eye", {40.0, 90.0, 0.0},
                            is_south ? -core::kPi / 2.0 : core::kPi / 2.0, 4);
      transforms_->setTransform(eye.transform(ros::Time(kStart), "world"), "test", true);
    }
    for (int i = 0; i <= 40; ++i) {
      see(0.05 * i);
      auto nothing = north.tracks(ros::Time(kStart + 0.05 * i), targetAt(0.0), targetVelocityAt(0.0));
      nothing.tracks.clear();
      keep(component_->onTracks(boost::make_shared<sightline::TrackArray>(nothing), "/north/tracks", {}));
    }
    return latest_.tracks && latest_.tracks->tracks.size() == 1 ? latest_.tracks->tracks[0].existence : -1.0;
  };
  const auto viewOf = [](const std::string& frame) {
    return "fields_of_view: [{tracker: north, frame: " + frame +
           ", azimuth_half_width: 0.5, elevation_half_width: 0.5}]";
  };
  const double away = existenceWith(viewOf("north_eye")), there = existenceWith(viewOf("south_eye")),
               unknown = existenceWith("{}");
  EXPECT_GT(there, 0.0);
  EXPECT_LT(there, unknown);
  EXPECT_LT(unknown, away);
  EXPECT_TRUE(refusals_.empty()) << detailOfLast();

  const double without = existenceWith(viewOf("no_eye"));
  EXPECT_EQ(without, unknown);
  EXPECT_EQ(kindOfLast(), "no field of view");
  EXPECT_NE(detailOfLast().find("no_eye"), std::string::npos) << detailOfLast();
}

TEST_F(PositionTrackerComponentTest, FieldOfViewThatTurnsIsWaitedForAndGivenUpAfterTheWait) {
  use("{fields_of_view: [{tracker: west, frame: eye, azimuth_half_width: 0.5, elevation_half_width: 0.5}]}");
  const SeenStation eye("eye", {0.0, 0.0, 2.0}, 0.4, 1);
  transforms_->setTransform(eye.transform(ros::Time(kStart - 1.0), "world"), "test", false);
  const auto offer = [this](double stamp) {
    return component_->onTracks(boost::make_shared<sightline::TrackArray>(stations_[0].tracks(
                                    ros::Time(stamp), targetAt(0.0), targetVelocityAt(0.0))),
                                "/west/tracks", at(stamp));
  };
  EXPECT_TRUE(offer(kStart).empty());
  transforms_->setTransform(eye.transform(ros::Time(kStart + 0.1), "world"), "test", false);
  auto results = component_->onTransforms(at(kStart));
  ASSERT_EQ(results.size(), 1u);
  EXPECT_TRUE(results[0].refusals.empty());
  EXPECT_TRUE(offer(kStart + 1.0).empty());
  results = component_->onTransforms(at(kStart + 1.51));
  ASSERT_EQ(results.size(), 1u);
  EXPECT_EQ(results[0].used, 1u);
  ASSERT_EQ(results[0].refusals.size(), 1u);
  EXPECT_EQ(results[0].refusals[0].kind, "no field of view");
}

TEST_F(PositionTrackerComponentTest, MessagesWaitForTheirTransform) {
  useWithoutPlaces();
  const auto tracks = boost::make_shared<sightline::TrackArray>(
      stations_[0].tracks(ros::Time(kStart), targetAt(0.0), targetVelocityAt(0.0)));
  EXPECT_TRUE(component_->onTracks(tracks, "/west/tracks", at(kStart)).empty());
  EXPECT_EQ(component_->waiting(), 1u);
  EXPECT_TRUE(component_->onTransforms(at(kStart + 0.4)).empty());
  transforms_->setTransform(stations_[0].transform(ros::Time(kStart), "world"), "test", true);
  const auto results = component_->onTransforms(at(kStart + 0.45));
  ASSERT_EQ(results.size(), 1u);
  EXPECT_TRUE(results[0].tracks);
  EXPECT_TRUE(results[0].refusals.empty());
  EXPECT_EQ(results[0].used, 1u);
  EXPECT_EQ(component_->waiting(), 0u);
}

TEST_F(PositionTrackerComponentTest, MessageWithoutATransformIsRefusedAfterTheWait) {
  useWithoutPlaces();
  const auto tracks = boost::make_shared<sightline::TrackArray>(
      stations_[0].tracks(ros::Time(kStart), targetAt(0.0), targetVelocityAt(0.0)));
  component_->onTracks(tracks, "/west/tracks", at(kStart));
  keep(component_->onTransforms(at(kStart + 0.51)));
  EXPECT_EQ(kindOfLast(), "no transform");
  EXPECT_NE(detailOfLast().find("no transform from west to world came within 0.51 s"), std::string::npos)
      << detailOfLast();
  EXPECT_EQ(component_->waiting(), 0u);
}

TEST_F(PositionTrackerComponentTest, OldestOfTooManyWaitingMessagesIsRefused) {
  useWithoutPlaces("max_waiting: 2");
  for (int i = 0; i < 3; ++i) {
    const auto tracks = boost::make_shared<sightline::TrackArray>(
        stations_[0].tracks(ros::Time(kStart + i), targetAt(0.0), targetVelocityAt(0.0)));
    keep(component_->onTracks(tracks, "/west/tracks", at(kStart + 2.0)));
  }
  EXPECT_EQ(component_->waiting(), 2u);
  EXPECT_EQ(kindOfLast(), "too many waiting");
}

TEST_F(PositionTrackerComponentTest, WhatCannotBeUsedIsRefusedByItsKind) {
  use("max_trackers: 1");
  const auto offer = [this](const std::string& topic, double now, const auto& change) {
    auto tracks = boost::make_shared<sightline::TrackArray>(
        stations_[0].tracks(ros::Time(kStart + 1.0), targetAt(1.0), targetVelocityAt(1.0)));
    change(*tracks);
    refusals_.clear();
    keep(component_->onTracks(tracks, topic, now == 0.0 ? core::Time{} : at(now)));
    return kindOfLast();
  };
  EXPECT_EQ(offer("/a", 0.0, [](auto& tracks) { tracks.tracker.clear(); }), "invalid");
  EXPECT_EQ(offer("/a", 0.0, [](auto& tracks) { tracks.header.frame_id.clear(); }), "invalid");
  EXPECT_EQ(offer("/a", kStart, [](auto&) {}), "future");
  EXPECT_EQ(offer("/a", 0.0, [](auto&) {}), "");
  EXPECT_EQ(offer("/a", 0.0, [](auto&) {}), "duplicate");
  EXPECT_EQ(offer("/b", 0.0, [](auto&) {}), "name");
  EXPECT_EQ(offer("/b", 0.0, [](auto& tracks) { tracks.tracker = "other"; }), "limit");
  EXPECT_EQ(offer("/a", 0.0, [](auto& tracks) { tracks.header.stamp = ros::Time(kStart - 1.0); }), "late");
  EXPECT_EQ(offer("/a", 0.0,
                  [](auto& tracks) {
                    tracks.header.stamp = ros::Time(kStart + 1.1);
                    tracks.tracks[0].covariance[0] = std::numeric_limits<double>::quiet_NaN();
                  }),
            "invalid");
  EXPECT_NE(detailOfLast().find("track 5 of \"west\""), std::string::npos) << detailOfLast();
}

TEST_F(PositionTrackerComponentTest, TrackletsOfTooManySensorsAreRefused) {
  use("max_sensors: 1");
  for (int i = 0; i < 2; ++i) {
    auto tracklets = boost::make_shared<sightline::TrackletArray>(
        stations_[0].tracklets(ros::Time(kStart), targetAt(0.0)));
    tracklets->tracklets[0].sensor = "eye " + std::to_string(i);
    keep(component_->onTracklets(tracklets, "/west/tracklets", {}));
    EXPECT_EQ(kindOfLast(), i == 0 ? "" : "limit");
  }
}

TEST_F(PositionTrackerComponentTest, OrderOfMessagesWithinTheLagChangesNothing) {
  std::vector<std::vector<std::uint8_t>> bytes;
  for (const bool is_shuffled : {false, true}) {
    SetUp();
    stations_ = {{"west", {0.0, 0.0, 2.0}, 0.4, 1}, {"east", {80.0, 0.0, 1.0}, 2.5, 2}};
    struct Saying {
      double arrival;
      std::string topic;
      sightline::TrackArray::Ptr tracks;
      sightline::TrackletArray::Ptr tracklets;
    };
    std::vector<Saying> all;
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> delay(0.0, 0.4);
    for (int i = 0; i <= 60; ++i) {
      const double t = 0.05 * i;
      for (SeenStation& station : stations_) {
        const ros::Time stamp(kStart + t);
        const double late = i < 60 ? delay(random) : 0.5;  // the last is the last
        all.push_back({is_shuffled ? t + late : t, "/" + station.name(), nullptr,
                       boost::make_shared<sightline::TrackletArray>(station.tracklets(stamp, targetAt(t)))});
        all.push_back({is_shuffled ? t + late : t, "/" + station.name(),
                       boost::make_shared<sightline::TrackArray>(
                           station.tracks(stamp, targetAt(t), targetVelocityAt(t))),
                       nullptr});
      }
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const Saying& a, const Saying& b) { return a.arrival < b.arrival; });
    for (const Saying& saying : all) {
      keep(saying.tracks ? component_->onTracks(saying.tracks, saying.topic, {})
                         : component_->onTracklets(saying.tracklets, saying.topic, {}));
    }
    ASSERT_TRUE(refusals_.empty()) << kindOfLast();
    ASSERT_EQ(latest_.tracks->tracks.size(), 1u);
    std::vector<std::uint8_t> it(ros::serialization::serializationLength(*latest_.tracks));
    ros::serialization::OStream stream(it.data(), static_cast<std::uint32_t>(it.size()));
    ros::serialization::serialize(stream, *latest_.tracks);
    bytes.push_back(it);
  }
  EXPECT_EQ(bytes[0], bytes[1]);
}

TEST_F(PositionTrackerComponentTest, IdsAreNotUsedAgainAfterAReset) {
  for (int i = 0; i <= 40; ++i) see(0.05 * i);
  ASSERT_EQ(latest_.tracks->tracks.size(), 1u);
  const std::uint32_t first = latest_.tracks->tracks[0].id;
  component_->reset();
  latest_ = {};
  for (int i = 0; i <= 40; ++i) see(0.05 * i);
  ASSERT_EQ(latest_.tracks->tracks.size(), 1u);
  EXPECT_GT(latest_.tracks->tracks[0].id, first);
}

TEST_F(PositionTrackerComponentTest, SimulatedTimeThatGoesBackForgetsThePositions) {
  for (int i = 0; i <= 40; ++i) see(0.05 * i);
  EXPECT_FALSE(component_->onSimulatedTime(at(kStart + 2.0)));
  EXPECT_FALSE(component_->onSimulatedTime(at(kStart + 1.5)));
  const auto back = component_->onSimulatedTime(at(kStart));
  ASSERT_TRUE(back);
  EXPECT_NEAR(*back, 2.0, 1e-6);
  see(0.0);
  EXPECT_TRUE(refusals_.empty()) << kindOfLast();
  EXPECT_TRUE(latest_.tracks->tracks.empty());
}

TEST_F(PositionTrackerComponentTest, StampsOfAllStationsThatGoBackStartAnewWithANotice) {
  for (int i = 0; i <= 40; ++i) see(0.05 * i);
  for (int i = 0; i <= 65; ++i) see(0.05 * i, -50.0);
  ASSERT_EQ(notices_.size(), 1u);
  EXPECT_NE(notices_[0].find("50 messages in a row"), std::string::npos) << notices_[0];
  ASSERT_EQ(latest_.tracks->tracks.size(), 1u);
  EXPECT_EQ(latest_.tracks->header.stamp, ros::Time(kStart - 50.0 + 0.05 * 65));
}

TEST_F(PositionTrackerComponentTest, HealthTellsPositionsSourcesAndRefusals) {
  PositionTrackerHealth health({"/west/tracks", "/east/tracks"}, 2.0);
  diagnostic_updater::DiagnosticStatusWrapper before;
  health.diagnose(at(kStart), component_->stations(), 0, before);
  EXPECT_EQ(before.level, diagnostic_msgs::DiagnosticStatus::WARN);
  EXPECT_NE(before.message.find("nothing yet on /west/tracks"), std::string::npos) << before.message;

  for (int i = 0; i <= 40; ++i) {
    see(0.05 * i);
    latest_.topic = "/east/tracks";
    health.note(latest_, at(kStart + 0.05 * i));
  }
  PositionResult refused;
  refused.refusals = {{"no transform", "of the mast"}};
  EXPECT_EQ(health.note(refused, at(kStart + 2.0)).size(), 1u);
  EXPECT_TRUE(health.note(refused, at(kStart + 2.1)).empty()) << "a second warning within five seconds";
  diagnostic_updater::DiagnosticStatusWrapper status;
  health.diagnose(at(kStart + 2.0), component_->stations(), 3, status);
  EXPECT_EQ(valueOf(status, "positions confirmed"), "1");
  EXPECT_EQ(valueOf(status, "/east/tracks: tracks"), "1");
  EXPECT_EQ(valueOf(status, "/east/tracks: rate [Hz]"), "20.5");
  EXPECT_EQ(valueOf(status, "messages that wait for transforms"), "3");
  EXPECT_EQ(valueOf(status, "largest distance of stations [m]"), "80.0");
  EXPECT_NE(valueOf(status, "slow error of west/eye of west"), "(absent)");
  EXPECT_NE(status.message.find("no transform"), std::string::npos) << status.message;
  health.diagnose(at(kStart + 5.0), component_->stations(), 0, status);
  EXPECT_NE(status.message.find("no tracks on /east/tracks for 3 s"), std::string::npos) << status.message;
}

TEST_F(PositionTrackerComponentTest, HealthWarnsOfStationsInOnePlace) {
  PositionTrackerHealth health({}, 2.0);
  diagnostic_updater::DiagnosticStatusWrapper status;
  health.diagnose(at(kStart), {{"a", {1.0, 2.0, 3.0}}, {"b", {1.0, 2.0, 3.5}}}, 0, status);
  EXPECT_NE(status.message.find("all stations stand within a metre"), std::string::npos) << status.message;
}

}  // namespace
