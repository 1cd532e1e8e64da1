#include "sightline/ros/recordings/report_data.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#include <rosbag/view.h>
#include <sightline/AssociationArray.h>
#include <sightline/FusionReport.h>
#include <sightline/PositionReport.h>
#include <sightline/PositionTrackArray.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>
#include <std_msgs/String.h>

#include "sightline/core/evaluation/innovation_statistics.h"
#include "sightline/report/output_file.h"
#include "sightline/report/value_text.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/messages/station_pose.h"
#include "sightline/ros/recordings/bags.h"
#include "sightline/ros/recordings/recorded_positions.h"
#include "sightline/ros/recordings/recorded_stations.h"
#include "sightline/ros/recordings/recorded_transforms.h"
#include "sightline/ros/recordings/recording_reader.h"
#include "sightline/ros/recordings/replay_parameters.h"

namespace sightline_ros {

namespace core = sightline::core;
using sightline::report::TextFile;

namespace {

constexpr double kWindows = 600.0;             // of a recording
constexpr double kShortestWindow = 0.2;        // [s]
constexpr int kPlacesInTime = 200;             // of a station that moves
constexpr std::size_t kMostValues = 8;         // of one setting
constexpr std::size_t kMostParameters = 1000;  // of one message

const char* const kTracksTruth = "/truth";  // of simulated recordings
const char* const kPositionsTruth = "/truth/positions";

std::string cellOf(const std::string& text) {
  return sightline::report::csvCell(text);
}

/// Empty where the value is not known.
std::string cellOf(double value) {
  return sightline::report::orEmpty(value);
}

/// Seconds to the millisecond.
std::string timeCell(double seconds) {
  std::ostringstream text;
  text << std::fixed;
  text.precision(3);
  text << seconds;
  return text.str();
}

/// A CSV file while it is written.
class ReportTable {
 public:
  ReportTable(const std::string& path, const std::string& header) : file_(path) {
    file_.stream() << header << '\n';
  }

  template <typename... Cells>
  void add(const Cells&... cells) {
    std::string line;
    const char* separator = "";
    ((line += separator + cellOf(cells), separator = ","), ...);
    file_.stream() << line << '\n';
  }

  void finish() { file_.finish(); }

 private:
  TextFile file_;
};

/// Which of the samples of many series are written: one of each in a window of time.
class Thinning {
 public:
  explicit Thinning(double window) : window_(window) {}

  /// Time that goes back starts a series anew.
  bool isDue(const std::string& series, double time) {
    const auto [last, is_new] = written_.try_emplace(series, time);
    if (!is_new && time >= last->second && time < last->second + window_) return false;
    last->second = time;
    return true;
  }

 private:
  double window_;  // [s]
  std::map<std::string, double> written_;
};

/// What is gathered of a recording's messages.
class ReportData {
 public:
  ReportData(const std::string& folder, double window)
      : window_(window),
        thinning_(window),
        innovations_(folder + "/innovations.csv", "topic,time,accepted,nis"),
        lives_table_(folder + "/lives.csv", "topic,track,first,last"),
        sensors_(folder + "/sensors.csv",
                 "topic,time,sensor,verdict,noise_scale,clock_behind,slow_scale,reason"),
        scene_(folder + "/scene.csv", "kind,name,time,x_m,y_m,z_m"),
        recorded_table_(folder + "/recorded.csv", "topic,key,value") {}

  void add(const rosbag::MessageInstance& instance) {
    tryAs<sightline::AssociationArray>(instance) || tryAs<sightline::TrackArray>(instance) ||
        tryAs<sightline::PositionTrackArray>(instance) || tryAs<sightline::FusionReport>(instance) ||
        tryAs<sightline::PositionReport>(instance) || tryAs<sightline::SightingArray>(instance) ||
        (isParameterTopic(instance.getTopic()) && tryAs<std_msgs::String>(instance));
  }

  void addPlace(const std::string& kind, const std::string& name, double time, double x, double y, double z) {
    scene_.add(kind, name, timeCell(time), x, y, z);
  }

  /// Frame of the positions; empty without any.
  const std::string& metricFrame() const { return metric_frame_; }

