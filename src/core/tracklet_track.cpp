#include "sightline/core/tracklet_track.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace sightline::core {
namespace {

constexpr int kSnapshotsPerLag = 8;
constexpr std::size_t kMostEntries = 8192;

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

TrackletTrack::TrackletTrack(const EstimatorParams& estimator, double max_lag)
    : params_(estimator), max_lag_(max_lag) {}

bool TrackletTrack::add(const LocalKey& source, std::uint64_t number, const Tracklet& tracklet) {
  if (closed_ && tracklet.time < *closed_) return false;
  const auto place =
      std::upper_bound(entries_.begin(), entries_.end(), tracklet,
                       [](const Tracklet& a, const Entry& b) { return precedes(a, b.tracklet); });
  if (place != entries_.begin() && !precedes(std::prev(place)->tracklet, tracklet)) return true;  // the same
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
  for (std::size_t i = 0; i < entries_.size();) {
    if (!(entries_[i].source == source) || entries_[i].tracklet.time < since) {
      ++i;
      continue;
    }
    if (i < taken_) goBackTo(i);
    least = std::min(least.value_or(entries_[i].number), entries_[i].number);
    std::unique_ptr<Snapshot> before = std::move(entries_[i].before);
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
  estimator_ = entries_[entry].before->has_value() ? Snapshot(**entries_[entry].before) : std::nullopt;
  taken_ = entry;
}

std::optional<AngularState> TrackletTrack::stateAt(Time time) {
  while (taken_ < entries_.size() && entries_[taken_].tracklet.time <= time) {
    Entry& next = entries_[taken_];
    if (!next.before && isSnapshotDue()) next.before = std::make_unique<Snapshot>(estimator_);
    take(next.tracklet);
    ++taken_;
  }
  forgetOld();
  if (!estimator_) return std::nullopt;
  return estimator_->stateAt(time);
}

void TrackletTrack::take(const Tracklet& tracklet) {
  if (estimator_) {
    estimator_->update(tracklet);
  } else {
    estimator_.emplace(makeEstimator(params_), tracklet);
  }
}

/// Whether the state before the next entry should be kept: always before the first one, then a few for each
/// lag.
bool TrackletTrack::isSnapshotDue() const {
  for (std::size_t i = taken_; i-- > 0;) {
    if (!entries_[i].before) continue;
    return seconds(entries_[taken_].tracklet.time - entries_[i].tracklet.time) >= max_lag_ / kSnapshotsPerLag;
  }
  return true;
}

/// Drops the entries before the last snapshot that is older than max_lag.
void TrackletTrack::forgetOld() {
  if (taken_ == 0) return;
  const Time oldest = entries_[taken_ - 1].tracklet.time - durationOf(max_lag_);
  std::size_t keep_from = 0;
  for (std::size_t i = 1; i < taken_; ++i) {
    const bool too_many = entries_.size() - keep_from > kMostEntries;
    if (entries_[i].tracklet.time > oldest && !too_many) break;
    if (entries_[i].before) keep_from = i;
  }
  if (keep_from == 0) return;
  closed_ = entries_[keep_from].tracklet.time;
  entries_.erase(entries_.begin(), entries_.begin() + static_cast<std::ptrdiff_t>(keep_from));
  taken_ -= keep_from;
}

std::map<LocalKey, double> TrackletTrack::informationBySource() const {
  std::map<LocalKey, double> information;
  for (const Entry& entry : entries_)
    information[entry.source] += 1.0 / entry.tracklet.sighting.covariance.trace();
  return information;
}

}  // namespace sightline::core
