#include "sightline/ros/recordings/replay.h"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include <rosbag/bag.h>
#include <rosbag/view.h>

#include "sightline/report/value_text.h"
#include "sightline/ros/components/position_tracker_component.h"
#include "sightline/ros/components/track_fusion_component.h"
#include "sightline/ros/diagnosis/input_examination.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/params/param_reader.h"
#include "sightline/ros/recordings/bags.h"
#include "sightline/ros/recordings/recorded_scans.h"
#include "sightline/ros/recordings/recorded_stations.h"
#include "sightline/ros/recordings/recorded_transforms.h"
#include "sightline/ros/recordings/replay_output.h"
#include "sightline/ros/recordings/replay_parameters.h"
#include "sightline/ros/recordings/replay_rounds.h"
#include "sightline/ros/recordings/smoothed_positions.h"
#include "sightline/ros/recordings/smoothed_tracks.h"

namespace sightline_ros {

namespace core = sightline::core;
using sightline::SightingArray;

namespace {

const char* const kAllSensors = "";  // group of the tracker over all sightings

/// The trackers, and the fusion or the position tracker, of one replay: scans in, messages out.
class Replay {
 public:
  /// `survey`: of the recording `in`.
  Replay(const rosbag::Bag& in, const RecordingSurvey& survey, rosbag::Bag& out, const ParamReader& config,
         const ReplaySettings& settings);

  ReplaySummary run(const rosbag::Bag& in);

 private:
  ReplayTracker trackerOf(const std::string& name, const std::string& space, const ParamReader& section);
  void addFusion(const std::set<std::string>& sensors, const ParamReader& config,
                 const ReplaySettings& settings);
  void addStations(const RecordedStations& found, const std::set<std::string>& sensors,
                   const ParamReader& config, const ReplaySettings& settings);
  template <typename Do>
  void withEachTracker(const Do& action);
  const std::string& commonFrame() const;
  RecordedOrder orderOfScans();
  void follow(const DueScans& due);
  void startAnew(core::Time time);
  void follow(const SightingArray::ConstPtr& scan);
  void finishRounds(std::size_t most);
  void note(const ReplayRound& round);
  void note(ReplayTracker& tracker, const std::vector<TrackerReport>& reports);
  void note(const OverdueTracklets& overdue);
  void locate(const ReplayTracker& tracker, const std::vector<TrackerReport>& reports);
  void writeSmoothed();
  void sendOverdueTracklets(core::Time now);
  void send(const OverdueTracklets& overdue);
  void sendTracklets(const ReplayTracker& tracker, const sightline::TrackletArray& tracklets);
  void locate(const sightline::TrackArray::ConstPtr& tracks, const std::string& topic);
  void fuseWaiting();
  void note(const FusionResult& fused, const ros::Time& stamp);
  void note(const std::vector<PositionResult>& results);
  void noteRefusal(const std::optional<core::Refusal>& refusal);
  void noteLeftOut(const core::FusionReport& report);