  void finish() {
    for (const auto& [key, statistics] : windows_) {
      innovations_.add(key.first, timeCell((static_cast<double>(key.second) + 0.5) * window_),
                       std::to_string(statistics.count(core::Decision::accepted)), statistics.nis());
    }
    for (const auto& [key, life] : lives_)
      lives_table_.add(key.first, std::to_string(key.second), timeCell(life.first), timeCell(life.second));
    for (const auto& [key, values] : recorded_)
      recorded_table_.add(key.first, key.second, sightline::report::listOf(values, kMostValues));
    for (ReportTable* table : {&innovations_, &lives_table_, &sensors_, &scene_, &recorded_table_})
      table->finish();
  }

 private:
  template <typename Message>
  bool tryAs(const rosbag::MessageInstance& instance) {
    if (!instance.isType<Message>()) return false;
    add(instance.getTopic(), *messageOf<Message>(instance));
    return true;
  }

  void add(const std::string& topic, const sightline::AssociationArray& message) {
    const auto index = static_cast<std::int64_t>(std::floor(message.header.stamp.toSec() / window_));
    core::InnovationStatistics& statistics = windows_[{topic, index}];
    for (const auto& association : message.associations) statistics.add(toCore(association));
  }

  void add(const std::string& topic, const sightline::TrackArray& message) {
    note(topic, "tracker", message.tracker);
    note(topic, "estimator", message.estimator);
    note(topic, "frame", message.header.frame_id);
    for (const auto& track : message.tracks)
      if (track.status != sightline::Track::TENTATIVE) live(topic, track.id, message.header.stamp.toSec());
  }

  void add(const std::string& topic, const sightline::PositionTrackArray& message) {
    note(topic, "tracker", message.tracker);
    note(topic, "frame", message.header.frame_id);
    const double time = message.header.stamp.toSec();
    metric_frame_ = message.header.frame_id;
    for (const auto& track : message.tracks) {
      if (track.status == sightline::PositionTrack::TENTATIVE) continue;
      live(topic, track.id, time);
      const std::string name = std::to_string(track.id);
      if (!thinning_.isDue(topic + '\n' + name, time)) continue;
      addPlace(topic, name, time, track.position.x, track.position.y, track.position.z);
    }
  }

  void add(const std::string& topic, const sightline::FusionReport& message) {
    const double time = message.header.stamp.toSec();
    for (const auto& track : message.tracks) {
      note(topic, "rule", track.rule);
      for (const auto& sensor : track.sensors)
        if (thinning_.isDue(topic + '\n' + sensor.sensor, time)) addHealth(topic, time, sensor);
      for (const auto& change : track.sensor_changes) addHealth(topic, time, change);
    }
  }

  void add(const std::string& topic, const sightline::PositionReport& message) {
    const double time = message.header.stamp.toSec();
    for (const auto& station : message.stations) {
      if (!thinning_.isDue(topic + '\n' + station.tracker + '\n' + station.sensor, time)) continue;
      sensors_.add(topic, timeCell(time), station.sensor, "", "", station.clock_behind, station.slow_scale,
                   "");
    }
  }

  void add(const std::string& topic, const sightline::SightingArray& message) {
    note(topic, "sensor", message.sensor);
    note(topic, "frame", message.header.frame_id);
    note(topic, "ifov [rad]", cellOf(message.ifov));
  }

  /// "name: value" in each line.
  void add(const std::string& topic, const std_msgs::String& message) {
    std::istringstream lines(message.data);
    std::string line;
    for (std::size_t i = 0; i < kMostParameters && std::getline(lines, line); ++i) {
      const std::size_t colon = line.find(": ");
      if (colon != std::string::npos) note(topic, line.substr(0, colon), line.substr(colon + 2));
    }
  }

  void addHealth(const std::string& topic, double time, const sightline::SensorHealth& sensor) {
    sensors_.add(topic, timeCell(time), sensor.sensor, sensor.verdict, sensor.noise_scale,
                 sensor.clock_behind, "", sensor.reason);
  }

  /// Values that follow each other are kept, up to one more than are listed.
  void note(const std::string& topic, const std::string& key, const std::string& value) {
    if (value.empty()) return;
    std::set<std::string>& values = recorded_[{topic, key}];
    if (values.size() <= kMostValues) values.insert(value);
  }

