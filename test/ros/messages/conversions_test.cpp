#include "sightline/ros/messages/conversions.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace {

namespace core = sightline::core;
using sightline_ros::toCore;
using sightline_ros::toMessage;
using sightline_ros::toRos;

core::Track exampleTrack() {
  core::Track track;
  track.id = 7;
  track.status = core::TrackStatus::coasting;
  track.state.mean << 0.1, -0.2, 0.3, -0.4;
  for (int i = 0; i < 16; ++i) track.state.covariance(i / 4, i % 4) = i + 1;
  track.gate.centre = {0.5, 0.6};
  track.gate.half_width = {0.01, 0.02};
  track.gate.covariance << 1.0, 2.0, 3.0, 4.0;
  track.last_sighting = core::timeOf(1234567890123456789);
  track.hits = 5;
  track.misses = 2;
  track.existence = 0.75;
  track.sources = {"acquisition_1", "tracking_2"};
  return track;
}

TEST(Conversions, StampsKeepEveryNanosecond) {
  const ros::Time stamp(1700000000, 123456789);
  EXPECT_EQ(toRos(toCore(stamp)), stamp);
  EXPECT_EQ(toCore(stamp).time_since_epoch().count(), 1700000000123456789);
}

TEST(Conversions, LastStampOfRosIsKept) {
  const ros::Time stamp(std::numeric_limits<std::uint32_t>::max(), 999999999);
  EXPECT_EQ(toRos(toCore(stamp)), stamp);
}

TEST(Conversions, TimesThatRosCannotHoldAreRefused) {
  EXPECT_THROW(toRos(core::timeOf(-1)), std::range_error);
  EXPECT_THROW(toRos(core::timeOf(std::numeric_limits<std::int64_t>::max())), std::range_error);
}

TEST(Conversions, MatricesAreRowMajor) {
  const sightline::Track message = toMessage(exampleTrack());
  for (int i = 0; i < 16; ++i) EXPECT_EQ(message.covariance[i], i + 1);
  EXPECT_EQ(message.gate.covariance[1], 2.0);
  EXPECT_EQ(message.gate.covariance[2], 3.0);
}

TEST(Conversions, TrackSurvivesTheWayThereAndBack) {
  const core::Track track = exampleTrack();
  const core::Track back = toCore(toMessage(track));
  EXPECT_EQ(back.id, track.id);
  EXPECT_EQ(back.status, track.status);
  EXPECT_EQ(back.state.mean, track.state.mean);
  EXPECT_EQ(back.state.covariance, track.state.covariance);
  EXPECT_EQ(back.gate.centre, track.gate.centre);
  EXPECT_EQ(back.gate.half_width, track.gate.half_width);
  EXPECT_EQ(back.gate.covariance, track.gate.covariance);
  EXPECT_EQ(back.last_sighting, track.last_sighting);
  EXPECT_EQ(back.hits, track.hits);
  EXPECT_EQ(back.misses, track.misses);
  EXPECT_EQ(back.existence, track.existence);
  EXPECT_EQ(back.sources, track.sources);
}

TEST(Conversions, AssociationSurvivesTheWayThereAndBack) {
  core::Association association;
  association.sighting = 3;
  association.track = 9;
  association.innovation = {0.01, -0.02};
  association.covariance << 1.0, 0.1, 0.2, 2.0;
  association.distance_squared = 1.5;
  association.threshold = 9.21;
  association.decision = core::Decision::claimed_by_other;
  association.reason = "why";
  const core::Association back = toCore(toMessage(association));
  EXPECT_EQ(back.sighting, association.sighting);
  EXPECT_EQ(back.track, association.track);
  EXPECT_EQ(back.innovation, association.innovation);
  EXPECT_EQ(back.covariance, association.covariance);
  EXPECT_EQ(back.distance_squared, association.distance_squared);
  EXPECT_EQ(back.threshold, association.threshold);
  EXPECT_EQ(back.decision, association.decision);
  EXPECT_EQ(back.reason, association.reason);
}

TEST(Conversions, UnknownStaysUnknown) {
  EXPECT_TRUE(std::isnan(toMessage(core::Track{}).existence));
  EXPECT_TRUE(std::isnan(toMessage(core::Association{}).distance_squared));
  EXPECT_TRUE(std::isnan(toMessage(core::Association{}).covariance[3]));
}

TEST(Conversions, ConstantsOfMessagesAndCoreAgree) {
  EXPECT_EQ(static_cast<int>(core::TrackStatus::tentative), int{sightline::Track::TENTATIVE});
  EXPECT_EQ(static_cast<int>(core::TrackStatus::confirmed), int{sightline::Track::CONFIRMED});
  EXPECT_EQ(static_cast<int>(core::TrackStatus::coasting), int{sightline::Track::COASTING});
  EXPECT_EQ(static_cast<int>(core::Decision::accepted), int{sightline::Association::ACCEPTED});
  EXPECT_EQ(static_cast<int>(core::Decision::outside_gate), int{sightline::Association::OUTSIDE_GATE});
  EXPECT_EQ(static_cast<int>(core::Decision::claimed_by_other),
            int{sightline::Association::CLAIMED_BY_OTHER});
  EXPECT_EQ(static_cast<int>(core::Decision::started_track), int{sightline::Association::STARTED_TRACK});
  EXPECT_EQ(static_cast<int>(core::Decision::rejected_input), int{sightline::Association::REJECTED_INPUT});
}

}  // namespace
