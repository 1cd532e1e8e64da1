#include "sightline/ros/messages/scenario_messages.h"

#include <variant>

#include "sightline/core/model/track.h"
#include "sightline/core/positions/position_track.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/messages/position_messages.h"
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

/// Of the platform and the stations, those that stand still or those that move.
std::vector<geometry_msgs::TransformStamped> transformsOf(const core::Scenario& scenario, double time,
                                                          const ros::Time& stamp, bool of_fixed) {
  std::vector<geometry_msgs::TransformStamped> transforms;
  if (isFixed(scenario.platform) == of_fixed) transforms = platformTransforms(scenario, time, stamp);
  for (const core::Station& station : scenario.stations) {
    if (isFixed(station.motion) != of_fixed) continue;
    for (const auto& transform : stationTransforms(station, time, stamp)) transforms.push_back(transform);
  }
  return transforms;
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

sightline::PositionTrackArray positionTruthMessage(const core::Scenario& scenario, double time,
                                                   const ros::Time& stamp) {
  core::PositionTrackArray truth;
  truth.time = toCore(stamp);
  for (const core::Target& target : scenario.targets) {
    const auto motion = core::positionTruthAt(target, time);
    if (!motion) continue;
    core::PositionTrack track;
    track.id = target.id;
    track.status = core::TrackStatus::confirmed;
    track.position = motion->position;
    track.velocity = motion->velocity;
    track.covariance.setZero();
    track.existence = 1.0;
    track.last_sighting = truth.time;
    truth.tracks.push_back(track);
  }
  return toMessage(truth, "truth", "world");
}

std::vector<geometry_msgs::TransformStamped> stationTransforms(const core::Station& station, double time,
                                                               const ros::Time& stamp) {
  const core::PlatformState state = core::platformAt(station.motion, time);
  return {
      transformMessage(stamp, "world", station.name, state.position, state.R_world_platform),
      transformMessage(stamp, "world", station.name + "_enu", state.position, Eigen::Matrix3d::Identity())};
}

std::vector<geometry_msgs::TransformStamped> fixedTransforms(const core::Scenario& scenario,
                                                             const ros::Time& stamp) {
  return transformsOf(scenario, 0.0, stamp, true);
}

std::vector<geometry_msgs::TransformStamped> movingTransforms(const core::Scenario& scenario, double time,
                                                              const ros::Time& stamp) {
  return transformsOf(scenario, time, stamp, false);
}

geometry_msgs::TransformStamped mountTransform(const core::SimulatedSensor& sensor, const ros::Time& stamp) {
  return transformMessage(stamp, sensor.station.empty() ? "platform" : sensor.station, sensor.name,
                          sensor.mount_position, core::R_platform_sensor(sensor));
}

bool isFixed(const core::PlatformMotion& platform) {
  return std::holds_alternative<core::FixedPlatform>(platform);
}

}  // namespace sightline_ros
