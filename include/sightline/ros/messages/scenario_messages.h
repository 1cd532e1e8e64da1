#pragma once

#include <vector>

#include <geometry_msgs/TransformStamped.h>
#include <ros/time.h>
#include <sightline/TrackArray.h>

#include "sightline/core/simulation/scenario.h"

/// What a scenario publishes beside its sightings. `time` is of the scenario [s].
namespace sightline_ros {

/// Where the targets truly are, in platform_enu, covariance zero.
sightline::TrackArray truthMessage(const sightline::core::Scenario& scenario, double time,
                                   const ros::Time& stamp);

/// world -> platform and world -> platform_enu.
std::vector<geometry_msgs::TransformStamped> platformTransforms(const sightline::core::Scenario& scenario,
                                                                double time, const ros::Time& stamp);

/// platform -> the sensor's frame, which has its name.
geometry_msgs::TransformStamped mountTransform(const sightline::core::SimulatedSensor& sensor,
                                               const ros::Time& stamp);

bool isFixed(const sightline::core::PlatformMotion& platform);

}  // namespace sightline_ros