  void live(const std::string& topic, std::uint32_t track, double time) {
    auto [life, is_new] = lives_.try_emplace({topic, track}, time, time);
    life->second.first = std::min(life->second.first, time);
    life->second.second = std::max(life->second.second, time);
  }

  double window_;  // [s]
  Thinning thinning_;
  ReportTable innovations_, lives_table_, sensors_, scene_, recorded_table_;
  std::map<std::pair<std::string, std::int64_t>, core::InnovationStatistics> windows_;  // topic and window
  std::map<std::pair<std::string, std::uint32_t>, std::pair<double, double>>
      lives_;                                                                      // topic and track: stamps
  std::map<std::pair<std::string, std::string>, std::set<std::string>> recorded_;  // topic and key: values
  std::string metric_frame_;
};

/// Where the stations are; of one that moves, its path.
void addStations(const rosbag::Bag& bag, double begin, double end, ReportData& data) {
  const std::string& metric_frame = data.metricFrame();
  const RecordedStations found = recordedStationsOf(bag, metric_frame);
  RecordedTransforms transforms(bag);
  for (int i = 0; i <= kPlacesInTime; ++i) {
    const ros::Time stamp(begin + (end - begin) * i / kPlacesInTime);
    transforms.advanceTo(toCore(stamp));
    for (const RecordedStation& station : found.stations) {
      if (!isPoseKnown(station.frame, stamp, metric_frame, transforms.buffer())) continue;
      const auto origin = poseOf(station.frame, stamp, metric_frame, transforms.buffer()).origin;
      data.addPlace("station", station.name, stamp.toSec(), origin.x(), origin.y(), origin.z());
    }
  }
}

/// How a recording was evaluated.
void writeSettings(const std::string& bag, const BagEvaluationSettings& settings) {
  const core::EvaluationParams& params = settings.evaluation;
  const bool has_elevation = params.channels != core::Channels::azimuth_only;
  ReportTable table(settings.csv + "/settings.csv", "key,value");
  table.add("recording", bag);
  table.add("truth", settings.truth);
  table.add("channels", has_elevation ? "azimuth and elevation" : "azimuth");
  table.add("settle [s]", params.settle_time);
  table.add("truth gap [s]", params.truth_gap);
  table.add("match gate [rad]", params.match_gate);
  table.add("sighting gate [sigma]", params.sighting_gate);
  table.add("sighting floor [rad]", params.sighting_gate_floor);
  table.add("GOSPA c [rad]", params.gospa.cutoff);
  table.add("GOSPA c [m]", settings.positions.gospa_cutoff);
  table.finish();
}

}  // namespace

void writeReportData(const rosbag::Bag& bag, const std::string& folder) {
  rosbag::View view(bag);
  const double begin = view.size() > 0 ? view.getBeginTime().toSec() : 0.0;
  const double end = view.size() > 0 ? view.getEndTime().toSec() : 0.0;
  ReportData data(folder, std::max((end - begin) / kWindows, kShortestWindow));
  for (const rosbag::MessageInstance& instance : view) data.add(instance);
  if (!data.metricFrame().empty()) addStations(bag, begin, end, data);
  data.finish();
}

std::string truthTopicOf(const rosbag::Bag& bag) {
  bool has_tracks = false, has_positions = false;
  rosbag::View view(bag);
  for (const rosbag::ConnectionInfo* connection : view.getConnections()) {
    if (connection->topic == kTracksTruth || connection->topic == kPositionsTruth) continue;
    has_tracks |= connection->datatype == ros::message_traits::datatype<sightline::TrackArray>();
    has_positions |= connection->datatype == ros::message_traits::datatype<sightline::PositionTrackArray>();
  }
  if (has_positions && isPositionTopic(kPositionsTruth, bag)) return kPositionsTruth;
  rosbag::View truth(bag, rosbag::TopicQuery(kTracksTruth));
  return has_tracks && truth.size() > 0 ? kTracksTruth : "";
}

std::string evaluateForReport(const std::string& bag, const BagEvaluationSettings& settings) {
  std::string tables = evaluateBag(bag, settings);
  writeReportData(*openBag(bag), settings.csv);
  writeSettings(bag, settings);
  TextFile console(settings.csv + "/console.txt");
  console.stream() << tables;
  console.finish();
  return tables;
}

}  // namespace sightline_ros
