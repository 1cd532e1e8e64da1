#pragma once

#include <string>

#include <ros/time.h>
#include <tf2/buffer_core.h>

#include "sightline/core/positions/position_scene.h"

/// Where a station is, and how it is turned, in a metric frame at a time.
namespace sightline_ros {

/// Whether the pose is known: interpolated between two transforms that are published, never extrapolated.
bool isPoseKnown(const std::string& frame, const ros::Time& stamp, const std::string& metric_frame,
                 const tf2::BufferCore& transforms);

/// The pose of the station's frame in the metric one. The velocity of its origin is that since the transform
/// a moment earlier or, where the transforms begin, until a moment later; zero where neither is known. Throws
/// tf2::TransformException when the pose is not known.
sightline::core::StationPose poseOf(const std::string& frame, const ros::Time& stamp,
                                    const std::string& metric_frame, const tf2::BufferCore& transforms);

}  // namespace sightline_ros
