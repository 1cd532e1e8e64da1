#include "sightline/ros/recordings/report_data.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
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

#include "sightline/core/evaluation/innovation_statistics.h"
#include "sightline/report/output_file.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/messages/station_pose.h"
#include "sightline/ros/recordings/bags.h"
#include "sightline/ros/recordings/recorded_positions.h"
#include "sightline/ros/recordings/recorded_stations.h"
#include "sightline/ros/recordings/recorded_transforms.h"
#include "sightline/ros/recordings/recording_reader.h"

namespace sightline_ros {

namespace core = sightline::core;
using sightline::report::TextFile;

namespace {

constexpr double kWindows = 600.0;    // of a recording
constexpr double kLeastWindow = 0.2;  // [s]
constexpr int kPlacesInTime = 200;    // of a station that moves

const char* const kTruthTopic = "/truth";  // of simulated recordings
const char* const kPositionTruthTopic = "/truth/positions";

/// A field of a CSV file, in quotes where it needs them.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char letter : text) quoted += letter == '"' ? "\"\"" : std::string(1, letter);
  return quoted + "\"";
}

/// Empty where the value is not known.
std::string number(double value) {
  if (std::isnan(value)) return "";
  std::ostringstream text;
  text.precision(9);
  text << value;
  return text.str();
}

/// Seconds to the millisecond.
std::string timeText(double seconds) {
  std::ostringstream text;
  text << std::fixed;
  text.precision(3);
  text << seconds;
  return text.str();
}

/// The files while they are written.
class ReportData {
 public:
  ReportData(const std::string& folder, double window)
      : window_(window),
        innovations_(folder + "/innovations.csv"),
        lives_file_(folder + "/lives.csv"),
        sensors_(folder + "/sensors.csv"),
        scene_(folder + "/scene.csv"),
        recorded_file_(folder + "/recorded.csv") {
    innovations_.stream() << "topic,time,accepted,nis,outside_gate,claimed,started,rejected\n";
    lives_file_.stream() << "topic,track,first,last\n";
    sensors_.stream() << "topic,time,sensor,verdict,noise_scale,clock_behind,slow_scale,reason\n";
    scene_.stream() << "kind,name,time,x_m,y_m,z_m\n";
    recorded_file_.stream() << "topic,key,value\n";
  }

  void add(const rosbag::MessageInstance& instance) {
    const std::string topic = instance.getTopic();
    if (instance.isType<sightline::AssociationArray>())
      add(topic, *messageOf<sightline::AssociationArray>(instance));
    else if (instance.isType<sightline::TrackArray>())
      add(topic, *messageOf<sightline::TrackArray>(instance));
    else if (instance.isType<sightline::PositionTrackArray>())
      add(topic, *messageOf<sightline::PositionTrackArray>(instance));
    else if (instance.isType<sightline::FusionReport>())
      add(topic, *messageOf<sightline::FusionReport>(instance));
    else if (instance.isType<sightline::PositionReport>())
      add(topic, *messageOf<sightline::PositionReport>(instance));
    else if (instance.isType<sightline::SightingArray>())
      add(topic, *messageOf<sightline::SightingArray>(instance));
  }

  void addPlace(const std::string& kind, const std::string& name, double time, double x, double y, double z) {
    scene_.stream() << field(kind) << ',' << field(name) << ',' << timeText(time) << ',' << number(x) << ','
                    << number(y) << ',' << number(z) << '\n';
  }

  /// Frame of the positions; empty without any.
  const std::string& metricFrame() const { return metric_frame_; }

  void finish() {
    for (const auto& [key, statistics] : windows_) writeWindow(key.first, key.second, statistics);
    for (const auto& [key, life] : lives_) {
      lives_file_.stream() << field(key.first) << ',' << key.second << ',' << timeText(life.first) << ','
                           << timeText(life.second) << '\n';
    }
    for (const auto& [key, values] : recorded_) {
      std::string all;
      for (const std::string& value : values) all += (all.empty() ? "" : ", ") + value;
      recorded_file_.stream() << field(key.first) << ',' << key.second << ',' << field(all) << '\n';
    }
    for (TextFile* file : {&innovations_, &lives_file_, &sensors_, &scene_, &recorded_file_}) file->finish();
  }

