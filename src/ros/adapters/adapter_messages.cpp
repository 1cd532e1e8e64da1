#include "sightline/ros/adapters/adapter_messages.h"

#include <cmath>

#include "sightline/core/imaging/laser_spots.h"
#include "sightline/core/model/sphere.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

template <typename Point>
Eigen::Vector3d vectorOf(const Point& point) {
  return {point.x, point.y, point.z};
}

/// Of the position, out of the row-major 6x6 over position and rotation.
Eigen::Matrix3d positionCovariance(const geometry_msgs::PoseWithCovariance& pose) {
  return Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(pose.covariance.data())
      .topLeftCorner<3, 3>();
}

/// A camera's message without a frame means the camera's.
std_msgs::Header framed(std_msgs::Header header, const PixelRays* rays) {
  if (header.frame_id.empty() && rays != nullptr) header.frame_id = rays->frame();
  return header;
}

constexpr double kLongestSweep = 3600.0;  // [s]

core::LaserSweep sweepOf(const sensor_msgs::LaserScan& scan) {
  core::LaserSweep sweep;
  sweep.first_angle = scan.angle_min;
  sweep.step = scan.angle_increment;
  sweep.min_range = scan.range_min;
  sweep.max_range = scan.range_max;
  const double span = std::abs(sweep.step) * static_cast<double>(scan.ranges.size());
  sweep.is_closed = span > 2.0 * core::kPi - 0.5 * std::abs(sweep.step);
  return sweep;
}

}  // namespace

Reading read(const geometry_msgs::Vector3Stamped& message, const AdapterTopic& topic, const PixelRays*) {
  Reading reading(topic, message.header);
  reading.addDirection(vectorOf(message.vector));
  return reading;
}

Reading read(const geometry_msgs::PointStamped& message, const AdapterTopic& topic, const PixelRays* rays) {
  Reading reading(topic, message.header);
  if (topic.kind == AdapterTopic::Kind::pixel) {
    reading.header = framed(message.header, rays);
    reading.addPixel({message.point.x, message.point.y}, std::nullopt, rays);
  } else {
    reading.addDirection(vectorOf(message.point));
  }
  return reading;
}

Reading read(const geometry_msgs::PoseStamped& message, const AdapterTopic& topic, const PixelRays*) {
  Reading reading(topic, message.header);
  reading.addDirection(vectorOf(message.pose.position));
  return reading;
}

Reading read(const geometry_msgs::PoseArray& message, const AdapterTopic& topic, const PixelRays*) {
  Reading reading(topic, message.header);
  for (const auto& pose : message.poses) reading.addDirection(vectorOf(pose.position));
  return reading;
}

Reading read(const geometry_msgs::PoseWithCovarianceStamped& message, const AdapterTopic& topic,
             const PixelRays*) {
  Reading reading(topic, message.header);
  reading.addPoint(vectorOf(message.pose.pose.position), positionCovariance(message.pose));
  return reading;
}

Reading read(const nav_msgs::Odometry& message, const AdapterTopic& topic, const PixelRays*) {
  Reading reading(topic, message.header);
  reading.addPoint(vectorOf(message.pose.pose.position), positionCovariance(message.pose));
  return reading;
}

Reading read(const sensor_msgs::RegionOfInterest& message, const AdapterTopic& topic, const PixelRays* rays) {
  Reading reading(topic, rays != nullptr ? rays->header() : std_msgs::Header());
  if (message.width == 0 || message.height == 0) {
    if (rays == nullptr) reading.addPixel({0.0, 0.0}, std::nullopt, rays);  // no stamp yet: refused
    return reading;
  }
  const Eigen::Vector2d first(message.x_offset, message.y_offset);
  const Eigen::Vector2d size(message.width, message.height);
  reading.addPixel(first + 0.5 * (size - Eigen::Vector2d::Ones()), std::nullopt, rays);
  return reading;
}

Reading read(const sensor_msgs::LaserScan& message, const AdapterTopic& topic, const PixelRays*) {
  Reading reading(topic, message.header);
  const auto beams = static_cast<double>(message.ranges.size());
  const double to_the_middle = 0.5 * std::max(0.0, beams - 1.0) * message.time_increment;
  if (std::abs(to_the_middle) > kLongestSweep) {
    reading.refuse("malformed", "time_increment " + std::to_string(message.time_increment) + " s with " +
                                    std::to_string(message.ranges.size()) +
                                    " ranges: a sweep of more than an hour; is it in seconds?");
    return reading;
  }
  if (!reading.header.stamp.isZero() && std::isfinite(to_the_middle))
    reading.middle = core::durationOf(to_the_middle);
  if (!std::isfinite(message.angle_min) || !std::isfinite(message.angle_increment) ||
      message.angle_increment == 0.0F) {
    reading.refuse("malformed", "angle_min " + std::to_string(message.angle_min) + ", angle_increment " +
                                    std::to_string(message.angle_increment) +
                                    " rad: finite angles and an increment that is not 0 are expected");
    return reading;
  }
  for (const core::LaserSpot& spot : core::laserSpots(sweepOf(message), message.ranges, topic.laser)) {
    const double plane_variance = topic.sigma->x() * topic.sigma->x() + spot.width * spot.width / 12.0;
    const double elevation_variance = topic.sigma->y() * topic.sigma->y();
    reading.addAngles({core::wrapAngle(spot.angle), 0.0},
                      Eigen::Matrix2d(Eigen::Vector2d(plane_variance, elevation_variance).asDiagonal()));
  }
  return reading;
}

}  // namespace sightline_ros