  bool is_live_;
  bool smooths_;
  std::optional<double> lag_;  // of the smoother [s]
  std::string parameters_;
  bool has_positions_ = false;
  core::ArrivalPlan arrivals_;
  ReplaySummary summary_;
  ReplayOutput output_;
  RecordedTransforms transforms_;
  ReplayTrackers trackers_;                              // by sensor
  ReplayTrackers groups_;                                // over several sensors, by the group's name
  std::map<std::string, std::string> group_of_;          // by sensor; sensors that are alone have none
  TrackFusionComponent fusion_;                          // without positions
  PositionTrackerComponent positions_;                   // with positions
  std::optional<SmoothedPositions> smoothed_positions_;  // where they are to be smoothed
  InputExamination examination_;
  std::map<std::string, std::string> topics_;  // of the scans, by sensor
  std::optional<ReplayRounds> rounds_;         // never empty; the last: it uses the others
};

Replay::Replay(const rosbag::Bag& in, const RecordingSurvey& survey, rosbag::Bag& out,
               const ParamReader& config, const ReplaySettings& settings)
    : is_live_(settings.live),
      smooths_(settings.smooth),
      lag_(settings.lag),
      parameters_(parametersText(settings)),
      arrivals_(survey.arrivals),
      output_(out, summary_, settings.topics, settings.all),
      transforms_(in, is_live_ ? KnownTransforms::up_to_time : KnownTransforms::one_further),
      fusion_(fusionSectionOf(config, settings), "fusion", &transforms_.buffer()),
      positions_(config.sub("position_tracker"), "positions", transforms_.buffer()) {
  const RecordedStations found = recordedStationsOf(in, positions_.trackingFrame());
  for (const RecordedStation& station : found.stations)
    for (const std::string& sensor : station.sensors) fusion_.places()->setFrame(sensor, station.frame);
  has_positions_ = settings.positions.value_or(found.standApart());
  if (has_positions_ && smooths_) {
    positions_.keepMeasurements();
    smoothed_positions_.emplace(positions_.estimatorParams(), lag_);
  }
  if (has_positions_)
    addStations(found, survey.sensors, config, settings);
  else
    addFusion(survey.sensors, config, settings);
  rounds_.emplace(trackers_, groups_, has_positions_ ? nullptr : &fusion_);
}

/// Directions from one place: a tracker for each sensor, and one over all of them.
void Replay::addFusion(const std::set<std::string>& sensors, const ParamReader& config,
                       const ReplaySettings& settings) {
  const ParamReader local = sectionOf(config, "local_tracker", "estimator", settings.estimator);
  for (const auto& [sensor, part] : topicPartsOf(sensors)) {
    ReplayTracker tracker = trackerOf(sensor, "/sensors/" + part, local);
    tracker.is_used = true;
    trackers_.emplace(sensor, std::move(tracker));
    group_of_[sensor] = kAllSensors;
    if (part != sensor) summary_.topics[sensor] = "/sensors/" + part;
  }
  groups_.emplace(kAllSensors,
                  trackerOf("sensor_fusion", "/sensor_fusion",
                            sectionOf(config, "sensor_fusion", "estimator", settings.estimator)));
  output_.slowDown(groups_.at(kAllSensors).topics);
}

/// Directions from several places: all trackers of a station track in its frame.
void Replay::addStations(const RecordedStations& found, const std::set<std::string>& sensors,
                         const ParamReader& config, const ReplaySettings& settings) {
  output_.replacePositions();
  // Also where no station has several sensors: what is wrong in that section is said.
  static_cast<void>(LocalTrackerComponent(sectionOf(config, "sensor_fusion", "estimator", settings.estimator),
                                          "sensor_fusion", transforms_.buffer()));
  const auto parts = topicPartsOf(sensors);
  for (const RecordedStation& station : found.stations) {
    const ParamReader local = sectionOf(config, "local_tracker", "estimator", settings.estimator)
                                  .with("tracking_frame", XmlRpc::XmlRpcValue(station.frame));
    for (const std::string& sensor : station.sensors) {
      const std::string space = "/sensors/" + parts.at(sensor);
      ReplayTracker tracker = trackerOf(sensor, space, local);
      tracker.is_used = station.sensors.size() == 1;
      trackers_.emplace(sensor, std::move(tracker));
      if (parts.at(sensor) != sensor) summary_.topics[sensor] = space;
      if (station.sensors.size() > 1) group_of_[sensor] = station.name;
    }
    if (station.sensors.size() == 1) continue;
    const ParamReader all = sectionOf(config, "sensor_fusion", "estimator", settings.estimator)
                                .with("tracking_frame", XmlRpc::XmlRpcValue(station.frame));
    ReplayTracker group = trackerOf("station " + station.name, "/stations/" + parts.at(station.name), all);
    group.is_used = true;
    groups_.emplace(station.name, std::move(group));
  }
  summary_.notices.push_back(std::to_string(found.stations.size()) + " stations stand up to " +
                             sightline::report::valueOf(found.apart, "m") +
                             " apart: positions on /positions/tracks, directions are not fused");
}

ReplayTracker Replay::trackerOf(const std::string& name, const std::string& space,
                                const ParamReader& section) {
  ReplayTracker tracker{LocalTrackerComponent(section, name, transforms_.buffer()), TrackerTopics(space), {}};
  if (smooths_) {
    tracker.component.keepSightings();
    tracker.smoothed.emplace(tracker.component.estimatorParams(), lag_);
  }
  output_.replace(tracker.topics);
  return tracker;
}

template <typename Do>
void Replay::withEachTracker(const Do& action) {
  for (auto& [name, tracker] : groups_) action(tracker);
  for (auto& [sensor, tracker] : trackers_) action(tracker);
}

/// In which all sensors can be compared.
const std::string& Replay::commonFrame() const {
  return has_positions_ ? positions_.trackingFrame() : groups_.at(kAllSensors).component.trackingFrame();
}

RecordedOrder Replay::orderOfScans() {
  double max_lag = 0.0, max_future = 0.0;  // [s]
  withEachTracker([&](const ReplayTracker& tracker) {
    max_lag = std::max(max_lag, tracker.component.maxLag());
    max_future = std::max(max_future, tracker.component.maxFuture());
  });
  return is_live_ ? liveOrder(max_lag, max_future) : orderInHindsight(max_lag, max_future, arrivals_);
}

ReplaySummary Replay::run(const rosbag::Bag& in) {
  RecordedScans scans(orderOfScans(), summary_);
  rosbag::View view(in);
  output_.writeParameters(parameters_, view.getBeginTime());
  for (const rosbag::MessageInstance& message : view) {
    output_.copy(message);
    if (!message.isType<SightingArray>()) continue;
    const auto scan = messageIn<SightingArray>(message);
    topics_[scan->sensor] = message.getTopic();
    follow(scans.take(scan, message.getTime()));
  }
  for (DueScans due = scans.finish();; due = scans.finish()) {
    follow(due);
    if (!due.restart) break;
  }
  finishRounds(0);
  sendOverdueTracklets(core::Time::max());
  fuseWaiting();
  writeSmoothed();
  output_.noteUnwritten();
  InputLimits limits;
  limits.stand_apart = has_positions_;
  summary_.findings = examination_.findings(transforms_.buffer(), commonFrame(), limits);
  return summary_;
}

void Replay::follow(const DueScans& due) {
  for (const auto& scan : due.before_restart) follow(scan);
  if (due.restart) startAnew(*due.restart);
  for (const auto& scan : due.scans) follow(scan);
}

/// The stamps of the recording went back: trackers, fusion and positions forget everything.
void Replay::startAnew(core::Time time) {
  finishRounds(0);
  sendOverdueTracklets(core::Time::max());
  fuseWaiting();
  transforms_.rewind();
  withEachTracker([time](ReplayTracker& tracker) { tracker.component.startAnew(time); });
  fusion_.reset();
  if (smoothed_positions_) smoothed_positions_->keep(positions_.openMeasurements());
  positions_.reset();
}

/// Rounds before this one may be under way, unless transforms come or positions, which wait for transforms.
void Replay::follow(const SightingArray::ConstPtr& scan) {
  ReplayTracker& of_sensor = trackers_.at(scan->sensor);
  const auto group = group_of_.find(scan->sensor);
  ReplayTracker* const of_group = group == group_of_.end() ? nullptr : &groups_.at(group->second);
  const bool group_waits_otherwise =
      of_group != nullptr && of_group->component.tfTimeout() != of_sensor.component.tfTimeout();
  const core::Time end_of_wait = endOfWait(of_sensor, scan);
  if (has_positions_ || group_waits_otherwise || transforms_.bringsAny(end_of_wait)) finishRounds(0);
  if (has_positions_) sendOverdueTracklets(toCore(scan->header.stamp));
  transforms_.advanceTo(end_of_wait);
  rounds_->begin(scan, topics_[scan->sensor], of_sensor);
  if (group_waits_otherwise) {
    rounds_->waitForAll();
    transforms_.advanceTo(endOfWait(*of_group, scan));
  }
  if (of_group != nullptr) rounds_->beginGroup(*of_group);
  finishRounds(has_positions_ || group_waits_otherwise ? 0 : ReplayRounds::kMost);
}

/// Until no more than `most` are under way. When a round is written does not depend on how fast the threads
/// are.
void Replay::finishRounds(std::size_t most) {
  while (rounds_->count() > most) note(*rounds_->takeFirst());
}

void Replay::note(const ReplayRound& round) {
  examination_.take(*round.scan, round.topic, "", core::Time{});
  note(round.overdue_of_groups);
  note(round.overdue_of_sensors);
  note(*round.of_sensor, round.by_sensor);
  for (const auto& [fused, stamp] : round.fused) note(fused, stamp);
  if (has_positions_) locate(*round.of_sensor, round.by_sensor);
  if (round.of_group != nullptr) {
    note(*round.of_group, round.by_group);
    if (has_positions_) locate(*round.of_group, round.by_group);
  }
  examination_.turn(transforms_.buffer(), commonFrame());
}

void Replay::note(const OverdueTracklets& overdue) {
  for (const auto& [tracker, tracklets] : overdue) output_.write(*tracklets, tracker->topics);
}

void Replay::note(ReplayTracker& tracker, const std::vector<TrackerReport>& reports) {
  for (const auto& report : reports) {
    output_.write(report, tracker.component.name(), tracker.topics);
    if (tracker.smoothed) tracker.smoothed->keep(report);
    examination_.take(*report.associations, tracker.topics.associations);
    if (report.tracks) examination_.take(*report.tracks, tracker.topics.tracks);
  }
}

/// What a tracker says goes to the tracker of positions.
void Replay::locate(const ReplayTracker& tracker, const std::vector<TrackerReport>& reports) {
  if (!tracker.is_used) return;
  for (const TrackerReport& report : reports) {
    if (report.tracklets) sendTracklets(tracker, *report.tracklets);
    if (report.tracks) locate(report.tracks, tracker.topics.tracks);
  }
}

/// Reports that waited for others at the recording's end, or before its stamps go back.
void Replay::fuseWaiting() {
  if (const auto fused = fusion_.fuseWaiting())
    note(*fused, fused->tracks ? fused->tracks->header.stamp : ros::Time());
}

void Replay::note(const FusionResult& fused, const ros::Time& stamp) {
  noteRefusal(fused.refusal);
  if (!fused.report) return;
  output_.write(fused, stamp);
  noteLeftOut(*fused.fused);
}

/// One tracker after the other: what has been smoothed need not be kept.
void Replay::writeSmoothed() {
  withEachTracker([this](ReplayTracker& tracker) {
    if (!tracker.smoothed) return;
    output_.writeSmoothed(tracker.smoothed->smooth(), tracker.topics);
    tracker.smoothed.reset();
  });
  if (!smoothed_positions_) return;
  smoothed_positions_->keep(positions_.openMeasurements());
  output_.writeSmoothed(smoothed_positions_->smooth());
}

void Replay::sendOverdueTracklets(core::Time now) {
  send(overdueOf(groups_, now));
  send(overdueOf(trackers_, now));
}

void Replay::send(const OverdueTracklets& overdue) {
  note(overdue);
  for (const auto& [tracker, tracklets] : overdue) sendTracklets(*tracker, *tracklets);
}

void Replay::sendTracklets(const ReplayTracker& tracker, const sightline::TrackletArray& tracklets) {
  if (!tracker.is_used) return;
  if (!has_positions_)
    return noteRefusal(fusion_.onTracklets(tracklets, tracker.topics.tracklets, core::Time{}));
  note(positions_.onTracklets(boost::make_shared<sightline::TrackletArray>(tracklets),
                              tracker.topics.tracklets, toCore(tracklets.header.stamp)));
}

void Replay::locate(const sightline::TrackArray::ConstPtr& tracks, const std::string& topic) {
  const core::Time stamp = toCore(tracks->header.stamp);
  note(positions_.onTracks(tracks, topic, stamp));
  // A live node would have waited until then for the transform; here the wait costs nothing.
  const core::Time end_of_wait = stamp + core::durationOf(positions_.tfTimeout());
  transforms_.advanceTo(end_of_wait);
  note(positions_.onTransforms(end_of_wait));
}

void Replay::note(const std::vector<PositionResult>& results) {
  for (const PositionResult& result : results) {
    output_.write(result);
    if (smoothed_positions_) smoothed_positions_->keep(result);
    if (!result.notice.empty()) summary_.notices.push_back(positions_.name() + ": " + result.notice);
    for (const core::Refusal& refusal : result.refusals)
      summary_.noteDrop(positions_.name() + ": " + refusal.kind, refusal.detail);
  }
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
