#pragma once

#include <memory>
#include <nav_msgs/Odometry.h>

#include <geometry_msgs/PointStamped.h>
#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <geometry_msgs/Vector3Stamped.h>
#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/PointCloud2.h>
#include <sensor_msgs/RegionOfInterest.h>

#include "sightline/ros/adapters/adapter_params.h"
#include "sightline/ros/adapters/adapter_reading.h"
#include "sightline/ros/adapters/message_layout.h"
#include "sightline/ros/adapters/pixel_rays.h"

/// What each kind of message means as sightings. `rays`: of the topic's camera, null when it has none or its
/// CameraInfo has not come yet. The topic must outlive the reading.
namespace sightline_ros {

/// A direction of any length.
Reading read(const geometry_msgs::Vector3Stamped& message, const AdapterTopic& topic, const PixelRays* rays);

/// The direction of a point; with a camera its x and y are pixel coordinates, z counts for nothing.
Reading read(const geometry_msgs::PointStamped& message, const AdapterTopic& topic, const PixelRays* rays);

/// The direction of the position, seen from the origin of the header's frame; the orientation counts for
/// nothing.
Reading read(const geometry_msgs::PoseStamped& message, const AdapterTopic& topic, const PixelRays* rays);
Reading read(const geometry_msgs::PoseArray& message, const AdapterTopic& topic, const PixelRays* rays);
Reading read(const geometry_msgs::PoseWithCovarianceStamped& message, const AdapterTopic& topic,
             const PixelRays* rays);
Reading read(const nav_msgs::Odometry& message, const AdapterTopic& topic, const PixelRays* rays);

/// The middle of the box, at the stamp of the newest CameraInfo: the message has none. A box without area
/// means "looked, and saw nothing".
Reading read(const sensor_msgs::RegionOfInterest& message, const AdapterTopic& topic, const PixelRays* rays);

/// One sighting for each point; in a cloud that is not dense, points that are NaN are returns that did not
/// come.
Reading read(const sensor_msgs::PointCloud2& message, const AdapterTopic& topic, const PixelRays* rays);

/// One sighting for each group of neighbouring beams on a small thing: its middle in the scanner's plane. Its
/// variance along the plane is the configured one plus width^2 / 12; the elevation is 0 with the configured
/// sigma, for a scanner does not know it. The stamp is the middle of the sweep.
Reading read(const sensor_msgs::LaserScan& message, const AdapterTopic& topic, const PixelRays* rays);

/// Any message, by field paths. Throws FieldError when the message is not as its definition says, or when a
/// path does not exist.
Reading read(const Bytes& message, const MessageLayout& layout, const AdapterTopic& topic,
             const PixelRays* rays);

}  // namespace sightline_ros
