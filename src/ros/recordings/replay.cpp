#include "sightline/ros/recordings/replay.h"

#include <algorithm>
#include <iomanip>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <rosbag/bag.h>
#include <rosbag/view.h>

#include "sightline/ros/components/local_tracker_component.h"
#include "sightline/ros/components/track_fusion_component.h"
#include "sightline/ros/diagnosis/input_examination.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/params/param_reader.h"
#include "sightline/ros/recordings/bags.h"
#include "sightline/ros/recordings/recorded_scans.h"
#include "sightline/ros/recordings/recorded_transforms.h"
#include "sightline/ros/recordings/replay_output.h"

namespace sightline_ros {

namespace core = sightline::core;
using sightline::SightingArray;

namespace {

const char* const kAllSensors = "";  // key of the tracker over all sightings, among those by sensor

/// A local tracker, and where its messages go.
struct Tracker {
  LocalTrackerComponent component;
  TrackerTopics topics;
};

ParamReader configurationOf(const ReplaySettings& settings) {
  return settings.config.empty() ? ParamReader(XmlRpc::XmlRpcValue(), "")
                                 : ParamReader::fromYaml(settings.config);
}

/// A section of the configuration with `choice` (empty = none) under `key`.
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

/// The trackers and the fusion of one replay: scans in, messages out.
class Replay {
 public:
  /// `survey`: of the recording `in`.
  Replay(const rosbag::Bag& in, const RecordingSurvey& survey, rosbag::Bag& out, const ParamReader& config,
         const ReplaySettings& settings);

  ReplaySummary run(const rosbag::Bag& in);

 private:
  void addTracker(const std::string& sensor, const std::string& name, const std::string& space,
                  const ParamReader& section);
  RecordedOrder orderOfScans() const;
  void follow(const DueScans& due);
  void startAnew(core::Time time);
  void follow(const SightingArray::ConstPtr& scan);
  std::vector<TrackerReport> track(Tracker& tracker, const SightingArray::ConstPtr& scan);
  void fuse(const Tracker& tracker, const std::vector<TrackerReport>& reports);
  void sendOverdueTracklets(core::Time now);
  void sendTracklets(const Tracker& tracker, const sightline::TrackletArray& tracklets);
  void noteRefusal(const std::optional<core::Refusal>& refusal);
  void noteLeftOut(const core::FusionReport& report);

