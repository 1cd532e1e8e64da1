#include "sightline/core/fusion/global_tracks.h"

#include <algorithm>
#include <optional>

namespace sightline::core {
namespace {

constexpr std::size_t kMostFormer = 32;     // local tracks that a global one remembers
constexpr std::size_t kMostRetired = 1024;  // local tracks of deleted global ones that are remembered
constexpr std::uint32_t kFewHits = 20;  // with which a local track returns; more: its tracker started again

/// The hits of this local track when the entry lost it, if it has more now; nullopt when it did not have it.
std::optional<std::uint32_t> hitsWhenLost(const GlobalTrackEntry& entry, const LocalKey& key,
                                          std::uint32_t hits) {
  std::optional<std::uint32_t> latest;
  for (const auto& [former, then] : entry.former) {
    if (former == key && then < hits) latest = std::max(latest.value_or(then), then);
  }
  return latest;
}

}  // namespace

void removeSupporter(GlobalTrackEntry& entry, std::size_t supporter) {
  const Supporter& leaving = entry.track.supporters()[supporter];
  const std::optional<Time>& since =
      leaving.contradicts_since ? leaving.contradicts_since : leaving.misplaced_since;
  if (since) entry.tracklets.takeBack(leaving.key, *since);
  entry.tracklets.leave(leaving.key);
  entry.track.leave(supporter);
}

void leaveOutBiased(GlobalTrackEntry& entry) {
  const auto& supporters = entry.track.supporters();
  for (std::size_t i = 0; i < supporters.size(); ++i) {
    if (supporters[i].unusable) continue;
    if (auto exclusion = entry.tracklets.exclusionOf(supporters[i].key))
      entry.track.setUnusable(i, std::move(exclusion));
  }
}

GlobalTracks::GlobalTracks(const TrackFusionParams& params)
    : params_(params), thresholds_(thresholdsOf(params)) {}

void GlobalTracks::reconfigure(const TrackFusionParams& wanted) {
  const bool begins_anew = usesTracklets(wanted.rule) != usesTracklets(params_.rule);
  for (GlobalTrackEntry& entry : entries_) {
    if (begins_anew) {
      entry.tracklets = TrackletFusion(wanted.tracklets);
      entry.report.sensors.clear();
      entry.report.sensor_changes.clear();
    } else {
      entry.tracklets.setThresholds(wanted.tracklets.guard.health, time_);
    }
  }
  params_ = wanted;
  thresholds_ = thresholdsOf(wanted);
}

void GlobalTracks::follow(const LocalReports& reports, const NewReports& new_reports) {
  if (reports.newest() < time_) reset();  // the trackers' stamps start again
  time_ = reports.newest();
  for (GlobalTrackEntry& entry : entries_) {
    entry.track.advance(time_);
    followReports(entry, reports, new_reports);
    leaveOutBiased(entry);
  }
}

/// Renews the supporters from the reports.
void GlobalTracks::followReports(GlobalTrackEntry& entry, const LocalReports& reports,
                                 const NewReports& new_reports) {
  for (std::size_t i = entry.track.supporters().size(); i-- > 0;) {
    const LocalKey key = entry.track.supporters()[i].key;
    const std::uint32_t hits_before = entry.track.supporters()[i].local.track.hits;
    const LocalTrack* local = reports.find(key);
    // An established track does not become tentative: its tracker started again and gave the id to another.
    if (local == nullptr || local->track.status == TrackStatus::tentative) {
      if (entry.former.size() >= kMostFormer) entry.former.erase(entry.former.begin());
      if (local == nullptr) entry.former.emplace_back(key, hits_before);
      removeSupporter(entry, i);
      continue;
    }
    entry.track.setUnusable(i, reports.whyUnusable(key.tracker, *local));
    if (entry.track.supporters()[i].unusable || new_reports.count(key.tracker) == 0) continue;
    LocalTrack honest = *local;
    honest.track.state.covariance *= entry.tracklets.noiseScale(key);
    const double surprise = entry.track.renew(i, honest);
    const bool is_another = local->track.hits < hits_before && surprise > thresholds_.contradict;
    if (is_another) removeSupporter(entry, i);
  }
}

void GlobalTracks::start(const LocalKey& key, const LocalTrack& local) {
  if (local.track.status != TrackStatus::confirmed) return;
  const std::size_t former = formerOf(key, local);
  if (former < entries_.size()) {
    entries_[former].track.join(key, local);
    return;
  }
  if (entries_.size() >= static_cast<std::size_t>(params_.max_tracks)) return;
  const std::optional<std::uint32_t> retired = retiredIdOf(key, local);
  const std::uint32_t id = retired ? *retired : next_id_++;
  GlobalTrackEntry entry{
      GlobalTrack(id, time_, key, local, params_.process_noise), TrackletFusion(params_.tracklets), {}, {}};
  entry.report.track.id = id;
  const auto place = std::upper_bound(
      entries_.begin(), entries_.end(), id,
      [](std::uint32_t value, const GlobalTrackEntry& other) { return value < other.track.id(); });
  entries_.insert(place, std::move(entry));
}

std::size_t GlobalTracks::formerOf(const LocalKey& key, const LocalTrack& local) const {
  std::size_t best = entries_.size();
  std::uint32_t latest = 0;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (!entries_[i].track.supporters().empty()) continue;
    const std::optional<std::uint32_t> hits = hitsWhenLost(entries_[i], key, local.track.hits);
    if (!hits || (best < entries_.size() && *hits <= latest)) continue;
    best = i;
    latest = *hits;
  }
  return best;
}

