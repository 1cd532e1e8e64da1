#include "sightline/ros/recordings/csv_recordings.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <Eigen/Core>

#include <rosbag/bag.h>
#include <rosbag/view.h>

#include "sightline/core/model/sighting.h"
#include "sightline/formats/geodesy.h"
#include "sightline/report/output_file.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/recordings/bags.h"
#include "sightline/ros/recordings/station_frames.h"

namespace sightline_ros {

namespace core = sightline::core;
namespace report = sightline::report;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
const char* const kStatusNames[] = {"tentative", "confirmed", "coasting"};

ros::Time stampOf(const report::CsvTable& table, std::size_t row, double offset) {
  const core::Time time = table.time(row, "time") + core::durationOf(offset);
  if (time <= core::Time{}) {
    std::ostringstream complaint;
    complaint
        << "time: " << table.text(row, "time") << " s"
        << " cannot be held by a bag, which knows only times after 0: shift the recording, with --offset 100 "
           "for instance";
    throw table.error(row, complaint.str());
  }
  try {
    return toRos(time);
  } catch (const std::range_error& problem) {
    throw table.error(row, std::string("time: ") + problem.what());
  }
}

const std::string& sensorOf(const report::CsvTable& table, std::size_t row) {
  const std::string& sensor = table.text(row, "sensor");
  if (!isTopicPart(sensor)) {
    throw table.error(row,
                      "sensor: expected a name of letters, digits and underscores, of which a topic can be "
                      "made, got \"" +
                          sensor + "\"");
  }
  return sensor;
}

sightline::Sighting sightingOf(const report::CsvTable& table, std::size_t row) {
  const Eigen::Vector2d angles(table.number(row, "azimuth", "rad"), table.number(row, "elevation", "rad"));
  const Eigen::Vector2d sigma(table.number(row, "sigma_azimuth", "rad"),
                              table.number(row, "sigma_elevation", "rad"));
  const Eigen::Matrix2d covariance = sigma.cwiseAbs2().asDiagonal();
  if (const auto why = core::rejectionOf(angles, covariance)) throw table.error(row, why->detail);
  if (sigma.minCoeff() < 0.0)
    throw table.error(row, "a sigma is negative: state standard deviations in radians");
  sightline::Sighting sighting;
  sighting.azimuth = angles.x();
  sighting.elevation = angles.y();
  sighting.covariance = {covariance(0, 0), 0.0, 0.0, covariance(1, 1)};
  sighting.snr = kNaN;
  return sighting;
}

/// Whether a row says that the sensor looked and saw nothing.
bool sawNothing(const report::CsvTable& table, std::size_t row) {
  for (const char* column : {"azimuth", "elevation", "sigma_azimuth", "sigma_elevation"}) {
    if (!table.text(row, column).empty()) return false;
  }
  return true;
}

sightline::SightingArray emptyScan(const ros::Time& stamp, const std::string& sensor,
                                   const std::string& frame) {
  sightline::SightingArray scan;
  scan.header.stamp = stamp;
  scan.header.frame_id = frame;
  scan.sensor = sensor;
  scan.ifov = scan.detection_probability = scan.clutter_density = kNaN;
  return scan;
}

double sigma(const sightline::Track& track, int channel) {
  return std::sqrt(track.covariance[5 * static_cast<std::size_t>(channel)]);
}

/// Rows of a scan, of name `scan`, for csv_to_bag.
std::string csvOf(const sightline::SightingArray& array, const std::string& scan) {
  std::ostringstream lines;
  lines << std::setprecision(12);
  for (const auto& sighting : array.sightings) {
    lines << array.header.stamp << ',' << array.sensor << ',' << sighting.azimuth << ',' << sighting.elevation
          << ',' << std::sqrt(sighting.covariance[0]) << ',' << std::sqrt(sighting.covariance[3]) << ','
          << scan << '\n';
  }
  if (array.sightings.empty()) lines << array.header.stamp << ',' << array.sensor << ",,,,," << scan << '\n';
  return lines.str();
}

bool isWanted(const std::vector<std::string>& topics, const std::string& topic) {
  return topics.empty() || std::find(topics.begin(), topics.end(), topic) != topics.end();
}

/// Tracks by their stamp; those of one instant by topic.
using TrackLines = std::map<std::tuple<ros::Time, std::string>, std::string>;

}  // namespace

report::CsvTable readSightingTable(const std::string& path) {
  return report::CsvTable::fromFile(
      path, {"time", "sensor", "azimuth", "elevation", "sigma_azimuth", "sigma_elevation"}, {"scan"});
}

std::vector<sightline::SightingArray> scansOf(const report::CsvTable& table, const std::string& frame,
                                              double offset) {
  std::vector<sightline::SightingArray> scans;
  std::map<std::pair<std::string, std::string>, std::size_t> scan_of;  // by sensor and name of the scan
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const ros::Time stamp = stampOf(table, row, offset);
    const std::string& sensor = sensorOf(table, row);
    const std::string name = table.has("scan") ? table.text(row, "scan") : std::to_string(row);
    const auto [place, is_new] = scan_of.emplace(std::make_pair(sensor, name), scans.size());
    if (is_new) scans.push_back(emptyScan(stamp, sensor, frame));
    sightline::SightingArray& scan = scans[place->second];
    if (scan.header.stamp != stamp) {
      throw table.error(
          row, "scan: \"" + name + "\" of " + sensor + " has rows of different times; one exposure has one");
    }
    if (!sawNothing(table, row)) scan.sightings.push_back(sightingOf(table, row));
  }
  std::stable_sort(scans.begin(), scans.end(), [](const auto& a, const auto& b) {
    return std::tie(a.header.stamp, a.sensor) < std::tie(b.header.stamp, b.sensor);
  });
  return scans;
}

