#include "sightline/ros/recordings/imported_recording.h"

#include <limits>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>

#include "sightline/core/model/sphere.h"
#include "sightline/formats/field_text.h"
#include "sightline/formats/formats.h"
#include "sightline/report/output_file.h"
#include "sightline/report/value_text.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/recordings/bags.h"
#include "sightline/ros/recordings/station_frames.h"

namespace sightline_ros {

namespace core = sightline::core;
namespace formats = sightline::formats;
namespace report = sightline::report;

namespace {

constexpr double kNotGiven = std::numeric_limits<double>::quiet_NaN();

std::set<std::string> sensorsOf(const formats::Recording& recording) {
  std::set<std::string> sensors;
  for (const formats::FileScan& scan : recording.scans) sensors.insert(scan.sensor);
  return sensors;
}

ros::Time stampOf(const formats::FileScan& scan) {
  if (scan.time <= core::Time{}) {
    std::ostringstream why;
    why << scan.sensor << ": a scan at " << core::seconds(scan.time - core::Time{})
        << " s cannot be held by a bag, which knows only times after 0: shift the recording, with --offset "
           "100 for "
           "instance";
    throw std::runtime_error(why.str());
  }
  try {
    return toRos(scan.time);
  } catch (const std::range_error& problem) {
    throw std::runtime_error(scan.sensor + ": " + problem.what());
  }
}

sightline::SightingArray messageOf(const formats::FileScan& scan, const std::string& sensor,
                                   const std::string& frame) {
  sightline::SightingArray message;
  message.header.stamp = stampOf(scan);
  message.header.frame_id = frame;
  message.sensor = sensor;
  message.ifov = message.detection_probability = message.clutter_density = kNotGiven;
  for (const formats::FileSighting& from : scan.sightings) {
    sightline::Sighting sighting;
    sighting.azimuth = from.angles.x();
    sighting.elevation = from.angles.y();
    sighting.covariance = {from.sigma.x() * from.sigma.x(), 0.0, 0.0, from.sigma.y() * from.sigma.y()};
    sighting.snr = from.snr;
    message.sightings.push_back(sighting);
  }
  return message;
}

/// Stations that were told and are of no sensor: a name may be misspelt.
std::string unusedStations(const formats::ImportOptions& options, const std::set<std::string>& sensors) {
  std::set<std::string> unused;
  for (const auto& [sensor, station] : options.stations) {
    if (!sensor.empty() && sensors.count(sensor) == 0) unused.insert(sensor);
  }
  return unused.empty()
             ? ""
             : "stations that were told and are of no sensor in these files: " + report::listOf(unused) +
                   "\n";
}

/// Remarks of each file under its name; the same of many files once.
std::string describe(const std::vector<std::string>& files,
                     const std::vector<formats::Recording>& recordings) {
  std::ostringstream text;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const formats::Recording& recording = recordings[i];
    std::size_t sightings = 0, empty = 0;
    for (const formats::FileScan& scan : recording.scans) {
      sightings += scan.sightings.size();
      empty += scan.sightings.empty() ? 1 : 0;
    }
    text << files[i] << ": " << recording.format << ", sensors " << report::listOf(sensorsOf(recording))
         << ": " << recording.scans.size() << " scans with " << sightings << " sightings";
    if (empty > 0) text << " (" << empty << " scans saw nothing)";
    text << ", " << formats::isoText(recording.scans.front().time) << " to "
         << formats::isoText(recording.scans.back().time) << "\n";
    for (const auto& [sensor, station] : recording.stations) {
      text << "  station " << sensor << ": latitude " << station.latitude / core::kDegree
           << " deg, longitude " << station.longitude / core::kDegree << " deg, height " << station.height
           << " m\n";
    }
    for (const std::string& remark : recording.remarks) text << "  " << remark << "\n";
  }
  return text.str();
}

std::vector<formats::Recording> readAll(const std::vector<std::string>& files,
                                        const formats::ImportOptions& options) {
  std::vector<formats::Recording> recordings;
  for (const std::string& file : files) recordings.push_back(formats::readRecording(file, options));
  return recordings;
}

formats::StationLayout layoutOf(const formats::Recording& recording,
                                const std::map<std::string, std::string>& parts) {
  std::map<std::string, formats::Station> stations;
  for (const auto& [sensor, station] : recording.stations) {
    const auto part = parts.find(sensor);
    if (part != parts.end()) stations[part->second] = station;
  }
  return formats::layoutOf(stations);
}

}  // namespace

