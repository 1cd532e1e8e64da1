#include "sightline/ros/messages/scenario_messages.h"

#include <variant>

#include "sightline/core/model/track.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/messages/transform_messages.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

core::Track truthTrack(const core::Target& target, const core::AngularState& state, core::Time time) {
  core::Track track;
  track.id = target.id;
  track.status = core::TrackStatus::confirmed;
  track.state = state;
  track.gate.centre = state.angles();
  track.gate.covariance.setZero();
  track.last_sighting = time;
  track.existence = 1.0;
  return track;
}

}  // namespace

sightline::TrackArray truthMessage(const core::Scenario& scenario, double time, const ros::Time& stamp) {
  sightline::TrackArray truth;
  truth.header.stamp = stamp;
  truth.header.frame_id = "platform_enu";
  truth.tracker = "truth";
  truth.estimator = "truth";
  for (const core::Target& target : scenario.targets) {
    if (const auto state = core::truthAt(scenario, target, time)) {
      truth.tracks.push_back(toMessage(truthTrack(target, *state, toCore(stamp))));
    }
  }
  return truth;
}

std::vector<geometry_msgs::TransformStamped> platformTransforms(const core::Scenario& scenario, double time,
                                                                const ros::Time& stamp) {
  const core::PlatformState platform = core::platformAt(scenario.platform, time);
  return {transformMessage(stamp, "world", "platform", platform.position, platform.R_world_platform),
          transformMessage(stamp, "world", "platform_enu", platform.position, Eigen::Matrix3d::Identity())};
}

geometry_msgs::TransformStamped mountTransform(const core::SimulatedSensor& sensor, const ros::Time& stamp) {
  return transformMessage(stamp, "platform", sensor.name, sensor.mount_position,
                          core::R_platform_sensor(sensor));
}

bool isFixed(const core::PlatformMotion& platform) {
  return std::holds_alternative<core::FixedPlatform>(platform);
}

}  // namespace sightline_ros
