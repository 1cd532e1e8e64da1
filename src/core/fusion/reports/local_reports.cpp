#include "sightline/core/fusion/reports/local_reports.h"

#include <algorithm>
#include <sstream>
#include <utility>

#include "sightline/core/fusion/track_alignment.h"
#include "sightline/core/model/name.h"

namespace sightline::core {
namespace {

constexpr double kPaces = 3.0;           // usual intervals that a report always counts
constexpr double kIntervalMemory = 0.2;  // share of the newest interval in the usual one
constexpr double kPatience = 3.0;        // times max_age, with trackers that are ahead of one that goes on

/// Goes on with what its former reports have shown of its acceleration, as long as it is being seen.
void remember(const std::map<std::uint32_t, LocalTrack>& before, LocalTrack& local) {
  const auto former = before.find(local.track.id);
  if (former != before.end()) local.acceleration = former->second.acceleration;
  const bool is_seen =
      former == before.end() || local.track.last_sighting != former->second.track.last_sighting;
  if (is_seen && !local.invalid) local.acceleration.take(local.track.state, local.time);
}

std::optional<Refusal> invalidityOf(const Track& track) {
  if (track.id == 0) return invalid("id 0 means no track; ids start at 1");
  if (track.status > TrackStatus::coasting) {
    return Refusal{"invalid",
                   "status " + std::to_string(static_cast<int>(track.status)) + " is none of 0, 1, 2"};
  }
  if (track.existence < 0.0 || track.existence > 1.0) {
    std::ostringstream detail;
    detail << "existence " << track.existence << " is no probability: give NaN where it is not computed";
    return invalid(detail.str());
  }
  if (auto refusal = whyTooLong(track.sources)) return refusal;
  return rejectionOf(track.state);
}

}  // namespace

std::optional<Refusal> LocalReports::take(const LocalReport& report, std::optional<Time> arrival) {
  if (auto refusal = refusalOf(report)) return refusal;
  const bool has_gone_back = hasGoneBack(report);
  Tracker& tracker = trackers_[report.tracker];
  if (has_gone_back) tracker.went_back = true;
  replace(tracker, report);
  forgotten_.erase(report.tracker);
  updateNewest();
  forgetThoseAhead(report.tracker, arrival);
  forgetSilent(report.tracker);
  return std::nullopt;
}

std::optional<Refusal> LocalReports::refusalOf(const LocalReport& report) const {
  if (report.tracker.empty()) return Refusal{"no name", "a tracker's report must name it"};
  if (auto refusal = whyTooLong("the tracker's name", report.tracker)) return refusal;
  std::ostringstream detail;
  const auto known = trackers_.find(report.tracker);
  if (known == trackers_.end()) {
    if (trackers_.size() < static_cast<std::size_t>(params_.max_trackers)) return std::nullopt;
    detail << "already " << trackers_.size() << " trackers (max_trackers)";
    return Refusal{"limit", detail.str()};
  }
  const double late = seconds(known->second.time - report.time);
  if (late <= 0.0 || late > params_.max_age) return std::nullopt;
  detail << late << " s older than the tracker's last report";
  return Refusal{"late", detail.str()};
}

/// Whether the tracker's stamps went back; of one that is new nobody knows.
bool LocalReports::hasGoneBack(const LocalReport& report) const {
  const auto known = trackers_.find(report.tracker);
  if (known != trackers_.end()) return report.time < known->second.time;
  const auto forgotten = forgotten_.find(report.tracker);
  return forgotten == forgotten_.end() || report.time < forgotten->second;
}

void LocalReports::replace(Tracker& tracker, const LocalReport& report) const {
  const double since_last = seconds(report.time - tracker.time);
  const bool restarted = since_last < 0.0 || tracker.time == Time{};
  if (restarted) {
    tracker.interval = 0.0;
  } else if (since_last > 0.0) {
    tracker.interval += (tracker.interval > 0.0 ? kIntervalMemory : 1.0) * (since_last - tracker.interval);
  }
  tracker.time = report.time;
  auto before = std::exchange(tracker.tracks, {});
  if (restarted) before.clear();
  tracker.surplus.clear();
  for (const Track& track : report.tracks) {
    if (tracker.tracks.size() >= static_cast<std::size_t>(params_.max_tracks)) {
      if (tracker.surplus.size() >= static_cast<std::size_t>(params_.max_tracks)) break;
      tracker.surplus[track.id] = {"limit", "the report has more than " + std::to_string(params_.max_tracks) +
                                                " tracks (max_local_tracks)"};
      continue;
    }
    LocalTrack local{track, report.time, invalidityOf(track)};
    if (local.invalid) local.track.sources.clear();  // however many, however long
    remember(before, local);
    if (!tracker.tracks.try_emplace(track.id, std::move(local)).second)
      tracker.surplus[track.id] = {"invalid", "the report has this id more than once"};
  }
}

/// One tracker that starts again takes nobody back with it.
void LocalReports::updateNewest() {
  Time newest{};
  for (const auto& [name, tracker] : trackers_) newest = std::max(newest, tracker.time);
  if (newest > newest_ || seconds(newest_ - newest) > params_.max_age) newest_ = newest;
}

void LocalReports::forgetSilent(const std::string& reporting) {
  for (auto entry = trackers_.begin(); entry != trackers_.end();) {
    const bool is_silent = age(entry->second.time) > params_.forget_after && entry->first != reporting;
    if (!is_silent) {
      ++entry;
      continue;
    }
    if (forgotten_.size() >= static_cast<std::size_t>(params_.max_trackers)) {
      forgotten_.erase(std::min_element(forgotten_.begin(), forgotten_.end(),
                                        [](const auto& a, const auto& b) { return a.second < b.second; }));
    }
    forgotten_[entry->first] = entry->second.time;
    entry = trackers_.erase(entry);
  }
}

void LocalReports::forgetThoseAhead(const std::string& reporting, std::optional<Time> arrival) {
  Tracker& tracker = trackers_[reporting];
  if (age(tracker.time) <= params_.max_age) {
    tracker.went_back = false;
    for (auto& [name, other] : trackers_) other.behind_since.reset();
    return;
  }
  std::optional<Instant>& since = tracker.behind_since;
  const bool clock_went_back = since && arrival && since->arrival && *arrival < *since->arrival;
  if (!since || since->stamp > tracker.time || clock_went_back) since = Instant{tracker.time, arrival};
  if (!isAloneForLong(tracker, arrival)) return;
  const Time here = tracker.time;
  for (auto entry = trackers_.begin(); entry != trackers_.end();) {
    const bool is_ahead = seconds(entry->second.time - here) > params_.max_age;
    entry = is_ahead ? trackers_.erase(entry) : std::next(entry);
  }
  updateNewest();
}

/// Whether those ahead have been silent for long while this one, behind them, reported.
bool LocalReports::isAloneForLong(const Tracker& tracker, std::optional<Time> arrival) const {
  const double patience = kPatience * params_.max_age;
  const Instant& since = *tracker.behind_since;
  if (seconds(tracker.time - since.stamp) <= patience) return false;
  if (arrival && since.arrival) return seconds(*arrival - *since.arrival) > patience;
  return tracker.went_back;
}

double LocalReports::maxAge(const std::string& tracker) const {
  const auto known = trackers_.find(tracker);
  const double interval = known == trackers_.end() ? 0.0 : known->second.interval;
  return std::min(std::max(params_.max_age, kPaces * interval), params_.forget_after);
}

std::optional<Refusal> LocalReports::whyUnusable(const std::string& tracker, const LocalTrack& local) const {
  if (local.invalid) return local.invalid;
  if (local.track.status == TrackStatus::tentative)
    return Refusal{"tentative", "its tracker does not believe it yet"};
  const double late = age(local.time);
  const double max_age = maxAge(tracker);
  if (late <= max_age) return std::nullopt;
  std::ostringstream detail;
  detail << "the report is " << late << " s older than the newest (max_age " << max_age << " s)";
  return Refusal{"stale", detail.str()};
}

const LocalTrack* LocalReports::find(const LocalKey& key) const {
  const auto tracker = trackers_.find(key.tracker);
  if (tracker == trackers_.end()) return nullptr;
  const auto track = tracker->second.tracks.find(key.id);
  return track == tracker->second.tracks.end() ? nullptr : &track->second;
}

}  // namespace sightline::core