void GlobalTracks::retire(const GlobalTrackEntry& entry) {
  for (const auto& [key, hits] : entry.former) retired_.push_back({key, hits, entry.track.id()});
  while (retired_.size() > kMostRetired) retired_.pop_front();
}

/// The id of the last global track that the local one supported, which is taken by this.
std::optional<std::uint32_t> GlobalTracks::retiredIdOf(const LocalKey& key, const LocalTrack& local) {
  for (auto it = retired_.rbegin(); it != retired_.rend(); ++it) {
    if (!(it->key == key)) continue;
    const std::uint32_t id = it->id;
    const bool is_same = local.track.hits > it->hits && local.track.hits <= it->hits + kFewHits;
    if (!is_same) return std::nullopt;
    retired_.erase(std::remove_if(retired_.begin(), retired_.end(),
                                  [id](const Retired& other) { return other.id == id; }),
                   retired_.end());
    return id;
  }
  return std::nullopt;
}

void GlobalTracks::merge(const std::vector<std::pair<std::size_t, std::size_t>>& pairs,
                         const TrackerMisalignment& misalignment) {
  std::vector<std::uint32_t> gone;
  for (const auto& [one, other] : pairs) {  // entries stand in ascending order of id
    const std::size_t older = std::min(one, other), younger = std::max(one, other);
    entries_[older].track.absorb(entries_[younger].track);
    entries_[older].track.compareSupporters(misalignment);
    gone.push_back(entries_[younger].track.id());
  }
  erase(gone);
}

void GlobalTracks::erase(const std::vector<std::uint32_t>& ids) {
  const auto is_gone = [&ids](const GlobalTrackEntry& entry) {
    return std::find(ids.begin(), ids.end(), entry.track.id()) != ids.end();
  };
  entries_.erase(std::remove_if(entries_.begin(), entries_.end(), is_gone), entries_.end());
}

void GlobalTracks::deleteSilent() {
  for (auto entry = entries_.begin(); entry != entries_.end();) {
    const double silence = seconds(time_ - entry->track.lastFusion());
    if (silence <= std::max(params_.delete_after, params_.remember)) {
      ++entry;
      continue;
    }
    retire(*entry);
    entry = entries_.erase(entry);
  }
}

std::vector<std::uint32_t> GlobalTracks::supportersOf(const std::string& tracker) const {
  std::vector<std::uint32_t> ids;
  for (const GlobalTrackEntry& entry : entries_) {
    const std::size_t number = entry.track.numberOf(tracker);
    if (number < entry.track.supporters().size()) ids.push_back(entry.track.supporters()[number].key.id);
  }
  std::sort(ids.begin(), ids.end());
  return ids;
}

void GlobalTracks::reset() {
  entries_.clear();
  retired_.clear();
  time_ = {};
}

}  // namespace sightline::core
