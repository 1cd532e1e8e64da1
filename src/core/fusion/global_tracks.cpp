#include "sightline/core/fusion/global_tracks.h"

#include <algorithm>
#include <optional>

namespace sightline::core {
namespace {

constexpr std::size_t kMostFormer = 32;  // local tracks that a global one remembers

/// Whether the entry has lost this local track, which has more hits now than then.
bool hadSupporter(const GlobalTrackEntry& entry, const LocalKey& key, std::uint32_t hits) {
  return std::any_of(entry.former.begin(), entry.former.end(),
                     [&](const auto& former) { return former.first == key && former.second < hits; });
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

void GlobalTracks::follow(const LocalReports& reports, const std::string& reporting) {
  if (reports.newest() < time_) entries_.clear();  // the trackers' stamps start again
  time_ = reports.newest();
  for (GlobalTrackEntry& entry : entries_) {
    entry.track.advance(time_);
    followReports(entry, reports, reporting);
    leaveOutBiased(entry);
  }
}

/// Renews the supporters from the reports.
void GlobalTracks::followReports(GlobalTrackEntry& entry, const LocalReports& reports,
                                 const std::string& reporting) {
  for (std::size_t i = entry.track.supporters().size(); i-- > 0;) {
    const LocalKey key = entry.track.supporters()[i].key;
    const std::uint32_t hits_before = entry.track.supporters()[i].track.hits;
    const LocalTrack* local = reports.find(key);
    // An established track does not become tentative: its tracker started again and gave the id to another.
    if (local == nullptr || local->track.status == TrackStatus::tentative) {
      if (entry.former.size() >= kMostFormer) entry.former.erase(entry.former.begin());
      if (local == nullptr) entry.former.emplace_back(key, hits_before);
      removeSupporter(entry, i);
      continue;
    }
    entry.track.setUnusable(i, reports.whyUnusable(key.tracker, *local));
    if (entry.track.supporters()[i].unusable || key.tracker != reporting) continue;
    LocalTrack honest = *local;
    honest.track.state.covariance *= entry.tracklets.noiseScale(key);
    const double surprise = entry.track.renew(i, honest);
    const bool is_another = local->track.hits < hits_before && surprise > thresholds_.contradict;
    if (is_another) removeSupporter(entry, i);
  }
}

void GlobalTracks::start(const LocalKey& key, const LocalTrack& local) {
  if (local.track.status != TrackStatus::confirmed) return;
  const auto before = std::find_if(entries_.begin(), entries_.end(), [&](const GlobalTrackEntry& entry) {
    return entry.track.supporters().empty() && hadSupporter(entry, key, local.track.hits);
  });
  if (before != entries_.end()) {
    before->track.join(key, local);
    return;
  }
  if (entries_.size() >= static_cast<std::size_t>(params_.max_tracks)) return;
  GlobalTrackEntry entry{GlobalTrack(next_id_++, time_, key, local, params_.process_noise),
                         TrackletFusion(params_.tracklets),
                         {},
                         {}};
  entry.report.track.id = entry.track.id();
  entries_.push_back(std::move(entry));
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
  const auto is_silent = [this](const GlobalTrackEntry& entry) {
    return seconds(time_ - entry.track.lastFusion()) > std::max(params_.delete_after, params_.remember);
  };
  entries_.erase(std::remove_if(entries_.begin(), entries_.end(), is_silent), entries_.end());
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
  time_ = {};
}

}  // namespace sightline::core
