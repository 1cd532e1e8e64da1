#include "sightline/ros/components/local_tracker_health.h"

#include <algorithm>
#include <sstream>

#include <diagnostic_msgs/DiagnosticStatus.h>

#include "sightline/report/sensor_text.h"
#include "sightline/ros/diagnosis/refusals.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {

namespace core = sightline::core;
using diagnostic_msgs::DiagnosticStatus;
using sightline::report::clockTextOf;
using sightline::report::textOf;

namespace {

constexpr double kSecondsOfExamination = 10.0;
constexpr double kRough = 4.0;               // variance over the stated one that deserves a warning ...
constexpr double kSettledSightings = 100.0;  // ... when it rests on so many sightings
constexpr std::size_t kMostSensors = 256;    // that are told apart
const char* const kFurtherSensors = "(further sensors)";
const char* const kRejectedSightings = "sightings rejected";

std::string kindOfComplaint(const TrackerReport& report) {
  if (report.refusal) return "scans dropped, " + report.refusal->kind;
  return report.rejected > 0 ? kRejectedSightings : "";
}

}  // namespace

std::string firstRejection(const sightline::AssociationArray& associations) {
  for (const auto& association : associations.associations) {
    if (association.decision != sightline::Association::REJECTED_INPUT) continue;
    return "sighting " + std::to_string(association.sighting) + ": " + association.reason;
  }
  return "";
}

/// Of more sensors than are told apart the others are one.
LocalTrackerHealth::Sensor& LocalTrackerHealth::sensorOf(const std::string& name) {
  const bool is_known = sensors_.size() < kMostSensors || sensors_.count(name) > 0;
  return sensors_[is_known ? name : kFurtherSensors];
}

void LocalTrackerHealth::noteArrival(const sightline::SightingArray& scan, core::Time now) {
  if (scan.sensor.empty()) return;
  Sensor& sensor = sensorOf(scan.sensor);
  sensor.record.take(scan, now);
  if (now == core::Time{} || scan.header.stamp.isZero()) return;
  sensor.latency.add(core::seconds(now - toCore(scan.header.stamp)));
}

/// Now and then, examines what came in since as input_doctor does.
void LocalTrackerHealth::examine(core::Time now) {
  if (!last_examination_ || now < *last_examination_) last_examination_ = now;
  if (core::seconds(now - *last_examination_) < kSecondsOfExamination) return;
  last_examination_ = now;
  for (auto& [name, sensor] : sensors_) {
    sensor.findings = sensor.record.findings(name, limits_);
    sensor.record = SensorRecord();
  }
}

void LocalTrackerHealth::note(const TrackerReport& report) {
  const bool was_used = !report.refusal;
  if (!was_used) {
    ++drops_[kindOfComplaint(report)].count;
    Sensor& sensor = sensorOf(report.scan->sensor);
    ++sensor.drops[report.refusal->kind];
    sensor.last_drops[report.refusal->kind] =
        "in frame \"" + report.scan->header.frame_id + "\": " + core::readableDetail(*report.refusal);
  }
  if (report.went_back) {
    for (auto& named : sensors_) named.second.last_scan = named.second.last_sighting = core::Time{};
  }
  if (was_used && report.rejected > 0) drops_[kRejectedSightings].count += report.rejected;
  if (!was_used) return;
  starts_.take(*report.associations);
  starts_.take(*report.tracks);

  Sensor& sensor = sensorOf(report.scan->sensor);
  const core::Time stamp = toCore(report.scan->header.stamp);
  const std::size_t taken = report.scan->sightings.size() - report.rejected;
  ++sensor.scans;
  sensor.sightings += taken;
  for (const auto& association : report.associations->associations) {
    if (association.decision == sightline::Association::ACCEPTED)
      sensor.record.takeInnovation(association.distance_squared);
  }
  sensor.last_scan = std::max(sensor.last_scan, stamp);
  if (taken > 0) sensor.last_sighting = std::max(sensor.last_sighting, stamp);

  tracks_.fill(0);
  for (const auto& track : report.tracks->tracks) {
    if (track.status < tracks_.size()) ++tracks_[track.status];
  }
}