std::string trackColumns() {
  return "time,tracker,track,status,azimuth,elevation,azimuth_rate,elevation_rate,sigma_azimuth,sigma_"
         "elevation,"
         "sigma_azimuth_rate,sigma_elevation_rate";
}

std::string csvOf(const sightline::TrackArray& tracks) {
  std::ostringstream lines;
  lines << std::setprecision(12);
  for (const auto& track : tracks.tracks) {
    const char* status = track.status < 3 ? kStatusNames[track.status] : "unknown";
    lines << tracks.header.stamp << ',' << tracks.tracker << ',' << track.id << ',' << status << ','
          << track.azimuth << ',' << track.elevation << ',' << track.azimuth_rate << ','
          << track.elevation_rate;
    for (int channel = 0; channel < 4; ++channel) lines << ',' << sigma(track, channel);
    lines << '\n';
  }
  return lines.str();
}

std::string convertCsvToBag(const std::string& csv, const std::string& bag_file, const std::string& frame,
                            double offset, const std::string& stations) {
  auto scans = scansOf(readSightingTable(csv), frame, offset);
  if (scans.empty()) throw report::CsvError(csv + ": there is no sighting in it");
  sightline::formats::StationLayout layout;
  std::set<std::string> sensors;
  if (!stations.empty()) {
    layout = sightline::formats::readStationLayout(stations);
    for (auto& scan : scans) {
      scan.header.frame_id = scan.sensor;
      sensors.insert(scan.sensor);
    }
  }
  std::set<std::string> topics;
  std::size_t sightings = 0;
  writeBag(bag_file, {csv, stations}, [&](rosbag::Bag& bag) {
    if (!stations.empty())
      writeStationFrames(bag, layout, sensors, scans.front().header.stamp, "add it to " + stations);
    for (const auto& scan : scans) {
      const std::string topic = sensorTopic(scan.sensor, "sightings");
      bag.write(topic, scan.header.stamp, scan);
      topics.insert(topic);
      sightings += scan.sightings.size();
    }
  });
  std::ostringstream summary;
  summary << bag_file << ": " << scans.size() << " scans with " << sightings << " sightings in "
          << (stations.empty() ? "frame " + frame : "the frames of their sensors") << " on";
  for (const std::string& topic : topics) summary << ' ' << topic;
  return summary.str();
}

std::string convertBagToCsv(const std::string& bag_file, const std::string& csv,
                            const std::vector<std::string>& topics) {
  report::TextFile table(csv, {bag_file});
  const auto bag = openBag(bag_file);
  TrackLines lines;
  rosbag::View view(*bag, rosbag::TypeQuery(ros::message_traits::datatype<sightline::TrackArray>()));
  for (const rosbag::MessageInstance& instance : view) {
    if (!isWanted(topics, instance.getTopic())) continue;
    const auto tracks = messageIn<sightline::TrackArray>(instance);
    if (!tracks)
      throw std::runtime_error(bag_file + ": " + instance.getTopic() +
                               " has another definition of TrackArray");
    lines[{tracks->header.stamp, instance.getTopic()}] += csvOf(*tracks);
  }
  if (lines.empty())
    throw std::runtime_error(bag_file + ": there is no TrackArray message in it" +
                             (topics.empty() ? "" : " on these topics") +
                             "; sightings are written with --sightings");
  table.stream() << trackColumns() << '\n';
  for (const auto& line : lines) table.stream() << line.second;
  table.finish();
  return csv + ": " + std::to_string(lines.size()) + " messages";
}

std::string convertBagToSightingCsv(const std::string& bag_file, const std::string& csv,
                                    const std::vector<std::string>& topics) {
  report::TextFile table(csv, {bag_file});
  const auto bag = openBag(bag_file);
  std::multimap<std::tuple<ros::Time, std::string>, std::string> lines;
  rosbag::View view(*bag, rosbag::TypeQuery(ros::message_traits::datatype<sightline::SightingArray>()));
  std::size_t number = 0;
  for (const rosbag::MessageInstance& instance : view) {
    if (!isWanted(topics, instance.getTopic())) continue;
    const auto scan = messageIn<sightline::SightingArray>(instance);
    if (!scan)
      throw std::runtime_error(bag_file + ": " + instance.getTopic() +
                               " has another definition of SightingArray");
    lines.emplace(std::make_tuple(scan->header.stamp, scan->sensor), csvOf(*scan, std::to_string(++number)));
  }
  if (lines.empty())
    throw std::runtime_error(bag_file + ": there is no SightingArray message in it" +
                             (topics.empty() ? "" : " on these topics"));
  table.stream() << "time,sensor,azimuth,elevation,sigma_azimuth,sigma_elevation,scan\n";
  for (const auto& line : lines) table.stream() << line.second;
  table.finish();
  return csv + ": " + std::to_string(lines.size()) + " scans";
}

}  // namespace sightline_ros
