// Each message is read by who usually reads it: tf2's buffer, the iterators of sensor_msgs, Eigen's maps of
// row-major covariances.
#include "sightline/ros/outputs/output_messages.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <sensor_msgs/point_cloud2_iterator.h>
#include <tf2/buffer_core.h>
#include <tf2/exceptions.h>

#include "sightline/ros/messages/transform_messages.h"

#include "support/output_tracks.h"

namespace {

namespace core = sightline::core;
using sightline::PositionTrackArray;
using sightline::TrackArray;
using sightline::test::directionTrack;
using sightline::test::positionTrack;
using sightline::test::stamped;
using Covariance = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

template <typename Message>
sightline_ros::OutputTracks outputsOf(const Message& message) {
  std::vector<core::Refusal> refusals;
  auto tracks = sightline_ros::outputTracksOf(message, {}, refusals);
  EXPECT_TRUE(refusals.empty());
  return tracks;
}

TrackArray twoDirections(const ros::Time& stamp, double azimuth) {
  auto message = stamped<TrackArray>(stamp, "platform_enu");
  message.tracks = {directionTrack(3, azimuth, 0.4), directionTrack(8, -2.0, -0.1, 5e-3)};
  return message;
}

PositionTrackArray onePosition(const ros::Time& stamp) {
  auto message = stamped<PositionTrackArray>(stamp, "world");
  message.tracks = {positionTrack(5, {10.0, -20.0, 7.0}, {3.0, 4.0, 0.0}, 0.2)};
  message.tracks[0].covariance[7] = 0.09;                                       // y
  message.tracks[0].covariance[1] = message.tracks[0].covariance[6] = 0.02;     // x, y
  message.tracks[0].covariance[21] = 0.25;                                      // vx
  message.tracks[0].covariance[22] = message.tracks[0].covariance[27] = 0.015;  // vx, vy
  return message;
}

Eigen::Vector3d along(const geometry_msgs::Quaternion& q) {
  return Eigen::Quaterniond(q.w, q.x, q.y, q.z) * Eigen::Vector3d::UnitX();
}

TEST(OutputMessages, Tf2FindsTheLineOfSightAlsoBetweenTwoMessages) {
  tf2::BufferCore buffer;
  for (const double t : {0.0, 0.1}) {
    const auto transforms =
        transformsOf(outputsOf(twoDirections(ros::Time(100.0 + t), 0.5 + t)), "track_", 10.0);
    for (const auto& transform : transforms.transforms) ASSERT_TRUE(buffer.setTransform(transform, "test"));
  }
  const auto track = buffer.lookupTransform("platform_enu", "track_3", ros::Time(100.05));
  const auto& place = track.transform.translation;
  const Eigen::Vector3d expected = core::directionOf({0.55, 0.4});
  EXPECT_LT(core::angleBetween({place.x, place.y, place.z}, expected), 1e-3);
  EXPECT_NEAR(Eigen::Vector3d(place.x, place.y, place.z).norm(), 10.0, 0.02);
  EXPECT_LT(core::angleBetween(along(track.transform.rotation), expected), 1e-3);
  EXPECT_THROW(buffer.lookupTransform("platform_enu", "track_8", ros::Time(100.2)), tf2::TransformException);
}

TEST(OutputMessages, PosesOfDirectionsPointFromTheOrigin) {
  const auto poses = poseArrayOf(outputsOf(twoDirections(ros::Time(100.0), 0.5)));
  EXPECT_EQ(poses.header.frame_id, "platform_enu");
  EXPECT_EQ(poses.header.stamp, ros::Time(100.0));
  ASSERT_EQ(poses.poses.size(), 2u);
  EXPECT_EQ(poses.poses[0].position.x, 0.0);
  EXPECT_LT((along(poses.poses[0].orientation) - core::directionOf({0.5, 0.4})).norm(), 1e-12);
}

TEST(OutputMessages, VectorIsTheUnitVectorOfTheDirection) {
  const auto tracks = outputsOf(twoDirections(ros::Time(100.0), 0.5));
  const auto message = directionMessage(tracks.header, tracks.tracks[1]);
  const Eigen::Vector3d vector(message.vector.x, message.vector.y, message.vector.z);
  EXPECT_LT((vector - core::directionOf({-2.0, -0.1})).norm(), 1e-12);
  EXPECT_EQ(message.header.stamp, ros::Time(100.0));
}

TEST(OutputMessages, CloudIsReadByTheIteratorsOfSensorMsgs) {
  auto message = twoDirections(ros::Time(100.0), 0.5);
  message.tracks[1].existence = std::nan("");
  const auto cloud = pointsOf(outputsOf(message), 10.0);
  EXPECT_EQ(cloud.width * cloud.height, 2u);
  EXPECT_EQ(cloud.data.size(), cloud.row_step * cloud.height);
  sensor_msgs::PointCloud2ConstIterator<float> x(cloud, "x"), sigma(cloud, "sigma"),
      existence(cloud, "existence");
  sensor_msgs::PointCloud2ConstIterator<std::uint32_t> id(cloud, "id");
  sensor_msgs::PointCloud2ConstIterator<std::uint8_t> status(cloud, "status");
  EXPECT_EQ(*id, 3u);
  EXPECT_EQ(*status, sightline::Track::CONFIRMED);
  const Eigen::Vector3d point(x[0], x[1], x[2]);
  EXPECT_LT((point - 10.0 * core::directionOf({0.5, 0.4})).norm(), 1e-5);
  EXPECT_NEAR(*existence, 0.99, 1e-6);
  ++x, ++id, ++sigma, ++existence;
  EXPECT_EQ(*id, 8u);
  EXPECT_NEAR(*sigma, 5e-3, 1e-8);
  EXPECT_TRUE(std::isnan(*existence));
}

TEST(OutputMessages, WithoutTracksTheCloudAndThePosesAreEmpty) {
  const auto tracks = outputsOf(stamped<TrackArray>(ros::Time(100.0), "platform_enu"));
  EXPECT_EQ(pointsOf(tracks, 10.0).width, 0u);
  EXPECT_TRUE(poseArrayOf(tracks).poses.empty());
  EXPECT_TRUE(transformsOf(tracks, "track_", 10.0).transforms.empty());
}

TEST(OutputMessages, OdometryHasItsTwistInTheFrameOfTheTarget) {
  const auto tracks = outputsOf(onePosition(ros::Time(100.0)));
  const auto message = odometryOf(tracks.header, tracks.tracks[0], "track_");
  EXPECT_EQ(message.header.frame_id, "world");
  EXPECT_EQ(message.child_frame_id, "track_5");
  EXPECT_EQ(message.pose.pose.position.y, -20.0);
  EXPECT_LT((along(message.pose.pose.orientation) - Eigen::Vector3d(0.6, 0.8, 0.0)).norm(), 1e-12);
  EXPECT_NEAR(message.twist.twist.linear.x, 5.0, 1e-12);
  EXPECT_NEAR(message.twist.twist.linear.y, 0.0, 1e-12);
  // As a reader has it in the world: the twist's covariance turned by the pose is the velocity's.
  const auto& q = message.pose.pose.orientation;
  const Eigen::Matrix3d R = Eigen::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix();
  const Eigen::Map<const Covariance> twist(message.twist.covariance.data());
  const Eigen::Matrix3d in_world = R * twist.topLeftCorner<3, 3>() * R.transpose();
  EXPECT_NEAR(in_world(0, 0), 0.25, 1e-12);
  EXPECT_NEAR(in_world(0, 1), 0.015, 1e-12);
  const Eigen::Map<const Covariance> pose(message.pose.covariance.data());
  EXPECT_NEAR(pose(1, 1), 0.09, 1e-12);
  EXPECT_NEAR(pose(0, 1), 0.02, 1e-12);
  for (const auto& covariance : {pose, twist}) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(Eigen::MatrixXd{covariance});
    EXPECT_GT(solver.eigenvalues().minCoeff(), -1e-12);
  }
}