std::optional<std::string> LocalTrackerHealth::warningAbout(const TrackerReport& report, core::Time now) {
  const std::string kind = kindOfComplaint(report);
  if (kind.empty()) return std::nullopt;
  Counted& counted = drops_[kind];
  if (counted.last_warning && now >= *counted.last_warning &&
      core::seconds(now - *counted.last_warning) < kSecondsBetweenWarnings) {
    return std::nullopt;
  }
  std::ostringstream warning;
  warning << kind << " (" << counted.count - counted.count_warned << " new, " << counted.count
          << " in all), the last of sensor \"" << report.scan->sensor << "\" in frame \""
          << report.scan->header.frame_id << "\": "
          << (report.refusal && !report.refusal->detail.empty() ? core::readableDetail(*report.refusal)
                                                                : firstRejection(*report.associations));
  counted.last_warning = now;
  counted.count_warned = counted.count;
  return warning.str();
}

std::vector<std::string> LocalTrackerHealth::sensorLines(const TrackerReport& report, core::Time now) {
  std::vector<std::string> lines;
  for (const core::SensorChange& change : report.changes) {
    Counted& counted = changes_[change.sensor];
    ++counted.count;
    const bool is_soon = counted.last_warning && now >= *counted.last_warning &&
                         core::seconds(now - *counted.last_warning) < kSecondsBetweenWarnings;
    const bool is_recovery = change.change.verdict == core::SensorVerdict::healthy;
    if (is_soon && !is_recovery) continue;
    const std::uint64_t held_back = counted.count - counted.count_warned - 1;
    lines.push_back(textOf(change) +
                    (held_back > 0 ? " (" + std::to_string(held_back) + " changes before not shown)" : ""));
    counted.last_warning = now;
    counted.count_warned = counted.count;
  }
  return lines;
}

std::vector<std::string> LocalTrackerHealth::clockLines(const std::vector<core::WatchedSensor>& watched) {
  std::vector<std::string> lines;
  for (const core::WatchedSensor& sensor : watched) {
    const bool is_wrong = sensor.clock.has_value();
    bool& was_wrong = wrong_clocks_[sensor.sensor];
    if (is_wrong && !was_wrong) lines.push_back(clockTextOf(sensor));
    if (!is_wrong && was_wrong)
      lines.push_back("clock of " + sensor.sensor + " agrees with the others again");
    was_wrong = is_wrong;
  }
  return lines;
}

void LocalTrackerHealth::diagnose(core::Time now, std::size_t waiting,
                                  diagnostic_updater::DiagnosticStatusWrapper& status,
                                  const std::vector<core::WatchedSensor>& watched,
                                  const std::vector<core::CalibratedSensor>& calibrated,
                                  const std::vector<core::WatchedStamps>& stamps,
                                  const std::vector<core::CalibratedDetection>& detection) {
  summarize(now, status);
  examine(now);
  for (const core::WatchedStamps& sensor : stamps) {
    if (sensor.text.empty()) continue;
    status.add("stamps of " + sensor.sensor, sensor.text);
    status.mergeSummary(DiagnosticStatus::WARN, "stamps of " + sensor.sensor + " are " + sensor.text);
  }
  for (const core::CalibratedSensor& sensor : calibrated) {
    status.add("noise of " + sensor.sensor, textOf(sensor));
    const bool is_rough = sensor.scale > kRough && sensor.sightings >= kSettledSightings;
    if (is_rough) {
      status.mergeSummary(DiagnosticStatus::WARN, sensor.sensor + ": " + textOf(sensor) +
                                                      ": state the sigma that its sightings have");
    }
  }
  for (const core::CalibratedDetection& sensor : detection)
    status.add("detection of " + sensor.sensor, textOf(sensor));
  for (const core::WatchedSensor& sensor : watched) {
    const std::string words = textOf(sensor);
    status.add("guard of " + sensor.sensor, words);
    if (sensor.verdict != core::SensorVerdict::healthy)
      status.mergeSummary(DiagnosticStatus::WARN, sensor.sensor + " " + words);
    const std::string clock = clockTextOf(sensor);
    if (clock.empty()) continue;
    status.add("clock of " + sensor.sensor, clock);
    status.mergeSummary(DiagnosticStatus::WARN, clock);
  }
  addStarts(status);
  status.add("tracks confirmed", tracks_[sightline::Track::CONFIRMED]);
  status.add("tracks coasting", tracks_[sightline::Track::COASTING]);
  status.add("tracks tentative", tracks_[sightline::Track::TENTATIVE]);

  const double elapsed = last_diagnosis_ ? core::seconds(now - *last_diagnosis_) : 0.0;
  for (auto& [name, sensor] : sensors_) {
    addSensor(name, sensor, now, elapsed, status);
    sensor.scans_before = sensor.scans;
  }
  status.add("scans waiting for a transform", waiting);
  for (auto& [reason, counted] : drops_) {
    status.add(reason, counted.count);
    counted.count_before = counted.count;
  }
  last_diagnosis_ = now;
}

