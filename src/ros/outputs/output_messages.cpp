#include "sightline/ros/outputs/output_messages.h"

#include <algorithm>
#include <cmath>

#include <sensor_msgs/point_cloud2_iterator.h>

#include "sightline/ros/messages/transform_messages.h"

namespace sightline_ros {
namespace {

namespace core = sightline::core;

constexpr double kAnyAngle = core::kPi * core::kPi;  // variance of an angle that nobody knows [rad^2]
constexpr double kAnyRate = 1e6;                     // ... of an angular rate [rad^2/s^2]

using PoseCovariance = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

/// Of the small turn that errors of a velocity make of the attitude along it, about the axes of the frame of
/// the velocity [rad^2]: d theta = v x dv / |v|^2, and any roll.
Eigen::Matrix3d turnCovariance(const Eigen::Vector3d& velocity, const Eigen::Matrix3d& covariance) {
  const double speed = velocity.norm();
  if (!(speed > 0.0)) return kAnyAngle * Eigen::Matrix3d::Identity();
  const Eigen::Vector3d d = velocity / speed;
  Eigen::Matrix3d cross;
  cross << 0.0, -d.z(), d.y(), d.z(), 0.0, -d.x(), -d.y(), d.x(), 0.0;
  Eigen::Matrix3d turn = cross * covariance * cross.transpose() / (speed * speed);
  const double excess = turn.trace() / kAnyAngle;
  if (excess > 1.0) turn /= excess;  // a circle has no more
  return core::symmetric(turn) + kAnyAngle * d * d.transpose();
}

}  // namespace

std::string nameOf(const std::string& prefix, const OutputTrack& track) {
  return prefix + std::to_string(track.id);
}

geometry_msgs::Quaternion quaternionOf(const Eigen::Matrix3d& R) {
  return transformMessage({}, "", "", Eigen::Vector3d::Zero(), R).transform.rotation;
}

geometry_msgs::Pose poseOf(const OutputTrack& track, double distance) {
  geometry_msgs::Pose pose;
  const Eigen::Vector3d place = placeOf(track, distance);
  pose.position.x = place.x();
  pose.position.y = place.y();
  pose.position.z = place.z();
  pose.orientation = quaternionOf(attitudeOf(track));
  return pose;
}

tf2_msgs::TFMessage transformsOf(const OutputTracks& tracks, const std::string& prefix, double distance) {
  tf2_msgs::TFMessage message;
  for (const OutputTrack& track : tracks.tracks) {
    message.transforms.push_back(transformMessage(tracks.header.stamp, tracks.header.frame_id,
                                                  nameOf(prefix, track), placeOf(track, distance),
                                                  attitudeOf(track)));
  }
  return message;
}

geometry_msgs::PoseArray poseArrayOf(const OutputTracks& tracks) {
  geometry_msgs::PoseArray poses;
  poses.header = tracks.header;
  for (const OutputTrack& track : tracks.tracks) poses.poses.push_back(poseOf(track, 0.0));
  return poses;
}

sensor_msgs::PointCloud2 pointsOf(const OutputTracks& tracks, double distance) {
  using Field = sensor_msgs::PointField;
  sensor_msgs::PointCloud2 cloud;
  cloud.header = tracks.header;
  cloud.height = 1;
  cloud.is_dense = 1;
  sensor_msgs::PointCloud2Modifier modifier(cloud);
  modifier.setPointCloud2Fields(7, "x", 1, Field::FLOAT32, "y", 1, Field::FLOAT32, "z", 1, Field::FLOAT32,
                                "id", 1, Field::UINT32, "status", 1, Field::UINT8, "sigma", 1, Field::FLOAT32,
                                "existence", 1, Field::FLOAT32);
  modifier.resize(tracks.tracks.size());
  sensor_msgs::PointCloud2Iterator<float> x(cloud, "x"), y(cloud, "y"), z(cloud, "z"), sigma(cloud, "sigma"),
      existence(cloud, "existence");
  sensor_msgs::PointCloud2Iterator<std::uint32_t> id(cloud, "id");
  sensor_msgs::PointCloud2Iterator<std::uint8_t> status(cloud, "status");
  for (const OutputTrack& track : tracks.tracks) {
    const Eigen::Vector3f place = placeOf(track, distance).cast<float>();
    *x = place.x(), *y = place.y(), *z = place.z();
    *id = track.id, *status = track.status;
    *sigma = static_cast<float>(largestSigma(track));
    *existence = static_cast<float>(track.existence);
    ++x, ++y, ++z, ++id, ++status, ++sigma, ++existence;
  }
  return cloud;
}

geometry_msgs::Vector3Stamped directionMessage(const std_msgs::Header& header, const OutputTrack& track) {
  geometry_msgs::Vector3Stamped message;
  message.header = header;
  const Eigen::Vector3d direction = placeOf(track, 1.0);
  message.vector.x = direction.x();
  message.vector.y = direction.y();
  message.vector.z = direction.z();
  return message;
}

nav_msgs::Odometry odometryOf(const std_msgs::Header& header, const OutputTrack& track,
                              const std::string& prefix) {
  const auto& state = std::get<MetricState>(track.state);
  const Eigen::Matrix3d R = attitudeOf(track);  // R_frame_target
  nav_msgs::Odometry message;
  message.header = header;
  message.child_frame_id = nameOf(prefix, track);
  message.pose.pose = poseOf(track, 0.0);

  PoseCovariance pose = PoseCovariance::Zero();
  pose.topLeftCorner<3, 3>() = state.covariance.topLeftCorner<3, 3>();
  pose.bottomRightCorner<3, 3>() =
      turnCovariance(state.velocity(), state.covariance.bottomRightCorner<3, 3>());
  Eigen::Map<PoseCovariance>(message.pose.covariance.data()) = pose;

  const Eigen::Vector3d velocity = R.transpose() * state.velocity();
  message.twist.twist.linear.x = velocity.x();
  message.twist.twist.linear.y = velocity.y();
  message.twist.twist.linear.z = velocity.z();
  PoseCovariance twist = PoseCovariance::Zero();
  twist.topLeftCorner<3, 3>() =
      core::symmetric(R.transpose() * state.covariance.bottomRightCorner<3, 3>() * R);
  twist.bottomRightCorner<3, 3>() = kAnyRate * Eigen::Matrix3d::Identity();
  Eigen::Map<PoseCovariance>(message.twist.covariance.data()) = twist;
  return message;
}

}  // namespace sightline_ros