  bool is_live_;
  core::ArrivalPlan arrivals_;
  ReplaySummary summary_;
  ReplayOutput output_;
  RecordedTransforms transforms_;
  std::map<std::string, Tracker> trackers_;  // by sensor; kAllSensors for the one over all sightings
  TrackFusionComponent fusion_;
  InputExamination examination_;
  std::map<std::string, std::string> topics_;  // of the scans, by sensor
};

Replay::Replay(const rosbag::Bag& in, const RecordingSurvey& survey, rosbag::Bag& out,
               const ParamReader& config, const ReplaySettings& settings)
    : is_live_(settings.live),
      arrivals_(survey.arrivals),
      output_(out, summary_),
      transforms_(in, is_live_ ? KnownTransforms::up_to_time : KnownTransforms::one_further),
      fusion_(fusionSectionOf(config, settings), "fusion") {
  for (const auto& [sensor, part] : topicPartsOf(survey.sensors)) {
    addTracker(sensor, sensor, "/sensors/" + part,
               sectionOf(config, "local_tracker", "estimator", settings.estimator));
    if (part != sensor) summary_.topics[sensor] = "/sensors/" + part;
  }
  addTracker(kAllSensors, "sensor_fusion", "/sensor_fusion",
             sectionOf(config, "sensor_fusion", "estimator", settings.estimator));
}

void Replay::addTracker(const std::string& sensor, const std::string& name, const std::string& space,
                        const ParamReader& section) {
  Tracker tracker{LocalTrackerComponent(section, name, transforms_.buffer()), TrackerTopics(space)};
  output_.replace(tracker.topics);
  trackers_.emplace(sensor, std::move(tracker));
}

RecordedOrder Replay::orderOfScans() const {
  double max_lag = 0.0, max_future = 0.0;  // [s]
  for (const auto& [sensor, tracker] : trackers_) {
    max_lag = std::max(max_lag, tracker.component.maxLag());
    max_future = std::max(max_future, tracker.component.maxFuture());
  }
  return is_live_ ? liveOrder(max_lag, max_future) : orderInHindsight(max_lag, max_future, arrivals_);
}

ReplaySummary Replay::run(const rosbag::Bag& in) {
  RecordedScans scans(orderOfScans(), summary_);
  rosbag::View view(in);
  for (const rosbag::MessageInstance& message : view) {
    output_.copy(message);
    if (!message.isType<SightingArray>()) continue;
    const auto scan = message.instantiate<SightingArray>();
    topics_[scan->sensor] = message.getTopic();
    follow(scans.take(scan, message.getTime()));
  }
  for (DueScans due = scans.finish();; due = scans.finish()) {
    follow(due);
    if (!due.restart) break;
  }
  sendOverdueTracklets(core::Time::max());
  summary_.findings = examination_.findings(
      transforms_.buffer(), trackers_.at(kAllSensors).component.trackingFrame(), InputLimits{});
  return summary_;
}

void Replay::follow(const DueScans& due) {
  for (const auto& scan : due.before_restart) follow(scan);
  if (due.restart) startAnew(*due.restart);
  for (const auto& scan : due.scans) follow(scan);
}

/// The stamps of the recording went back: the trackers and the fusion forget everything.
void Replay::startAnew(core::Time time) {
  sendOverdueTracklets(core::Time::max());
  transforms_.rewind();
  for (auto& [sensor, tracker] : trackers_) tracker.component.startAnew(time);
  fusion_.reset();
}

void Replay::follow(const SightingArray::ConstPtr& scan) {
  sendOverdueTracklets(toCore(scan->header.stamp));
  Tracker& of_sensor = trackers_.at(scan->sensor);
  Tracker& of_all = trackers_.at(kAllSensors);
  examination_.take(*scan, topics_[scan->sensor], "", core::Time{});
  fuse(of_sensor, track(of_sensor, scan));
  track(of_all, scan);
  examination_.turn(transforms_.buffer(), of_all.component.trackingFrame());
}

std::vector<TrackerReport> Replay::track(Tracker& tracker, const SightingArray::ConstPtr& scan) {
  const core::Time stamp = toCore(scan->header.stamp);
  // A live tracker would have waited until then for the transform; here the wait costs nothing.
  const core::Time end_of_wait = stamp + core::durationOf(tracker.component.tfTimeout());
  transforms_.advanceTo(end_of_wait);
  std::vector<TrackerReport> reports = tracker.component.onScan(scan, stamp);
  for (auto& report : tracker.component.onTransforms(end_of_wait)) reports.push_back(std::move(report));
  for (const auto& report : reports) {
    output_.write(report, tracker.component.name(), tracker.topics);
    examination_.take(*report.associations, tracker.topics.associations);
    if (report.tracks) examination_.take(*report.tracks, tracker.topics.tracks);
  }
  return reports;
}

void Replay::fuse(const Tracker& tracker, const std::vector<TrackerReport>& reports) {
  for (const auto& report : reports) {
    if (report.tracklets) sendTracklets(tracker, *report.tracklets);
    if (!report.tracks) continue;
    const FusionResult fused = fusion_.onTracks(*report.tracks, tracker.topics.tracks, core::Time{});
    output_.write(fused, report.tracks->header.stamp);
    noteRefusal(fused.refusal);
    noteLeftOut(*fused.fused);
  }
}

/// As a node would by its clock: for trackers whose scans end or pause.
void Replay::sendOverdueTracklets(core::Time now) {
  for (auto& [sensor, tracker] : trackers_) {
    const auto overdue = tracker.component.overdueTracklets(now);
    if (!overdue) continue;
    output_.write(*overdue, tracker.topics);
    if (sensor != kAllSensors) sendTracklets(tracker, *overdue);
  }
}

void Replay::sendTracklets(const Tracker& tracker, const sightline::TrackletArray& tracklets) {
  noteRefusal(fusion_.onTracklets(tracklets, tracker.topics.tracklets, core::Time{}));
}

void Replay::noteRefusal(const std::optional<core::Refusal>& refusal) {
  if (refusal) summary_.noteDrop(fusion_.name() + ": " + refusal->kind, refusal->detail);
}

/// Local tracks that found no room in the fusion.
void Replay::noteLeftOut(const core::FusionReport& report) {
  for (const core::SourceTrack& track : report.left_out) {
    if (track.reason->kind != "limit") continue;
    summary_.noteDrop(fusion_.name() + ": local tracks left out, limit", track.reason->detail);
  }
}

}  // namespace

void ReplaySummary::noteDrop(const std::string& reason, const std::string& example, std::size_t count) {
  drops[reason] += count;
  if (!example.empty()) examples.try_emplace(reason, example);
}

std::string exampleOf(const SightingArray& scan, const std::string& detail) {
  if (detail.empty()) return "";
  std::ostringstream words;
  words << "of " << scan.sensor << " at " << std::fixed << std::setprecision(3) << scan.header.stamp.toSec()
        << " s in frame \"" << scan.header.frame_id << "\": " << detail;
  return words.str();
}

ReplaySummary replay(const std::string& in_file, const std::string& out_file,
                     const ReplaySettings& settings) {
  const auto in = openBag(in_file);
  const ParamReader config = configurationOf(settings);
  ReplaySummary summary;
  writeBag(out_file, {in_file, settings.config}, [&](rosbag::Bag& out) {
    Replay replay(*in, surveyOf(*in), out, config, settings);
    config.finish();
    summary = replay.run(*in);
    if (summary.scans == 0)
      throw std::runtime_error(in_file + ": there is no sightline/SightingArray message in it");
  });
  return summary;
}

}  // namespace sightline_ros