void LocalTrackerHealth::addStarts(diagnostic_updater::DiagnosticStatusWrapper& status) const {
  for (const auto& [sensor, finding] : starts_.findings()) {
    if (!finding) continue;
    status.add("track starts of " + sensor, finding->words);
    if (!finding->is_note) status.mergeSummary(DiagnosticStatus::WARN, sensor + ": " + finding->words);
  }
}

void LocalTrackerHealth::addSensor(const std::string& name, const Sensor& sensor, core::Time now,
                                   double elapsed,
                                   diagnostic_updater::DiagnosticStatusWrapper& status) const {
  const auto fresh = static_cast<double>(sensor.scans - sensor.scans_before);
  status.addf(name + ": scan rate [Hz]", "%.1f", elapsed > 0.0 ? fresh / elapsed : 0.0);
  status.add(name + ": scans", sensor.scans);
  status.add(name + ": sightings", sensor.sightings);
  if (sensor.last_sighting != core::Time{}) {
    status.addf(name + ": age of last sighting [s]", "%.3f", core::seconds(now - sensor.last_sighting));
  }
  if (sensor.latency.size() > 0) {
    status.addf("latency of " + name, "%.1f ms (median), %.1f ms (95 %%), over the last %zu scans",
                1e3 * *sensor.latency.quantile(0.5), 1e3 * *sensor.latency.quantile(0.95),
                sensor.latency.size());
  }
  for (const Finding& finding : sensor.findings) {
    if (finding.is_note) continue;
    status.add("input of " + name, finding.words);
    status.mergeSummary(DiagnosticStatus::WARN, name + ": " + finding.words);
  }
  for (const auto& [reason, count] : sensor.drops) status.add(name + ": scans dropped, " + reason, count);
  for (const auto& [reason, why] : sensor.last_drops)
    status.add(name + ": last scan dropped, " + reason, why);
}

void LocalTrackerHealth::summarize(core::Time now,
                                   diagnostic_updater::DiagnosticStatusWrapper& status) const {
  core::Time newest{};
  for (const auto& named : sensors_) newest = std::max(newest, named.second.last_scan);
  std::ostringstream line;
  line << tracks_[sightline::Track::CONFIRMED] << " confirmed";
  if (newest == core::Time{}) {
    status.summary(DiagnosticStatus::WARN, "no scan yet");
  } else if (core::seconds(now - newest) > silence_) {
    line << ", no scan for " << core::seconds(now - newest) << " s";
    status.summary(DiagnosticStatus::WARN, line.str());
  } else {
    status.summary(DiagnosticStatus::OK, line.str());
  }
  const std::string drops = latestDrops();
  if (!drops.empty()) status.mergeSummary(DiagnosticStatus::WARN, drops);
}

std::string LocalTrackerHealth::latestDrops() const {
  std::ostringstream line;
  for (const auto& [reason, counted] : drops_) {
    if (counted.count == counted.count_before) continue;
    line << (line.tellp() > 0 ? ", " : "") << reason << ": " << counted.count - counted.count_before
         << " new";
  }
  return line.str();
}

}  // namespace sightline_ros