 private:
  using Key = std::pair<std::string, std::uint32_t>;  // topic and track

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
      if (isDue(topic + '\n' + std::to_string(track.id), time)) {
        addPlace(topic, std::to_string(track.id), time, track.position.x, track.position.y, track.position.z);
      }
    }
  }

  void add(const std::string& topic, const sightline::FusionReport& message) {
    const double time = message.header.stamp.toSec();
    for (const auto& track : message.tracks) {
      note(topic, "rule", track.rule);
      for (const auto& sensor : track.sensors)
        if (isDue(topic + '\n' + sensor.sensor, time)) write(topic, time, sensor);
      for (const auto& change : track.sensor_changes) write(topic, time, change);
    }
  }

  void add(const std::string& topic, const sightline::PositionReport& message) {
    const double time = message.header.stamp.toSec();
    for (const auto& station : message.stations) {
      if (!isDue(topic + '\n' + station.tracker + '\n' + station.sensor, time)) continue;
      sensors_.stream() << field(topic) << ',' << timeText(time) << ',' << field(station.sensor) << ",,,"
                        << number(station.clock_behind) << ',' << number(station.slow_scale) << ",\n";
    }
  }

  void add(const std::string& topic, const sightline::SightingArray& message) {
    note(topic, "sensor", message.sensor);
    note(topic, "frame", message.header.frame_id);
    if (std::isfinite(message.ifov)) note(topic, "ifov [rad]", number(message.ifov));
  }

  void write(const std::string& topic, double time, const sightline::SensorHealth& sensor) {
    sensors_.stream() << field(topic) << ',' << timeText(time) << ',' << field(sensor.sensor) << ','
                      << field(sensor.verdict) << ',' << number(sensor.noise_scale) << ','
                      << number(sensor.clock_behind) << ",," << field(sensor.reason) << '\n';
  }

  void writeWindow(const std::string& topic, std::int64_t index, const core::InnovationStatistics& window) {
    using core::Decision;
    innovations_.stream() << field(topic) << ',' << timeText((static_cast<double>(index) + 0.5) * window_)
                          << ',' << window.count(Decision::accepted) << ',' << number(window.nis());
    for (const Decision decision : {Decision::outside_gate, Decision::claimed_by_other,
                                    Decision::started_track, Decision::rejected_input})
      innovations_.stream() << ',' << window.count(decision);
    innovations_.stream() << '\n';
  }

  /// Values that follow each other are kept, up to a few.
  void note(const std::string& topic, const std::string& key, const std::string& value) {
    constexpr std::size_t kMost = 8;
    std::set<std::string>& values = recorded_[{topic, key}];
    if (!value.empty() && values.size() < kMost) values.insert(value);
  }

  void live(const std::string& topic, std::uint32_t track, double time) {
    auto [life, is_new] = lives_.try_emplace(Key{topic, track}, time, time);
    life->second.first = std::min(life->second.first, time);
    life->second.second = std::max(life->second.second, time);
  }

  /// Whether the series has not been written for a window. Time that goes back starts it anew.
  bool isDue(const std::string& series, double time) {
    const auto [last, is_new] = written_.try_emplace(series, time);
    if (!is_new && time >= last->second && time < last->second + window_) return false;
    last->second = time;
    return true;
  }

  double window_;  // [s]
  TextFile innovations_, lives_file_, sensors_, scene_, recorded_file_;
  std::map<std::pair<std::string, std::int64_t>, core::InnovationStatistics> windows_;
  std::map<Key, std::pair<double, double>> lives_;
  std::map<std::pair<std::string, std::string>, std::set<std::string>> recorded_;
  std::map<std::string, double> written_;
  std::string metric_frame_;
};

