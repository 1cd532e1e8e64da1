#include "sightline/core/fusion/local_reports.h"

#include <algorithm>
#include <sstream>

#include "sightline/core/fusion/track_alignment.h"

namespace sightline::core {
namespace {

constexpr double kPaces = 3.0;           // usual intervals that a report always counts
constexpr double kIntervalMemory = 0.2;  // share of the newest interval in the usual one
constexpr double kPatience = 3.0;        // times max_age, with trackers that are ahead of one that goes on

std::string invalidityOf(const Track& track) {
  if (track.id == 0) return "invalid: id 0 means no track; ids start at 1";
  if (track.status > TrackStatus::coasting) {
    return "invalid: status " + std::to_string(static_cast<int>(track.status)) + " is none of 0, 1, 2";
  }
  const auto rejection = rejectionOf(track.state);
  return rejection ? "invalid: " + *rejection : "";
}

}  // namespace

std::string LocalReports::take(const LocalReport& report) {
  std::string why = refusal(report);
  if (!why.empty()) return why;
  replace(trackers_[report.tracker], report);
  forgetThoseAhead(report.tracker);
  forgetSilent(report.tracker);
  return {};
}

std::string LocalReports::refusal(const LocalReport& report) const {
  std::ostringstream why;
  if (report.tracker.empty()) return "no name: a tracker's report must name it";
  const auto known = trackers_.find(report.tracker);
  if (known == trackers_.end()) {
    if (trackers_.size() < static_cast<std::size_t>(params_.max_trackers)) return {};
    why << "limit: already " << trackers_.size() << " trackers (max_trackers)";
    return why.str();
  }
  const double late = seconds(known->second.time - report.time);
  if (late <= 0.0 || late > params_.max_age) return {};
  why << "late: " << late << " s older than the tracker's last report";
  return why.str();
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
  tracker.tracks.clear();
  tracker.surplus.clear();
  for (const Track& track : report.tracks) {
    if (tracker.tracks.size() >= static_cast<std::size_t>(params_.max_tracks)) {
      if (tracker.surplus.size() >= static_cast<std::size_t>(params_.max_tracks)) break;
      tracker.surplus[track.id] = "limit: the report has more than " + std::to_string(params_.max_tracks) +
                                  " tracks (max_local_tracks)";
    } else if (!tracker.tracks.try_emplace(track.id, LocalTrack{track, report.time, invalidityOf(track)})
                    .second) {
      tracker.surplus[track.id] = "invalid: the report has this id more than once";
    }
  }
}

void LocalReports::forgetSilent(const std::string& reporting) {
  const Time now = newest();
  for (auto entry = trackers_.begin(); entry != trackers_.end();) {
    const bool silent = seconds(now - entry->second.time) > params_.forget_after;
    entry = silent && entry->first != reporting ? trackers_.erase(entry) : std::next(entry);
  }
}

void LocalReports::forgetThoseAhead(const std::string& reporting) {
  Tracker& tracker = trackers_[reporting];
  if (age(tracker.time) <= params_.max_age) {
    for (auto& [name, other] : trackers_) other.behind_since.reset();
    return;
  }
  if (!tracker.behind_since || *tracker.behind_since > tracker.time) tracker.behind_since = tracker.time;
  if (seconds(tracker.time - *tracker.behind_since) <= kPatience * params_.max_age) return;
  const Time here = tracker.time;
  for (auto entry = trackers_.begin(); entry != trackers_.end();) {
    const bool ahead = seconds(entry->second.time - here) > params_.max_age;
    entry = ahead ? trackers_.erase(entry) : std::next(entry);
  }
}

double LocalReports::maxAge(const std::string& tracker) const {
  const auto known = trackers_.find(tracker);
  const double interval = known == trackers_.end() ? 0.0 : known->second.interval;
  return std::min(std::max(params_.max_age, kPaces * interval), params_.forget_after);
}

std::string LocalReports::whyUnusable(const std::string& tracker, const LocalTrack& local) const {
  if (!local.invalid.empty()) return local.invalid;
  if (local.track.status == TrackStatus::tentative) return "tentative: its tracker does not believe it yet";
  const double late = age(local.time);
  const double max_age = maxAge(tracker);
  if (late <= max_age) return {};
  std::ostringstream why;
  why << "stale: the report is " << late << " s older than the newest (max_age " << max_age << " s)";
  return why.str();
}

Time LocalReports::newest() const {
  Time newest{};
  for (const auto& [name, tracker] : trackers_) newest = std::max(newest, tracker.time);
  return newest;
}

const LocalTrack* LocalReports::find(const LocalKey& key) const {
  const auto tracker = trackers_.find(key.tracker);
  if (tracker == trackers_.end()) return nullptr;
  const auto track = tracker->second.tracks.find(key.id);
  return track == tracker->second.tracks.end() ? nullptr : &track->second;
}

}  // namespace sightline::core
