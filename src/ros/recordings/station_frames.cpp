#include "sightline/ros/recordings/station_frames.h"

#include <algorithm>
#include <stdexcept>

#include <Eigen/Geometry>

#include <sensor_msgs/NavSatFix.h>
#include <tf2_msgs/TFMessage.h>

#include "sightline/core/model/sphere.h"
#include "sightline/report/value_text.h"
#include "sightline/ros/recordings/bags.h"

namespace sightline_ros {

namespace {

using sightline::formats::FramePlace;
using sightline::formats::StationLayout;

constexpr double kOneStation = 1.0;  // [m]: sensors closer than that see a target in one direction

geometry_msgs::TransformStamped transformOf(const FramePlace& place, const std::string& frame,
                                            const ros::Time& stamp) {
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = stamp;
  transform.header.frame_id = kWorldFrame;
  transform.child_frame_id = frame;
  const Eigen::Quaterniond turn(place.rotation);
  transform.transform.translation.x = place.origin.x();
  transform.transform.translation.y = place.origin.y();
  transform.transform.translation.z = place.origin.z();
  transform.transform.rotation.x = turn.x();
  transform.transform.rotation.y = turn.y();
  transform.transform.rotation.z = turn.z();
  transform.transform.rotation.w = turn.w();
  return transform;
}

sensor_msgs::NavSatFix fixOf(const sightline::formats::Station& origin, const ros::Time& stamp) {
  sensor_msgs::NavSatFix fix;
  fix.header.stamp = stamp;
  fix.header.frame_id = kWorldFrame;
  fix.latitude = origin.latitude / sightline::core::kDegree;
  fix.longitude = origin.longitude / sightline::core::kDegree;
  fix.altitude = origin.height;
  return fix;
}

}  // namespace

void writeStationFrames(rosbag::Bag& bag, const StationLayout& layout, const std::set<std::string>& sensors,
                        const ros::Time& stamp, const std::string& remedy) {
  tf2_msgs::TFMessage message;
  double apart = 0.0;  // [m]
  for (const std::string& sensor : sensors) {
    const auto place = layout.places.find(sensor);
    if (place == layout.places.end())
      throw std::runtime_error("sensor \"" + sensor + "\" has no place among the stations: " + remedy);
    message.transforms.push_back(transformOf(place->second, sensor, stamp));
    const FramePlace& first = layout.places.at(*sensors.begin());
    apart = std::max(apart, (place->second.origin - first.origin).norm());
  }
  if (apart <= kOneStation && sensors.count("platform_enu") == 0) {
    FramePlace platform;
    platform.origin = layout.places.at(*sensors.begin()).origin;
    message.transforms.push_back(transformOf(platform, "platform_enu", stamp));
  }
  bag.write("/tf_static", stamp, message, latchedHeader<tf2_msgs::TFMessage>());
  if (layout.origin)
    bag.write(kWorldOriginTopic, stamp, fixOf(*layout.origin, stamp),
              latchedHeader<sensor_msgs::NavSatFix>());
}

}  // namespace sightline_ros