/// Where the stations are; of one that moves, its path.
void addStations(const rosbag::Bag& bag, const std::string& metric_frame, double begin, double end,
                 ReportData& data) {
  const RecordedStations found = recordedStationsOf(bag, metric_frame);
  RecordedTransforms transforms(bag);
  for (int i = 0; i <= kPlacesInTime; ++i) {
    const double time = begin + (end - begin) * i / kPlacesInTime;
    const ros::Time stamp(time);
    transforms.advanceTo(toCore(stamp));
    for (const RecordedStation& station : found.stations) {
      if (!isPoseKnown(station.frame, stamp, metric_frame, transforms.buffer())) continue;
      const auto origin = poseOf(station.frame, stamp, metric_frame, transforms.buffer()).origin;
      data.addPlace("station", station.name, time, origin.x(), origin.y(), origin.z());
    }
  }
}

/// How a recording was evaluated.
void writeSettings(const std::string& file, const std::vector<std::string>& truths,
                   const BagEvaluationSettings& settings) {
  const core::EvaluationParams& params = settings.evaluation;
  std::string all;
  for (const std::string& truth : truths) all += (all.empty() ? "" : ", ") + truth;
  TextFile text(settings.csv + "/settings.csv", {file});
  text.stream() << "key,value\nrecording," << field(file) << "\ntruth," << field(all) << "\nchannels,"
                << (params.channels == core::Channels::azimuth_only ? "azimuth" : "azimuth and elevation")
                << "\nsettle [s]," << number(params.settle_time) << "\ntruth gap [s],"
                << number(params.truth_gap) << "\nmatch gate [rad]," << number(params.match_gate)
                << "\nsighting gate [sigma]," << number(params.sighting_gate) << "\nsighting floor [rad],"
                << number(params.sighting_gate_floor) << "\nGOSPA c [rad]," << number(params.gospa.cutoff)
                << "\nGOSPA c [m]," << number(settings.positions.gospa_cutoff) << '\n';
  text.finish();
}

}  // namespace

void writeReportData(const rosbag::Bag& bag, const std::string& folder) {
  rosbag::View view(bag);
  const double begin = view.size() > 0 ? view.getBeginTime().toSec() : 0.0;
  const double end = view.size() > 0 ? view.getEndTime().toSec() : 0.0;
  ReportData data(folder, std::max((end - begin) / kWindows, kLeastWindow));
  for (const rosbag::MessageInstance& instance : view) data.add(instance);
  if (!data.metricFrame().empty()) addStations(bag, data.metricFrame(), begin, end, data);
  data.finish();
}

std::vector<std::string> truthTopicsOf(const rosbag::Bag& bag) {
  bool has_tracks = false, has_positions = false;
  rosbag::View view(bag);
  for (const rosbag::ConnectionInfo* connection : view.getConnections()) {
    if (connection->topic == kTruthTopic || connection->topic == kPositionTruthTopic) continue;
    if (connection->datatype == ros::message_traits::datatype<sightline::TrackArray>()) has_tracks = true;
    if (connection->datatype == ros::message_traits::datatype<sightline::PositionTrackArray>())
      has_positions = true;
  }
  if (has_positions && isPositionTopic(kPositionTruthTopic, bag)) return {kPositionTruthTopic};
  rosbag::View truth(bag, rosbag::TopicQuery(kTruthTopic));
  if (has_tracks && truth.size() > 0) return {kTruthTopic};
  return {};
}

std::string evaluateForReport(const std::string& file, const std::vector<std::string>& truths,
                              const BagEvaluationSettings& settings) {
  std::string tables;
  BagEvaluationSettings each = settings;
  if (truths.empty()) tables = evaluateBag(file, each);
  for (const std::string& truth : truths) {
    each.truth = truth;
    tables += (tables.empty() ? "" : "\n") + evaluateBag(file, each);
  }
  std::filesystem::create_directories(settings.csv);
  writeReportData(*openBag(file), settings.csv);
  writeSettings(file, truths, settings);
  TextFile console(settings.csv + "/console.txt", {file});
  console.stream() << tables;
  console.finish();
  return tables;
}

}  // namespace sightline_ros
