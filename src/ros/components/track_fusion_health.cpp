#include "sightline/ros/components/track_fusion_health.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include <diagnostic_msgs/DiagnosticStatus.h>

#include "sightline/ros/diagnosis/refusals.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {

namespace core = sightline::core;
using diagnostic_msgs::DiagnosticStatus;

namespace {

constexpr std::size_t kMostTrackers = 256;
constexpr std::size_t kMostFusedSensors = 256;  // of which changes are told

/// Reasons for leaving a local track out that need somebody's hand; the others are a tracker's daily life.
const std::set<std::string> kCallForHelp{"invalid", "limit", "shared sensor", "too uncertain",
                                         "undetermined"};

}  // namespace

TrackFusionHealth::TrackFusionHealth(const std::vector<std::string>& topics, double silence)
    : silence_(silence) {
  for (const std::string& topic : topics) sources_[topic];
}

void TrackFusionHealth::note(const sightline::TrackArray& local, const std::string& topic,
                             const FusionResult& result) {
  if (result.refusal) return noteFusion(result);
  Source& source = sources_[topic];
  ++source.messages;
  source.tracker = local.tracker;
  source.tracks = local.tracks.size();
  source.newest = toCore(local.header.stamp);
  noteFusion(result);
}

void TrackFusionHealth::noteFusion(const FusionResult& result) {
  if (result.refusal) complain(*result.refusal);
  if (!result.tracks) return;
  tracks_.fill(0);
  for (const auto& track : result.tracks->tracks) {
    if (track.status < tracks_.size()) ++tracks_[track.status];
  }
  left_out_.clear();
  rules_.clear();
  why_not_tracklets_.clear();
  sensors_.clear();
  harmful_.clear();
  for (const auto& track : result.report->tracks) {
    noteSensors(track);
    ++rules_[track.rule];
    if (!track.why_not_tracklets.empty()) why_not_tracklets_ = track.why_not_tracklets;
  }
  for (const core::FusedTrack& track : result.fused->tracks) noteLeftOut(track.left_out);
  noteLeftOut(result.fused->left_out);
}

/// A sensor of several tracks is shown with the worst that is thought of it.
void TrackFusionHealth::noteSensors(const sightline::FusedTrack& track) {
  for (const auto& sensor : track.sensors) {
    const std::string words = "track " + std::to_string(track.id) + ": " + sensor.reason;
    if (sensor.verdict != "healthy" || std::isfinite(sensor.clock_behind)) {
      harmful_.emplace(sensor.sensor, words);
    } else {
      sensors_.emplace(sensor.sensor, words);
    }
  }
  for (const auto& [sensor, words] : harmful_) sensors_[sensor] = words;
}

std::vector<std::string> TrackFusionHealth::sensorLines(const FusionResult& result, core::Time now) {
  std::vector<std::string> lines;
  if (!result.report) return lines;
  for (const auto& track : result.report->tracks) {
    for (const auto& change : track.sensor_changes) {
      if (changes_.size() >= kMostFusedSensors && changes_.count(change.sensor) == 0) continue;
      Changes& changes = changes_[change.sensor];
      const bool was_lately = changes.last_line && now >= *changes.last_line &&
                              core::seconds(now - *changes.last_line) < kSecondsBetweenWarnings;
      if (was_lately && change.verdict != "healthy") {
        ++changes.held_back;
        continue;
      }
      std::ostringstream line;
      line << "track " << track.id << ": " << change.reason;
      if (changes.held_back > 0) line << " (" << changes.held_back << " changes before not shown)";
      lines.push_back(line.str());
      changes = {0, now};
    }
  }
  return lines;
}

void TrackFusionHealth::noteTracklets(const sightline::TrackletArray& local,
                                      const std::optional<core::Refusal>& refusal, std::size_t late) {
  if (refusal) complain(*refusal);
  if (tracklets_.size() < kMostTrackers || tracklets_.count(local.tracker) > 0)
    tracklets_[local.tracker] += local.tracklets.size();
  late_tracklets_ = late;
}

void TrackFusionHealth::noteFailures(const core::TrackletFailures& failures) {
  if (failures.count > failed_tracklets_) complain({"failed", failures.latest});
  failed_tracklets_ = failures.count;
}