std::vector<sightline::SightingArray> scansOf(const formats::Recording& recording, const std::string& frame,
                                              std::vector<std::string>& renamed) {
  const std::set<std::string> sensors = sensorsOf(recording);
  const auto parts = topicPartsOf(sensors);
  bool has_stations = false;
  for (const std::string& sensor : sensors) {
    has_stations = has_stations || recording.stations.count(sensor) > 0;
    if (parts.at(sensor) != sensor)
      renamed.push_back("sensor \"" + sensor + "\" is called " + parts.at(sensor));
  }
  if (frame.empty() && has_stations) {
    for (const std::string& sensor : sensors) {
      if (recording.stations.count(sensor) > 0) continue;
      throw std::runtime_error("the position of sensor \"" + sensor +
                               "\" is not known, while that of others is: state it with --station " + sensor +
                               "=LATITUDE,LONGITUDE,HEIGHT, or leave all positions out with --frame FRAME");
    }
  }
  std::vector<sightline::SightingArray> scans;
  scans.reserve(recording.scans.size());
  for (const formats::FileScan& scan : recording.scans) {
    const std::string& name = parts.at(scan.sensor);
    const std::string in_frame = !frame.empty() ? frame : has_stations ? name : "platform_enu";
    scans.push_back(messageOf(scan, name, in_frame));
  }
  return scans;
}

std::string importSightings(const std::vector<std::string>& files, const std::string& bag_file,
                            const formats::ImportOptions& options, const std::string& frame) {
  const std::vector<formats::Recording> recordings = readAll(files, options);
  const formats::Recording recording = formats::merged(recordings);
  std::vector<std::string> renamed;
  const auto scans = scansOf(recording, frame, renamed);
  const formats::StationLayout layout = layoutOf(recording, topicPartsOf(sensorsOf(recording)));
  const bool has_frames = frame.empty() && !layout.places.empty();
  std::set<std::string> sensors, topics;
  std::size_t sightings = 0;
  for (const auto& scan : scans) {
    sensors.insert(scan.sensor);
    topics.insert(sensorTopic(scan.sensor, "sightings"));
    sightings += scan.sightings.size();
  }
  writeBag(bag_file, files, [&](rosbag::Bag& bag) {
    if (has_frames)
      writeStationFrames(bag, layout, sensors, scans.front().header.stamp,
                         "state it with --station NAME=LAT,LON,HEIGHT");
    for (const auto& scan : scans) bag.write(sensorTopic(scan.sensor, "sightings"), scan.header.stamp, scan);
  });
  std::ostringstream text;
  text << describe(files, recordings);
  for (const std::string& line : recording.remarks) text << line << "\n";
  text << unusedStations(options, sensorsOf(recording));
  for (const std::string& line : renamed) text << line << "\n";
  text << bag_file << ": " << scans.size() << " scans with " << sightings << " sightings on "
       << report::listOf(topics)
       << (has_frames ? ", each in the frame of its sensor; their places in /tf_static from world\n"
                      : ", in frame " + scans.front().header.frame_id + "\n");
  return text.str();
}

std::string importTruth(const std::vector<std::string>& files, const std::string& csv,
                        const formats::ImportOptions& options) {
  formats::ImportOptions for_truth = options;
  for_truth.for_truth = true;
  const std::vector<formats::Recording> recordings = readAll(files, for_truth);
  const formats::Recording recording = formats::merged(recordings);
  report::TextFile table(csv, files);
  const std::string text = formats::truthCsv(recording);
  table.stream() << text;
  table.finish();
  return describe(files, recordings) + csv + ": a truth for evaluate --truth\n";
}

}  // namespace sightline_ros
