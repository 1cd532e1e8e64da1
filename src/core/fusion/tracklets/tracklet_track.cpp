#include "sightline/core/fusion/tracklets/tracklet_track.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace sightline::core {
namespace {

constexpr int kSnapshotsPerLag = 8;
constexpr std::size_t kMostEntries = 8192;
constexpr std::ptrdiff_t kMostTold = 128;  // changes; more than are remembered

/// Order in which tracklets are taken: by time, at one instant by sensor, then by content, so that it never
/// depends on the order of arrival.
bool precedes(const Tracklet& a, const Tracklet& b) {
  const auto rank = [](const Tracklet& it) {
    const Eigen::Vector3d& d = it.sighting.direction;
    return std::make_tuple(it.time, std::cref(it.sensor), d.x(), d.y(), d.z());
  };
  return rank(a) < rank(b);
}

}  // namespace

TrackletTrack::TrackletTrack(const EstimatorParams& estimator, double max_lag, const GuardParams& guard)
    : max_lag_(max_lag), estimator_(estimator, guard, max_lag) {}

bool TrackletTrack::add(const LocalKey& source, std::uint64_t number, const Tracklet& tracklet) {
  if (closed_ && tracklet.time < *closed_) return false;
  const auto first_open = entries_.begin() + static_cast<std::ptrdiff_t>(open_);
  const auto place =
      std::upper_bound(first_open, entries_.end(), tracklet,
                       [](const Tracklet& a, const Entry& b) { return precedes(a, b.tracklet); });
  if (place != first_open && !precedes(std::prev(place)->tracklet, tracklet)) return true;  // the same
  const auto index = static_cast<std::size_t>(place - entries_.begin());
  entries_.insert(place, Entry{source, number, tracklet, nullptr});
  const bool has_successor = index + 1 < entries_.size();
  if (has_successor) entries_[index].before = std::move(entries_[index + 1].before);  // now it stands there
  if (index < taken_) {
    ++taken_;
    goBackTo(index);
  }
  return true;
}

std::optional<std::uint64_t> TrackletTrack::remove(const LocalKey& source, Time since) {
  std::optional<std::uint64_t> least;
  for (std::size_t i = open_; i < entries_.size();) {
    if (!(entries_[i].source == source) || entries_[i].tracklet.time < since) {
      ++i;
      continue;
    }
    if (i < taken_) goBackTo(i);
    least = std::min(least.value_or(entries_[i].number), entries_[i].number);
    std::unique_ptr<GuardedEstimator> before = std::move(entries_[i].before);
    entries_.erase(entries_.begin() + static_cast<std::ptrdiff_t>(i));
    if (i < entries_.size() && before) entries_[i].before = std::move(before);
  }
  return least;
}

/// Forgets everything from this entry on, back to the nearest snapshot.
void TrackletTrack::goBackTo(std::size_t entry) {
  // The next entry to be taken may have a snapshot as well, where a return ended.
  for (std::size_t i = entry + 1; i <= taken_ && i < entries_.size(); ++i) entries_[i].before.reset();
  while (!entries_[entry].before) --entry;
  estimator_ = GuardedEstimator(*entries_[entry].before);
  taken_ = entry;
}

std::optional<AngularState> TrackletTrack::stateAt(Time time) {
  const auto past = [this](std::size_t back) -> const Tracklet& { return entries_[taken_ - back].tracklet; };
  while (taken_ < entries_.size() && entries_[taken_].tracklet.time <= time) {
    Entry& next = entries_[taken_];
    if (!next.before && isSnapshotDue()) next.before = std::make_unique<GuardedEstimator>(estimator_);
    estimator_.take(next.tracklet, past);
    ++taken_;
  }
  forgetOld();
  return estimator_.stateAt(time);
}

/// Whether the state before the next entry should be kept: always before the first one, then a few for each
/// lag.
bool TrackletTrack::isSnapshotDue() const {
  for (std::size_t i = taken_; i-- > open_;) {
    if (!entries_[i].before) continue;
    return seconds(entries_[taken_].tracklet.time - entries_[i].tracklet.time) >= max_lag_ / kSnapshotsPerLag;
  }
  return true;
}

/// Closes what is before the last snapshot that is older than max_lag, and drops of it what that snapshot
/// does not need for going back after an alarm.
void TrackletTrack::forgetOld() {
  if (taken_ == 0) return;
  const Time oldest = entries_[taken_ - 1].tracklet.time - durationOf(max_lag_);
  std::size_t open = open_;
  for (std::size_t i = open_ + 1; i < taken_; ++i) {
    const bool too_many = entries_.size() - open > kMostEntries;
    if (entries_[i].tracklet.time > oldest && !too_many) break;
    if (entries_[i].before) open = i;
  }
  if (open == open_) return;
  closed_ = entries_[open].tracklet.time;
  for (std::size_t i = open_; i < open; ++i) entries_[i].before.reset();
  const std::size_t drop = open - std::min(open, entries_[open].before->reach());
  entries_.erase(entries_.begin(), entries_.begin() + static_cast<std::ptrdiff_t>(drop));
  open_ = open - drop;
  taken_ -= drop;
}

std::map<LocalKey, double> TrackletTrack::informationBySource() const {
  std::vector<std::pair<const LocalKey*, double>> sums;  // of few sources; a map would be slower
  for (std::size_t i = open_; i < entries_.size(); ++i) {
    const double noise_scale = i < taken_ ? estimator_.noiseScale(taken_ - i) : 1.0;
    const auto isIt = [&](const auto& sum) { return *sum.first == entries_[i].source; };
    auto sum = std::find_if(sums.begin(), sums.end(), isIt);
    if (sum == sums.end()) sum = sums.insert(sum, {&entries_[i].source, 0.0});
    sum->second += 1.0 / (noise_scale * entries_[i].tracklet.sighting.covariance.trace());
  }
  std::map<LocalKey, double> information;
  for (const auto& [source, sum] : sums) information[*source] = sum;
  return information;
}

std::vector<SensorChange> TrackletTrack::newChanges() {
  std::vector<SensorChange> fresh;
  for (const SensorChange& change : estimator_.changes()) {
    const bool is_told = std::any_of(told_.begin(), told_.end(), [&](const SensorChange& told) {
      return told.sensor == change.sensor && told.change.time == change.change.time &&
             told.change.verdict == change.change.verdict;
    });
    if (!is_told) fresh.push_back(change);
  }
  told_.insert(told_.end(), fresh.begin(), fresh.end());
  if (static_cast<std::ptrdiff_t>(told_.size()) > kMostTold)
    told_.erase(told_.begin(), told_.end() - kMostTold);
  return fresh;
}

}  // namespace sightline::core
