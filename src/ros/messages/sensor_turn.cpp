#include "sightline/ros/messages/sensor_turn.h"

#include <Eigen/Geometry>

#include "sightline/ros/messages/transform_messages.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

constexpr double kRateStep = 0.01;  // over which the rate of turn is measured [s]

/// Angular velocity of the sensor in its own frame [rad/s]: from the transform a moment earlier or, where the
/// transforms begin, a moment later; zero where neither is known.
Eigen::Vector3d angularVelocityOf(const std_msgs::Header& header, const Eigen::Matrix3d& R_tracking_sensor,
                                  const FrameChangeParams& params, const tf2::BufferCore& transforms) {
  if (params.attitude.time_sigma == 0.0) return Eigen::Vector3d::Zero();
  for (const double step : {-kRateStep, kRateStep}) {
    const ros::Time other = header.stamp + ros::Duration(step);
    if (!transforms.canTransform(params.tracking_frame, header.frame_id, other)) continue;
    const Eigen::Matrix3d R_other =
        rotationOf(transforms.lookupTransform(params.tracking_frame, header.frame_id, other));
    return core::angularVelocity(R_tracking_sensor, R_other, step);
  }
  return Eigen::Vector3d::Zero();
}

}  // namespace

bool isTurnKnown(const std_msgs::Header& header, const FrameChangeParams& params,
                 const tf2::BufferCore& transforms) {
  return header.frame_id == params.tracking_frame ||
         transforms.canTransform(params.tracking_frame, header.frame_id, header.stamp);
}

std::optional<Turn> turnOf(const std_msgs::Header& header, const FrameChangeParams& params,
                           const tf2::BufferCore& transforms) {
  if (header.frame_id == params.tracking_frame) return std::nullopt;
  Turn turn{rotationOf(transforms.lookupTransform(params.tracking_frame, header.frame_id, header.stamp)), {}};
  if (!params.attitude.isExact()) {
    turn.attitude_covariance = core::attitudeCovariance(
        params.attitude, angularVelocityOf(header, turn.R_tracking_sensor, params, transforms));
  }
  return turn;
}

std::optional<core::FieldOfView> viewOf(const std::string& sensor, const FrameChangeParams& params,
                                        const std::optional<Turn>& turn) {
  const auto field = params.fields_of_view.find(sensor);
  if (field == params.fields_of_view.end()) return std::nullopt;
  core::FieldOfView view;
  if (turn) view.R_sensor_tracking = turn->R_tracking_sensor.transpose();
  view.half_widths = field->second;
  return view;
}

}  // namespace sightline_ros
