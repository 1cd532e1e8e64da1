#pragma once

#include <vector>

#include <geometry_msgs/TransformStamped.h>
#include <ros/time.h>
#include <sightline/PositionTrackArray.h>
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

/// Topic of the true positions of a scenario that has stations.
inline constexpr const char* kPositionTruthTopic = "/truth/positions";

/// Where the targets given in metres truly are, in `world`, covariance zero.
sightline::PositionTrackArray positionTruthMessage(const sightline::core::Scenario& scenario, double time,
                                                   const ros::Time& stamp);

/// world -> the station's frame, and world -> <station>_enu, which has its place and the axes of the world.
std::vector<geometry_msgs::TransformStamped> stationTransforms(const sightline::core::Station& station,
                                                               double time, const ros::Time& stamp);

/// Those of the platform and of all stations that stand still, or of all that move.
std::vector<geometry_msgs::TransformStamped> fixedTransforms(const sightline::core::Scenario& scenario,
                                                             const ros::Time& stamp);
std::vector<geometry_msgs::TransformStamped> movingTransforms(const sightline::core::Scenario& scenario,
                                                              double time, const ros::Time& stamp);

/// platform, or the sensor's station -> the sensor's frame, which has its name.
geometry_msgs::TransformStamped mountTransform(const sightline::core::SimulatedSensor& sensor,
                                               const ros::Time& stamp);

bool isFixed(const sightline::core::PlatformMotion& platform);

}  // namespace sightline_ros
