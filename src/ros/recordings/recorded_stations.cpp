#include "sightline/ros/recordings/recorded_stations.h"

#include <algorithm>
#include <map>
#include <optional>

#include <Eigen/Core>

#include <rosbag/view.h>
#include <sightline/SightingArray.h>

#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/messages/framed_scan.h"
#include "sightline/ros/messages/station_pose.h"
#include "sightline/ros/recordings/bags.h"
#include "sightline/ros/recordings/recorded_transforms.h"

namespace sightline_ros {

using sightline::SightingArray;

namespace {

struct FirstScan {
  std::string frame;
  ros::Time stamp;
};

std::map<std::string, FirstScan> firstScansOf(const rosbag::Bag& bag) {
  std::map<std::string, FirstScan> first;
  rosbag::View view(bag, rosbag::TypeQuery(ros::message_traits::datatype<SightingArray>()));
  for (const rosbag::MessageInstance& instance : view) {
    const auto scan = messageIn<SightingArray>(instance);
    if (!scan || refusalOf(*scan)) continue;
    const auto [entry, is_new] =
        first.try_emplace(scan->sensor, FirstScan{scan->header.frame_id, scan->header.stamp});
    if (!is_new) entry->second.stamp = std::min(entry->second.stamp, scan->header.stamp);
  }
  return first;
}

}  // namespace

RecordedStations recordedStationsOf(const rosbag::Bag& bag, const std::string& metric_frame) {
  const std::map<std::string, FirstScan> first = firstScansOf(bag);
  ros::Time stamp;  // from which all have spoken: on a platform that moves, places at different times differ
  for (const auto& [sensor, scan] : first) stamp = std::max(stamp, scan.stamp);
  RecordedTransforms transforms(bag);
  transforms.advanceTo(toCore(stamp));

  RecordedStations found;
  std::vector<std::optional<Eigen::Vector3d>> origins;  // of the stations
  std::vector<std::string> platforms;                   // likewise; empty = none
  for (const auto& [sensor, scan] : first) {
    std::optional<Eigen::Vector3d> origin;
    if (isPoseKnown(scan.frame, stamp, metric_frame, transforms.buffer()))
      origin = poseOf(scan.frame, stamp, metric_frame, transforms.buffer()).origin;
    const std::string platform = transforms.platformOf(scan.frame);
    std::size_t same = 0;
    for (; same < origins.size(); ++same) {
      if (!origin || !origins[same]) continue;
      const bool is_on_platform = !platform.empty() && platforms[same] == platform && platform != scan.frame;
      const double reach = is_on_platform ? RecordedStations::kOnePlatform : RecordedStations::kOnePlace;
      if ((*origins[same] - *origin).norm() <= reach) break;
    }
    if (same < origins.size()) {
      found.stations[same].sensors.push_back(sensor);
      continue;
    }
    for (const auto& other : origins)
      if (origin && other) found.apart = std::max(found.apart, (*other - *origin).norm());
    found.stations.push_back({sensor, scan.frame, {sensor}});
    origins.push_back(origin);
    platforms.push_back(platform);
  }
  return found;
}

}  // namespace sightline_ros
