#pragma once

#include <nav_msgs/Odometry.h>
#include <string>

#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/Vector3Stamped.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_msgs/TFMessage.h>

#include "sightline/ros/outputs/output_tracks.h"

/// Tracks as standard messages, with the stamp and frame of the tracks. `distance`: how far along their line
/// of sight directions are put [m].
namespace sightline_ros {

/// A frame <prefix><id> for each track: where the target is, x along the line of sight or the velocity.
tf2_msgs::TFMessage transformsOf(const OutputTracks& tracks, const std::string& prefix, double distance);

/// Of positions: where they are, x along the velocity. Of directions: at the origin, x along the line of
/// sight. In ascending order of id.
geometry_msgs::PoseArray poseArrayOf(const OutputTracks& tracks);

/// Fields x, y, z [m], id (uint32), status (uint8, as in Track), sigma (largest standard deviation, [rad] of
/// a direction, [m] of a position) and existence; a point for each track, in ascending order of id.
sensor_msgs::PointCloud2 pointsOf(const OutputTracks& tracks, double distance);

/// The unit vector along the track's line of sight. Only of directions.
geometry_msgs::Vector3Stamped directionMessage(const std_msgs::Header& header, const OutputTrack& track);

/// Only of positions. child_frame_id is <prefix><id>, in which the twist is, after nav_msgs/Odometry; its x
/// axis is along the velocity. Covariances are the track's; that of the orientation follows from the
/// velocity's. What nobody knows has a large variance: roll pi^2 rad^2, angular rates 1e6 rad^2/s^2.
nav_msgs::Odometry odometryOf(const std_msgs::Header& header, const OutputTrack& track,
                              const std::string& prefix);

geometry_msgs::Pose poseOf(const OutputTrack& track, double distance);
geometry_msgs::Quaternion quaternionOf(const Eigen::Matrix3d& R);

/// <prefix><id>.
std::string nameOf(const std::string& prefix, const OutputTrack& track);

}  // namespace sightline_ros