/// The yaw of a target whose velocity is in the plane is as uncertain as the velocity across it.
TEST(OutputMessages, OdometryOrientationIsAsSureAsTheVelocity) {
  const auto tracks = outputsOf(onePosition(ros::Time(100.0)));
  const auto message = odometryOf(tracks.header, tracks.tracks[0], "track_");
  const Eigen::Map<const Covariance> pose(message.pose.covariance.data());
  Eigen::Matrix2d velocity;
  velocity << 0.25, 0.015, 0.015, 0.04;
  const Eigen::LLT<Eigen::Matrix2d> factor(velocity);
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  double sum = 0.0;
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    const double a = normal(random), b = normal(random);
    const Eigen::Vector2d v = Eigen::Vector2d(3.0, 4.0) + factor.matrixL() * Eigen::Vector2d(a, b);
    const double yaw = core::wrapAngle(std::atan2(v.y(), v.x()) - std::atan2(4.0, 3.0));
    sum += yaw * yaw / kDraws;
  }
  EXPECT_NEAR(pose(5, 5), sum, 0.05 * sum);
}

TEST(OutputMessages, OfATargetAtRestNoOrientationIsKnown) {
  auto message = stamped<PositionTrackArray>(ros::Time(100.0), "world");
  message.tracks = {positionTrack(5, {1.0, 2.0, 3.0}, {0.0, 0.0, 0.0})};
  const auto tracks = outputsOf(message);
  const auto odometry = odometryOf(tracks.header, tracks.tracks[0], "track_");
  EXPECT_EQ(odometry.pose.pose.orientation.w, 1.0);
  EXPECT_GT(odometry.pose.covariance[35], 9.0);
}

}  // namespace
