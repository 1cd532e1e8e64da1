#include "sightline/core/fusion/tracklets/tracklet_memory.h"

#include <algorithm>
#include <cmath>

#include "sightline/core/model/name.h"

namespace sightline::core {
namespace {

constexpr std::size_t kMostOfATrack = 4096;  // tracklets
constexpr std::size_t kMostTracks = 1024;    // of a tracker
constexpr std::size_t kMostGaps = 64;
constexpr double kSweep = 0.125;  // of the age: how often tracks are looked through that say nothing new

}  // namespace

std::optional<Refusal> TrackletMemory::take(const TrackletReport& report) {
  if (report.tracker.empty()) return Refusal{"no name", "a tracker's report must name it"};
  if (auto refusal = whyTooLong("the tracker's name", report.tracker)) return refusal;
  const bool is_known = trackers_.count(report.tracker) > 0;
  if (!is_known && trackers_.size() >= static_cast<std::size_t>(params_.max_trackers)) {
    return Refusal{"limit", "already " + std::to_string(trackers_.size()) + " trackers (max_trackers)"};
  }
  Tracker& tracker = trackers_[report.tracker];
  const double behind = is_known ? seconds(tracker.newest - report.time) : 0.0;
  const bool is_overtaken = behind > 0.0 && behind <= params_.age;
  if (!report.since && !is_overtaken) tracker = Tracker{report.time, {}, {}, {}};
  noteSpan(tracker, is_known, report);
  for (const TrackTracklet& it : report.tracklets) {
    if (tracker.tracks.count(it.track) == 0 && tracker.tracks.size() >= kMostTracks) continue;
    std::deque<Remembered>& tracklets = tracker.tracks[it.track];
    tracklets.push_back({next_number_++, it.tracklet});
    forgetOld(tracklets, tracker.newest);
    if (tracklets.empty()) tracker.tracks.erase(it.track);  // it came too late
  }
  forgetSilent(tracker);
  return std::nullopt;
}

/// A report covers the time from the one before, or from ever, to its own.
void TrackletMemory::noteSpan(Tracker& tracker, bool is_known, const TrackletReport& report) const {
  const Time ever = report.time - durationOf(params_.age);
  const Time from = report.since.value_or(ever);
  const Time last = is_known || !report.since ? tracker.newest : ever;
  if (from > last) tracker.gaps.push_back({last, from});
  tracker.newest = std::max(last, report.time);
  if (report.time >= last) return;
  std::vector<Gap> rest;  // overtaken by a later one: it fills what had been missing
  for (const Gap& gap : tracker.gaps) {
    if (gap.from < std::min(gap.to, from)) rest.push_back({gap.from, std::min(gap.to, from)});
    if (std::max(gap.from, report.time) < gap.to) rest.push_back({std::max(gap.from, report.time), gap.to});
  }
  tracker.gaps = rest;
}

void TrackletMemory::forgetOld(std::deque<Remembered>& tracklets, Time newest) const {
  const Time oldest = newest - durationOf(params_.age);
  while (!tracklets.empty() && (tracklets.front().tracklet.time < oldest || tracklets.size() > kMostOfATrack))
    tracklets.pop_front();
}

/// All tracks now and then, which bounds the memory.
void TrackletMemory::forgetSilent(Tracker& tracker) const {
  const Time oldest = tracker.newest - durationOf(params_.age);
  auto& gaps = tracker.gaps;
  while (!gaps.empty() && (gaps.front().to <= oldest || gaps.size() > kMostGaps)) gaps.erase(gaps.begin());
  if (std::abs(seconds(tracker.newest - tracker.swept)) < kSweep * params_.age) return;
  tracker.swept = tracker.newest;
  for (auto track = tracker.tracks.begin(); track != tracker.tracks.end();) {
    forgetOld(track->second, tracker.newest);
    track = track->second.empty() ? tracker.tracks.erase(track) : std::next(track);
  }
}

const std::deque<TrackletMemory::Remembered>* TrackletMemory::find(const LocalKey& key) const {
  const auto tracker = trackers_.find(key.tracker);
  if (tracker == trackers_.end()) return nullptr;
  const auto track = tracker->second.tracks.find(key.id);
  return track == tracker->second.tracks.end() ? nullptr : &track->second;
}

std::optional<Time> TrackletMemory::newest(const std::string& tracker) const {
  const auto known = trackers_.find(tracker);
  if (known == trackers_.end()) return std::nullopt;
  return known->second.newest;
}

double TrackletMemory::missing(const std::string& tracker, Time from) const {
  double missing = 0.0;
  for (const Gap& gap : trackers_.at(tracker).gaps)
    missing += std::max(0.0, seconds(gap.to - std::max(gap.from, from)));
  return missing;
}

}  // namespace sightline::core
