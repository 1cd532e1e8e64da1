#include "sightline/ros/recordings/replay_rounds.h"

#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {

namespace core = sightline::core;
using sightline::SightingArray;

namespace {

std::vector<TrackerReport> track(ReplayTracker& tracker, const SightingArray::ConstPtr& scan) {
  std::vector<TrackerReport> reports = tracker.component.onScan(scan, toCore(scan->header.stamp));
  for (auto& report : tracker.component.onTransforms(endOfWait(tracker, scan)))
    reports.push_back(std::move(report));
  return reports;
}

}  // namespace

OverdueTracklets overdueOf(ReplayTrackers& trackers, core::Time now) {
  OverdueTracklets overdue;
  for (auto& [name, tracker] : trackers)
    if (auto tracklets = tracker.component.overdueTracklets(now))
      overdue.emplace_back(&tracker, std::move(tracklets));
  return overdue;
}

core::Time endOfWait(const ReplayTracker& tracker, const SightingArray::ConstPtr& scan) {
  return toCore(scan->header.stamp) + core::durationOf(tracker.component.tfTimeout());
}

void ReplayRounds::begin(const SightingArray::ConstPtr& scan, const std::string& topic,
                         ReplayTracker& of_sensor) {
  rounds_.push_back({std::make_unique<ReplayRound>(), {}});
  UnderWay& under_way = rounds_.back();
  ReplayRound* const round = under_way.round.get();
  round->scan = scan;
  round->topic = topic;
  round->of_sensor = &of_sensor;
  const std::shared_future<void> tracked = sensors_thread_.add([this, round] {
    if (fusion_ != nullptr)
      round->overdue_of_sensors = overdueOf(sensors_, toCore(round->scan->header.stamp));
    round->by_sensor = track(*round->of_sensor, round->scan);
  });
  under_way.tasks.push_back(tracked);
  if (fusion_ == nullptr) return;
  under_way.tasks.push_back(fusion_thread_.add([this, round, tracked] {
    tracked.get();
    fuse(*round);
  }));
}

void ReplayRounds::beginGroup(ReplayTracker& of_group) {
  UnderWay& under_way = rounds_.back();
  ReplayRound* const round = under_way.round.get();
  round->of_group = &of_group;
  under_way.tasks.push_back(groups_thread_.add([this, round] {
    if (fusion_ != nullptr) round->overdue_of_groups = overdueOf(groups_, toCore(round->scan->header.stamp));
    round->by_group = track(*round->of_group, round->scan);
  }));
}

/// What the trackers of the sensors said in this round.
void ReplayRounds::fuse(ReplayRound& round) {
  const auto take = [&](const ReplayTracker& tracker, const sightline::TrackletArray& tracklets) {
    FusionResult result;
    result.refusal = fusion_->onTracklets(tracklets, tracker.topics.tracklets, core::Time{});
    if (result.refusal) round.fused.emplace_back(std::move(result), tracklets.header.stamp);
  };
  for (const auto& [tracker, tracklets] : round.overdue_of_sensors) take(*tracker, *tracklets);
  for (const TrackerReport& report : round.by_sensor) {
    if (report.tracklets) take(*round.of_sensor, *report.tracklets);
    if (!report.tracks) continue;
    round.fused.emplace_back(fusion_->onTracks(*report.tracks, round.of_sensor->topics.tracks, core::Time{}),
                             report.tracks->header.stamp);
  }
}

void ReplayRounds::waitForAll() {
  for (const UnderWay& under_way : rounds_)
    for (const std::shared_future<void>& task : under_way.tasks) task.get();
}

std::unique_ptr<ReplayRound> ReplayRounds::takeFirst() {
  for (const std::shared_future<void>& task : rounds_.front().tasks) task.get();
  std::unique_ptr<ReplayRound> round = std::move(rounds_.front().round);
  rounds_.pop_front();
  return round;
}

}  // namespace sightline_ros