void TrackFusionHealth::noteLeftOut(const std::vector<core::SourceTrack>& rows) {
  for (const core::SourceTrack& row : rows) {
    if (!row.reason) continue;
    ++left_out_[row.reason->kind];
    if (kCallForHelp.count(row.reason->kind) == 0) continue;
    std::ostringstream detail;
    detail << row.reason->detail << " (track " << row.id << " of \"" << row.tracker << "\")";
    complain({row.reason->kind, detail.str()});
  }
}

void TrackFusionHealth::complain(const core::Refusal& reason) {
  Complaint& complaint = complaints_[reason.kind];
  ++complaint.count;
  complaint.latest = reason.detail;
}

std::vector<std::string> TrackFusionHealth::warnings(core::Time now) {
  std::vector<std::string> lines;
  for (auto& [kind, complaint] : complaints_) {
    if (complaint.count == complaint.count_warned) continue;
    const bool was_lately = complaint.last_warning && now >= *complaint.last_warning &&
                            core::seconds(now - *complaint.last_warning) < kSecondsBetweenWarnings;
    if (was_lately) continue;
    std::ostringstream line;
    line << core::textOf({kind, complaint.latest}) << " (" << complaint.count - complaint.count_warned
         << " new, " << complaint.count << " in all)";
    lines.push_back(line.str());
    complaint.last_warning = now;
    complaint.count_warned = complaint.count;
  }
  return lines;
}

void TrackFusionHealth::diagnose(core::Time now, diagnostic_updater::DiagnosticStatusWrapper& status) {
  summarize(now, status);
  status.add("global tracks confirmed", tracks_[sightline::Track::CONFIRMED]);
  status.add("global tracks coasting", tracks_[sightline::Track::COASTING]);

  const double elapsed = last_diagnosis_ ? core::seconds(now - *last_diagnosis_) : 0.0;
  for (auto& [topic, source] : sources_) {
    const auto fresh = static_cast<double>(source.messages - source.messages_before);
    status.add(topic + ": tracker", source.tracker.empty() ? "(nothing yet)" : source.tracker);
    status.addf(topic + ": rate [Hz]", "%.1f", elapsed > 0.0 ? fresh / elapsed : 0.0);
    if (source.messages > 0) {
      status.addf(topic + ": age of last report [s]", "%.3f", core::seconds(now - source.newest));
      status.add(topic + ": tracks", source.tracks);
    }
    source.messages_before = source.messages;
  }
  for (const auto& [rule, count] : rules_) status.add("global tracks by rule, " + rule, count);
  if (!why_not_tracklets_.empty()) status.add("why not by tracklets", why_not_tracklets_);
  for (const auto& [sensor, words] : sensors_) status.add("guard of " + sensor, words);
  for (const auto& [tracker, count] : tracklets_) status.add("tracklets of " + tracker, count);
  if (late_tracklets_ > 0) status.add("tracklets that came too late", late_tracklets_);
  if (failed_tracklets_ > 0) status.add("tracklets that an estimator could not take", failed_tracklets_);
  for (const auto& [kind, count] : left_out_) status.add("local tracks left out now, " + kind, count);
  for (auto& [kind, complaint] : complaints_) {
    status.add("complaints, " + kind, complaint.count);
    complaint.count_before = complaint.count;
  }
  last_diagnosis_ = now;
}

void TrackFusionHealth::summarize(core::Time now, diagnostic_updater::DiagnosticStatusWrapper& status) const {
  std::ostringstream line;
  line << tracks_[sightline::Track::CONFIRMED] << " confirmed";
  status.summary(DiagnosticStatus::OK, line.str());
  for (const auto& [topic, source] : sources_) {
    std::ostringstream silent;
    if (source.messages == 0) {
      silent << "nothing yet on " << topic;
    } else if (core::seconds(now - source.newest) > silence_) {
      silent << "no tracks on " << topic << " for " << core::seconds(now - source.newest) << " s";
    } else {
      continue;
    }
    status.mergeSummary(DiagnosticStatus::WARN, silent.str());
  }
  for (const auto& [sensor, words] : harmful_)
    status.mergeSummary(DiagnosticStatus::WARN, sensor + ": " + words);
  for (const auto& [kind, complaint] : complaints_) {
    if (complaint.count == complaint.count_before) continue;
    status.mergeSummary(DiagnosticStatus::WARN,
                        kind + ": " + std::to_string(complaint.count - complaint.count_before) + " new");
  }
}

}  // namespace sightline_ros
