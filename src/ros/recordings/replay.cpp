#include "sightline/ros/recordings/replay.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include <ros/serialization.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sightline/FusionReport.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>
#include <sightline/TrackletArray.h>

#include "sightline/core/ordering/scan_queue.h"
#include "sightline/core/ordering/stamp_watch.h"
#include "sightline/ros/components/local_tracker_component.h"
#include "sightline/ros/components/track_fusion_component.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/params/param_reader.h"
#include "sightline/ros/recordings/bags.h"
#include "sightline/ros/recordings/recorded_transforms.h"

namespace sightline_ros {

namespace core = sightline::core;
using sightline::SightingArray;

namespace {

const char* const kFusedTracks = "/fusion/tracks";
const char* const kFusionReport = "/fusion/report";
const char* const kAllSensors = "";  // where a tracker is known by its sensor: the one over all sightings

/// The bytes of a message: what tells two scans of one sensor and instant apart.
std::string bytesOf(const SightingArray& scan) {
  std::string bytes(ros::serialization::serializationLength(scan), '\0');
  ros::serialization::OStream stream(reinterpret_cast<std::uint8_t*>(&bytes[0]),
                                     static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, scan);
  return bytes;
}

/// A topic's part for every sensor: its name where that can be one, otherwise something like it.
std::map<std::string, std::string> topicParts(const std::set<std::string>& sensors) {
  std::map<std::string, std::string> parts;
  std::set<std::string> taken = sensors;
  for (const std::string& sensor : sensors) {
    std::string part = sensor;
    for (char& letter : part) {
      if (!isTopicPart(std::string(1, letter))) letter = '_';
    }
    while (part != sensor && !taken.insert(part).second) part += '_';
    parts[sensor] = part;
  }
  return parts;
}

std::set<std::string> sensorsOf(const rosbag::Bag& bag) {
  std::set<std::string> sensors;
  rosbag::View view(bag, rosbag::TypeQuery(ros::message_traits::datatype<SightingArray>()));
  for (const rosbag::MessageInstance& instance : view) {
    const auto scan = instance.instantiate<SightingArray>();
    if (!scan)
      throw std::runtime_error(instance.getTopic() +
                               " was recorded with another definition of SightingArray");
    if (!complaintAbout(*scan)) sensors.insert(scan->sensor);
  }
  return sensors;
}

/// When a message with this stamp stands in the bag, which cannot hold 0.
ros::Time bagTime(const ros::Time& stamp) {
  return std::max(stamp, ros::TIME_MIN);
}

/// A local tracker and the topics it would publish on.
struct Tracker {
  LocalTrackerComponent component;
  std::string tracks;
  std::string tracklets;
  std::string associations;
};

ParamReader configurationOf(const ReplaySettings& settings) {
  return settings.config.empty() ? ParamReader(XmlRpc::XmlRpcValue(), "")
                                 : ParamReader::fromYaml(settings.config);
}

/// A section of the configuration, in which `choice` (empty = none) stands under `key`.
ParamReader sectionOf(const ParamReader& config, const std::string& name, const std::string& key,
                      const std::string& choice) {
  const ParamReader section = config.sub(name);
  return choice.empty() ? section : section.with(key, choice);
}

/// The fusion has an estimator, too.
ParamReader fusionSectionOf(const ParamReader& config, const ReplaySettings& settings) {
  const ParamReader section = sectionOf(config, "track_fusion", "rule", settings.rule);
  return settings.estimator.empty() ? section : section.with("estimator", settings.estimator);
}

using StampGate = core::StampGate<SightingArray::ConstPtr>;

/// One replay under way.
class Replay {
 public:
  Replay(const rosbag::Bag& in, rosbag::Bag& out, const ParamReader& config, const ReplaySettings& settings);

  ReplaySummary run();

 private:
  void addTracker(const std::string& sensor, const std::string& name, const std::string& space,
                  const ParamReader& section);
  void copy(const rosbag::MessageInstance& message);
  void take(const SightingArray::ConstPtr& scan, const ros::Time& received);
  void admit(const StampGate::Result& admitted);
  void enqueue(const SightingArray::ConstPtr& scan);
  void startAnew(core::Time time);
  void follow(const SightingArray::ConstPtr& scan);
  std::vector<TrackerReport> track(Tracker& tracker, const SightingArray::ConstPtr& scan);
  void fuse(const Tracker& tracker, const std::vector<TrackerReport>& reports);
  void sendOverdueTracklets(core::Time now);
  void sendTracklets(const Tracker& tracker, const sightline::TrackletArray& tracklets);
  void write(const Tracker& tracker, const TrackerReport& report);
  void writeTracklets(const Tracker& tracker, const sightline::TrackletArray& tracklets);
  void writeTracks(const std::string& topic, const sightline::TrackArray& tracks);

