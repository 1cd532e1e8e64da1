#include "sightline/ros/outputs/output_tracks.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "support/output_tracks.h"

namespace {

namespace core = sightline::core;
using sightline::PositionTrackArray;
using sightline::TrackArray;
using sightline::test::directionTrack;
using sightline::test::positionTrack;
using sightline_ros::MetricState;
using sightline_ros::OutputChoice;
using sightline_ros::OutputTrack;
using sightline_ros::outputTracksOf;

const double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<std::uint32_t> idsOf(const sightline_ros::OutputTracks& tracks) {
  std::vector<std::uint32_t> ids;
  for (const OutputTrack& track : tracks.tracks) ids.push_back(track.id);
  return ids;
}

OutputTrack onlyOne(const sightline::Track& track) {
  TrackArray message;
  message.tracks = {track};
  std::vector<core::Refusal> refusals;
  return outputTracksOf(message, {}, refusals).tracks.at(0);
}

OutputTrack onlyOne(const sightline::PositionTrack& track) {
  PositionTrackArray message;
  message.tracks = {track};
  std::vector<core::Refusal> refusals;
  return outputTracksOf(message, {}, refusals).tracks.at(0);
}

TEST(OutputTracks, EstablishedTracksAreChosenByDefaultOthersWhenAskedFor) {
  TrackArray message;
  for (std::uint32_t id = 1; id <= 4; ++id) {
    message.tracks.push_back(directionTrack(id, 0.1, 0.2));
    message.tracks.back().status = static_cast<std::uint8_t>(id - 1);  // 3 is no status
  }
  std::vector<core::Refusal> refusals;
  EXPECT_EQ(idsOf(outputTracksOf(message, {}, refusals)), (std::vector<std::uint32_t>{2, 3}));
  OutputChoice choice;
  choice.coasting = false;
  EXPECT_EQ(idsOf(outputTracksOf(message, choice, refusals)), (std::vector<std::uint32_t>{2}));
  choice.coasting = choice.tentative = true;
  EXPECT_EQ(idsOf(outputTracksOf(message, choice, refusals)), (std::vector<std::uint32_t>{1, 2, 3}));
  EXPECT_TRUE(refusals.empty());
}

TEST(OutputTracks, AbsurdDirectionsAreLeftOutAndRefused) {
  TrackArray message;
  for (std::uint32_t id = 1; id <= 6; ++id) message.tracks.push_back(directionTrack(id, 0.1, 0.2));
  message.tracks[0].azimuth = kNan;
  message.tracks[1].elevation = 20.0;
  message.tracks[2].covariance[0] = -1.0;
  message.tracks[3].azimuth_rate = std::numeric_limits<double>::infinity();
  message.tracks[5].id = 5;
  std::vector<core::Refusal> refusals;
  EXPECT_EQ(idsOf(outputTracksOf(message, {}, refusals)), (std::vector<std::uint32_t>{5}));
  ASSERT_EQ(refusals.size(), 5u);
  for (const core::Refusal& refusal : refusals) EXPECT_EQ(refusal.kind, "invalid");
  EXPECT_NE(refusals[0].detail.find("track 1: "), std::string::npos) << refusals[0].detail;
}

TEST(OutputTracks, AbsurdPositionsAreLeftOutAndRefused) {
  PositionTrackArray message;
  for (std::uint32_t id = 1; id <= 6; ++id)
    message.tracks.push_back(positionTrack(id, {1.0, 2.0, 3.0}, {1.0, 0.0, 0.0}));
  message.tracks[0].position.x = kNan;
  message.tracks[1].velocity.y = 1e9;
  message.tracks[2].covariance[0] = 0.0;
  message.tracks[3].covariance[1] = 1.0;                                    // not symmetric
  message.tracks[4].covariance[1] = message.tracks[4].covariance[6] = 0.5;  // correlation 50
  std::vector<core::Refusal> refusals;
  EXPECT_EQ(idsOf(outputTracksOf(message, {}, refusals)), (std::vector<std::uint32_t>{6}));
  EXPECT_EQ(refusals.size(), 5u);
}

TEST(OutputTracks, BeyondTheLimitTheOldestStay) {
  TrackArray message;
  for (const std::uint32_t id : {9u, 3u, 7u}) message.tracks.push_back(directionTrack(id, 0.1, 0.2));
  OutputChoice choice;
  choice.max_tracks = 2;
  std::vector<core::Refusal> refusals;
  EXPECT_EQ(idsOf(outputTracksOf(message, choice, refusals)), (std::vector<std::uint32_t>{3, 7}));
  ASSERT_EQ(refusals.size(), 1u);
  EXPECT_EQ(refusals[0].kind, "limit");
}

TEST(OutputTracks, APositionIsPredictedAlongItsVelocityAndBecomesLessSure) {
  const OutputTrack track = onlyOne(positionTrack(1, {10.0, 20.0, 5.0}, {3.0, -4.0, 1.0}));
  const auto& now = std::get<MetricState>(track.state);
  const OutputTrack predicted = sightline_ros::predicted(track, 2.0);
  const auto& later = std::get<MetricState>(predicted.state);
  EXPECT_LT((later.position() - Eigen::Vector3d(16.0, 12.0, 7.0)).norm(), 1e-12);
  EXPECT_EQ(later.velocity(), now.velocity());
  // More than a straight line would: the target may manoeuvre.
  EXPECT_GT(later.covariance(0, 0), now.covariance(0, 0) + 4.0 * now.covariance(3, 3));
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(later.covariance);
  EXPECT_GT(solver.eigenvalues().minCoeff(), 0.0);
}

TEST(OutputTracks, ADirectionIsPredictedAcrossTheZenithOnTheGreatCircle) {
  sightline::Track message = directionTrack(1, 0.5, core::kPi / 2.0 - 0.01);
  message.elevation_rate = 0.02;
  const OutputTrack track = onlyOne(message);
  const OutputTrack later = sightline_ros::predicted(track, 1.0);  // 0.01 rad beyond the zenith
  const Eigen::Vector3d expected = core::directionOf({0.5 - core::kPi, core::kPi / 2.0 - 0.01});
  EXPECT_LT(core::angleBetween(sightline_ros::placeOf(later, 1.0), expected), 1e-5);
  EXPECT_GT(sightline_ros::largestSigma(later), sightline_ros::largestSigma(track));
}

TEST(OutputTracks, AttitudeHasXAlongAndYLevel) {
  const Eigen::Vector3d forward(-2.0, 3.0, 5.0);
  const Eigen::Matrix3d R = sightline_ros::attitudeAlong(forward);
  EXPECT_LT((R.col(0) - forward.normalized()).norm(), 1e-12);
  EXPECT_NEAR(R(2, 1), 0.0, 1e-12);
  EXPECT_GT(R(2, 2), 0.0) << "z up";
  EXPECT_NEAR(R.determinant(), 1.0, 1e-12);
  EXPECT_EQ(sightline_ros::attitudeAlong(Eigen::Vector3d::Zero()), Eigen::Matrix3d::Identity());
}

TEST(OutputTracks, APositionIsSeenFromWhereTheHeadStands) {
  const OutputTrack track = onlyOne(positionTrack(1, {10.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, 0.1));
  Eigen::Isometry3d head_tracks =
      Eigen::Isometry3d::Identity();  // 10 m below the target, turned by 90 degrees
  head_tracks.linear() = Eigen::AngleAxisd(core::kPi / 2.0, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  head_tracks.translation() = Eigen::Vector3d(0.0, -10.0, 10.0);
  const auto seen = sightline_ros::seenFrom(head_tracks, track);
  EXPECT_LT((seen.direction - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_NEAR(seen.sigma, 0.01, 1e-12);
  head_tracks = Eigen::Isometry3d::Identity();
  head_tracks.translation() = Eigen::Vector3d(-10.0, 0.0, 0.0);
  EXPECT_TRUE(std::isinf(sightline_ros::seenFrom(head_tracks, track).sigma));
}

TEST(OutputTracks, ADirectionTurnsWithTheHeadAndKnowsNoPlace) {
  const OutputTrack track = onlyOne(directionTrack(1, 0.3, 0.0, 2e-3));
  Eigen::Isometry3d head_tracks = Eigen::Isometry3d::Identity();
  head_tracks.linear() = Eigen::AngleAxisd(-0.3, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  head_tracks.translation() = Eigen::Vector3d(0.0, 100.0, 0.0);
  const auto seen = sightline_ros::seenFrom(head_tracks, track);
  EXPECT_LT((seen.direction - Eigen::Vector3d::UnitX()).norm(), 1e-12);
  EXPECT_NEAR(seen.sigma, 2e-3, 1e-12);
}

}  // namespace
