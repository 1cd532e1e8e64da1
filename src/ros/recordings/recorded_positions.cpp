#include "sightline/ros/recordings/recorded_positions.h"

#include <fstream>
#include <optional>
#include <stdexcept>

#include <rosbag/view.h>
#include <sensor_msgs/NavSatFix.h>
#include <sightline/PositionTrackArray.h>

#include "sightline/core/model/sphere.h"
#include "sightline/formats/geodesy.h"
#include "sightline/report/csv_table.h"
#include "sightline/ros/messages/position_messages.h"
#include "sightline/ros/recordings/bags.h"
#include "sightline/ros/recordings/station_frames.h"

namespace sightline_ros {

namespace core = sightline::core;
namespace formats = sightline::formats;
using sightline::report::CsvError;
using sightline::report::CsvTable;

namespace {

std::string headerOf(const std::string& path) {
  std::ifstream stream(path);
  std::string line;
  std::getline(stream, line);
  return line;
}

bool isGeodetic(const std::string& path) {
  return headerOf(path).find("latitude_deg") != std::string::npos;
}

/// Where `world` is on the earth.
formats::Station worldOf(const rosbag::Bag& bag, const std::string& path) {
  rosbag::View view(bag, rosbag::TopicQuery(kWorldOriginTopic));
  for (const rosbag::MessageInstance& instance : view) {
    const auto fix = messageIn<sensor_msgs::NavSatFix>(instance);
    if (fix) return {fix->latitude * core::kDegree, fix->longitude * core::kDegree, fix->altitude};
  }
  throw std::runtime_error(path + ": has latitudes, but the recording does not say where its world is (" +
                           std::string(kWorldOriginTopic) +
                           "): make it with geodetic stations (csv_to_bag --stations), or give east_m, "
                           "north_m, up_m");
}

}  // namespace

bool isPositionTruth(const std::string& path) {
  return isGeodetic(path) || headerOf(path).find("east_m") != std::string::npos;
}

std::map<std::string, core::TruePath> positionTruthFromCsv(const std::string& path, const rosbag::Bag& bag,
                                                           double gap) {
  const bool is_geodetic = isGeodetic(path);
  const std::vector<std::string> columns =
      is_geodetic ? std::vector<std::string>{"time", "latitude_deg", "longitude_deg", "height_m"}
                  : std::vector<std::string>{"time", "east_m", "north_m", "up_m"};
  const CsvTable table = CsvTable::fromFile(path, columns, {"target"});
  if (table.rows() == 0) throw CsvError(path + ": there is a header, but no sample below it");
  std::optional<formats::Station> world;
  if (is_geodetic) world = worldOf(bag, path);
  std::map<std::string, core::TruePath> paths;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const double a = table.number(row, columns[1], is_geodetic ? "deg" : "m");
    const double b = table.number(row, columns[2], is_geodetic ? "deg" : "m");
    Eigen::Vector3d position(a, b, table.number(row, columns[3], "m"));
    if (world) {
      if (std::abs(a) > 90.0 || std::abs(b) > 360.0)
        throw table.error(row, "expected a latitude of at most 90 and a longitude of at most 360 degrees");
      const formats::Station place{a * core::kDegree, b * core::kDegree, position.z()};
      position = formats::eastNorthUp(*world).transpose() *
                 (formats::earthFixed(place) - formats::earthFixed(*world));
    }
    const std::string target = table.has("target") ? table.text(row, "target") : "1";
    paths.try_emplace(target, gap).first->second.add(table.time(row, "time"), position);
  }
  return paths;
}

bool isPositionTopic(const std::string& topic, const rosbag::Bag& bag) {
  rosbag::View view(bag, rosbag::TopicQuery(topic));
  return view.size() > 0 && view.begin()->isType<sightline::PositionTrackArray>();
}

std::map<std::string, core::TruePath> positionTruthFromTopic(const std::string& topic, const rosbag::Bag& bag,
                                                             double gap) {
  std::map<std::string, core::TruePath> paths;
  rosbag::View view(bag, rosbag::TopicQuery(topic));
  for (const rosbag::MessageInstance& instance : view) {
    const auto message = messageIn<sightline::PositionTrackArray>(instance);
    if (!message) continue;
    const core::PositionTrackArray truth = toCore(*message);
    for (const core::PositionTrack& track : truth.tracks)
      paths.try_emplace(std::to_string(track.id), gap).first->second.add(truth.time, track.position);
  }
  return paths;
}

}  // namespace sightline_ros