  const rosbag::Bag& in_;
  rosbag::Bag& out_;
  RecordedTransforms transforms_;
  std::map<std::string, Tracker> trackers_;  // by sensor; kAllSensors for the one over all sightings
  TrackFusionComponent fusion_;
  std::set<std::string> written_ = {kFusedTracks, kFusionReport};  // topics
  double max_lag_ = 0.0;                                           // [s]
  StampGate stamps_{core::StampWatchParams{}};
  core::ScanQueue<SightingArray::ConstPtr> queue_{0.0};
  double max_future_ = 0.0;  // [s]
  ReplaySummary summary_;
  std::optional<core::Time> first_, last_;  // stamps of scans
};

Replay::Replay(const rosbag::Bag& in, rosbag::Bag& out, const ParamReader& config,
               const ReplaySettings& settings)
    : in_(in), out_(out), transforms_(in), fusion_(fusionSectionOf(config, settings), "fusion") {
  for (const auto& [sensor, part] : topicParts(sensorsOf(in))) {
    addTracker(sensor, sensor, "/sensors/" + part,
               sectionOf(config, "local_tracker", "estimator", settings.estimator));
    if (part != sensor) summary_.topics[sensor] = "/sensors/" + part;
  }
  addTracker(kAllSensors, "sensor_fusion", "/sensor_fusion",
             sectionOf(config, "sensor_fusion", "estimator", settings.estimator));

  for (const auto& named : trackers_) {
    max_lag_ = std::max(max_lag_, named.second.component.maxLag());
    max_future_ = std::max(max_future_, named.second.component.maxFuture());
  }
  core::StampWatchParams stamps;
  stamps.max_lag = max_lag_;
  stamps_ = StampGate(stamps);
  queue_ = core::ScanQueue<SightingArray::ConstPtr>(max_lag_);
}

void Replay::addTracker(const std::string& sensor, const std::string& name, const std::string& space,
                        const ParamReader& section) {
  Tracker tracker{LocalTrackerComponent(section, name, transforms_.buffer()), space + "/tracks",
                  space + "/tracklets", space + "/associations"};
  written_.insert({tracker.tracks, tracker.tracklets, tracker.associations});
  trackers_.emplace(sensor, std::move(tracker));
}

ReplaySummary Replay::run() {
  rosbag::View view(in_);
  for (const rosbag::MessageInstance& message : view) {
    if (written_.count(message.getTopic()) == 0) copy(message);
    if (!message.isType<SightingArray>()) continue;
    take(message.instantiate<SightingArray>(), message.getTime());
    for (const auto& due : queue_.release()) follow(due);
  }
  admit(stamps_.finish());
  for (const auto& due : queue_.releaseAll()) follow(due);
  sendOverdueTracklets(core::Time::max());
  if (first_) summary_.recorded = core::seconds(*last_ - *first_);
  return summary_;
}

void Replay::copy(const rosbag::MessageInstance& message) {
  out_.write(message.getTopic(), message.getTime(), message, message.getConnectionHeader());
  ++summary_.copied_messages;
}

/// Queues a scan. What no tracker could use must not stir up the order of the others.
void Replay::take(const SightingArray::ConstPtr& scan, const ros::Time& received) {
  ++summary_.scans;
  summary_.sightings += scan->sightings.size();
  const core::Time stamp = toCore(scan->header.stamp);
  if (const auto complaint = complaintAbout(*scan)) {
    ++summary_.drops["recording: scan dropped, " + complaint->first];
  } else if (core::seconds(stamp - toCore(received)) > max_future_) {
    ++summary_.drops["recording: scan dropped, stamped more than max_future after it was received"];
  } else {
    admit(stamps_.take(scan->sensor, stamp, scan, toCore(received)));
  }
}

void Replay::admit(const StampGate::Result& admitted) {
  summary_.notices.insert(summary_.notices.end(), admitted.notices.begin(), admitted.notices.end());
  if (admitted.went_back) startAnew(toCore(admitted.passed.back().item->header.stamp));
  for (const StampGate::Passed& passed : admitted.passed) {
    if (!passed.refusal)
      enqueue(passed.item);
    else
      ++summary_.drops["recording: scan dropped, its stamp is ahead of the other sensors'"];
  }
}

void Replay::enqueue(const SightingArray::ConstPtr& scan) {
  const core::Time stamp = toCore(scan->header.stamp);
  if (!queue_.add({stamp, scan->sensor, bytesOf(*scan)}, scan)) {
    ++summary_.drops["recording: scan dropped, later than max_lag"];
    return;
  }
  first_ = std::min(first_.value_or(stamp), stamp);
  last_ = std::max(last_.value_or(stamp), stamp);
}

/// The stamps of the recording went back: what came before is followed to its end, then all is forgotten.
void Replay::startAnew(core::Time time) {
  for (const auto& due : queue_.releaseAll()) follow(due);
  sendOverdueTracklets(core::Time::max());
  queue_ = core::ScanQueue<SightingArray::ConstPtr>(max_lag_);
  transforms_.rewind();
  for (auto& named : trackers_) named.second.component.startAnew(time);
  fusion_.reset();
}

/// Scans come in order here.
void Replay::follow(const SightingArray::ConstPtr& scan) {
  sendOverdueTracklets(toCore(scan->header.stamp));
  Tracker& of_sensor = trackers_.at(scan->sensor);
  fuse(of_sensor, track(of_sensor, scan));
  track(trackers_.at(kAllSensors), scan);
}

std::vector<TrackerReport> Replay::track(Tracker& tracker, const SightingArray::ConstPtr& scan) {
  const core::Time stamp = toCore(scan->header.stamp);
  // A live tracker would have waited so long for the transform; here the wait costs nothing.
  const core::Time end_of_wait = stamp + core::durationOf(tracker.component.tfTimeout());
  transforms_.advanceTo(end_of_wait);
  std::vector<TrackerReport> reports = tracker.component.onScan(scan, stamp);
  for (auto& report : tracker.component.onTransforms(end_of_wait)) reports.push_back(std::move(report));
  for (const auto& report : reports) write(tracker, report);
  return reports;
}

void Replay::fuse(const Tracker& tracker, const std::vector<TrackerReport>& reports) {
  for (const auto& report : reports) {
    if (report.tracklets) sendTracklets(tracker, *report.tracklets);
    if (!report.tracks) continue;
    const FusionResult fused = fusion_.onTracks(*report.tracks, tracker.tracks, core::Time{});
    out_.write(kFusionReport, bagTime(report.tracks->header.stamp), fused.report);
    if (fused.tracks) writeTracks(kFusedTracks, *fused.tracks);
    if (!fused.refusal.empty()) {
      ++summary_.drops[fusion_.name() + ": " + fused.refusal.substr(0, fused.refusal.find(':'))];
    }
  }
}

/// By the clock, as a node would: those of trackers whose scans end or pause.
void Replay::sendOverdueTracklets(core::Time now) {
  for (auto& [sensor, tracker] : trackers_) {
    const auto overdue = tracker.component.overdueTracklets(now);
    if (!overdue) continue;
    writeTracklets(tracker, *overdue);
    if (sensor != kAllSensors) sendTracklets(tracker, *overdue);
  }
}

void Replay::sendTracklets(const Tracker& tracker, const sightline::TrackletArray& tracklets) {
  const std::string refusal = fusion_.onTracklets(tracklets, tracker.tracklets, core::Time{});
  if (!refusal.empty()) ++summary_.drops[fusion_.name() + ": " + refusal.substr(0, refusal.find(':'))];
}

void Replay::writeTracklets(const Tracker& tracker, const sightline::TrackletArray& tracklets) {
  out_.write(tracker.tracklets, bagTime(tracklets.header.stamp), tracklets);
}

void Replay::write(const Tracker& tracker, const TrackerReport& report) {
  const std::string& name = tracker.component.name();
  out_.write(tracker.associations, bagTime(report.scan->header.stamp), report.associations);
  if (!report.tracks) {
    ++summary_.drops[name + ": scan dropped, " + report.refusal->kind];
    return;
  }
  if (report.rejected > 0) summary_.drops[name + ": sightings rejected"] += report.rejected;
  if (report.tracklets) writeTracklets(tracker, *report.tracklets);
  writeTracks(tracker.tracks, *report.tracks);
}

void Replay::writeTracks(const std::string& topic, const sightline::TrackArray& tracks) {
  out_.write(topic, bagTime(tracks.header.stamp), tracks);
  ++summary_.track_messages;
}

}  // namespace

ReplaySummary replay(const std::string& in_file, const std::string& out_file,
                     const ReplaySettings& settings) {
  if (std::filesystem::weakly_canonical(in_file) == std::filesystem::weakly_canonical(out_file)) {
    throw std::runtime_error(in_file + " cannot be read and written at once: name another output");
  }
  const auto in = openBag(in_file);
  BagWriter out(out_file);
  const ParamReader config = configurationOf(settings);
  Replay replay(*in, *out, config, settings);
  config.finish();
  const ReplaySummary summary = replay.run();
  if (summary.scans == 0)
    throw std::runtime_error(in_file + ": there is no sightline/SightingArray message in it");
  out.finish();
  return summary;
}

}  // namespace sightline_ros
