#include "sightline/core/fusion/association/track_association.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "sightline/core/association/assignment.h"
#include "sightline/core/fusion/association/association_costs.h"
#include "sightline/core/fusion/contributors.h"
#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr std::size_t kMostCompared = 30;  // tracks of a report that show their tracker's misalignment
constexpr double kMostBias = 6.0;          // of a sensor that still sees the same target [sigma] ...
constexpr double kTrackSigmas = 3.0;       // ... and as many of the tracks' own
constexpr int kLeastWitnesses = 2;         // other trackers that agree on where the target is

/// How far a tracker's supporter is from the others' estimate; nullopt where there is none to compare.
std::optional<Disagreement> disagreementOf(const GlobalTrack& track, const std::string& tracker) {
  const std::size_t number = track.numberOf(tracker);
  if (number >= track.supporters().size()) return std::nullopt;
  const Supporter& supporter = track.supporters()[number];
  const bool contradicts = supporter.contradicts_since.has_value();
  if (supporter.unusable && !contradicts) return std::nullopt;
  const std::optional<Estimate<4>> others = track.opinionWithout(tracker);
  if (!others) return std::nullopt;
  const Estimate<4> says = track.estimateOf(number);
  const Eigen::Vector2d apart = angleDifference(says.mean.head<2>(), others->mean.head<2>());
  const Eigen::Matrix2d S = (says.covariance + others->covariance).topLeftCorner<2, 2>();
  return Disagreement{apart.squaredNorm(), 0.5 * S.trace()};
}

/// Standard deviation of the sightings behind the last tracklet of a local track [rad]; nullopt without any.
std::optional<double> sightingSigma(const LocalKey& key, const TrackletMemory& memory) {
  const auto* remembered = memory.find(key);
  if (remembered == nullptr || remembered->empty()) return std::nullopt;
  const Tracklet& last = remembered->back().tracklet;
  return std::sqrt(0.5 * last.sighting.covariance.trace() * std::max(last.sightings, 1.0));
}

/// Whether a local track is so near to a global one that two other trackers agree on that a biased sensor
/// would show that target there: two targets that its own tracker does not tell apart.
bool isExplainedByBias(const GlobalTrack& track, const LocalKey& key, const LocalTrack& local,
                       const TrackletMemory& memory) {
  const std::optional<double> sigma = sightingSigma(key, memory);
  const std::vector<std::size_t> usable = track.usable();
  const auto others = std::count_if(usable.begin(), usable.end(), [&](std::size_t number) {
    return track.supporters()[number].key.tracker != key.tracker;
  });
  if (!sigma || others < kLeastWitnesses) return false;
  const std::optional<Estimate<4>> opinion = track.opinionWithout(key.tracker);
  const Eigen::Vector2d place = track.chart().coordinatesOf(directionOf(local.track.state.angles()));
  if (!opinion || !track.chart().holds(place)) return false;
  const Estimate<4> says = track.estimateOf(local, track.time());
  const double unsure = std::sqrt((says.covariance + opinion->covariance).topLeftCorner<2, 2>().trace());
  const Eigen::Vector2d apart = angleDifference(says.mean.head<2>(), opinion->mean.head<2>());
  return apart.norm() <= kMostBias * *sigma + kTrackSigmas * unsure;
}

/// Whether the local track's tracker has seen the target of a global track, and has not seen both in one
/// scan: they may be one target, which its sensor shows elsewhere.
bool mayBeBiasedViewOf(const GlobalTrackEntry& entry, const LocalKey& key, const LocalTrack& local) {
  const std::size_t number = entry.track.numberOf(key.tracker);
  if (number < entry.track.supporters().size()) {
    const Supporter& supporter = entry.track.supporters()[number];
    return supporter.unusable || supporter.local.track.last_sighting != local.track.last_sighting;
  }
  return std::any_of(entry.former.begin(), entry.former.end(),
                     [&](const auto& former) { return former.first.tracker == key.tracker; });
}

/// The ids of global tracks without supporters that one of these moves has left for another.
std::vector<std::uint32_t> leftBy(const std::vector<SupporterMove>& moves,
                                  const std::vector<GlobalTrackEntry>& entries) {
  std::vector<std::uint32_t> left;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const bool is_left = entries[i].track.supporters().empty() &&
                         std::any_of(moves.begin(), moves.end(),
                                     [i](const SupporterMove& it) { return it.present == i && it.best; });
    if (is_left) left.push_back(entries[i].track.id());
  }
  return left;
}

}  // namespace

TrackAssociation::TrackAssociation(const TrackFusionParams& params)
    : params_(params), thresholds_(thresholdsOf(params)), misalignment_(params.registration_sigma) {}

void TrackAssociation::reconfigure(const TrackFusionParams& wanted) {
  params_ = wanted;
  thresholds_ = thresholdsOf(wanted);
}

void TrackAssociation::learnMisalignment(const GlobalTracks& tracks, const std::string& reporting) {
  std::vector<Disagreement> disagreements;
  for (const GlobalTrackEntry& entry : tracks.entries()) {
    if (disagreements.size() >= kMostCompared) break;
    if (const auto disagreement = disagreementOf(entry.track, reporting))
      disagreements.push_back(*disagreement);
  }
  misalignment_.take(reporting, disagreements);
}

void TrackAssociation::splitContradicting(GlobalTracks& tracks, const TrackletMemory& memory,
                                          const NewReports& new_reports) const {
  for (GlobalTrackEntry& entry : tracks.entries()) {
    const std::vector<std::size_t> contradicting =
        entry.track.leaveOutContradictions(misalignment_, thresholds_.contradict, new_reports);
    for (auto number = contradicting.rbegin(); number != contradicting.rend(); ++number) {
      const Supporter& supporter = entry.track.supporters()[*number];
      // By its own reports: a prediction that grows old is no new evidence.
      const bool lasts = seconds(supporter.local.time - *supporter.contradicts_since) >= params_.leave_after;
      if (lasts && !isExplainedByBias(entry.track, supporter.key, supporter.local, memory))
        removeSupporter(entry, *number);
    }
  }
}

void TrackAssociation::reassign(GlobalTracks& tracks, const LocalReports& reports,
                                const TrackletMemory& memory, const std::string& tracker) {
  for (auto it = waiting_.begin(); it != waiting_.end();)
    it = it->first.tracker == tracker ? waiting_.erase(it) : std::next(it);

  const std::vector<SupporterMove> misplaced = misplacedOf(tracks, reports, tracker);
  for (auto first = misplaced.begin(); first != misplaced.end();) {
    const auto last = std::find_if(first, misplaced.end(),
                                   [first](const SupporterMove& it) { return it.group != first->group; });
    const std::vector<SupporterMove> group(first, last);
    if (isDue(group, tracks)) {
      move(group, tracks, reports, memory);
    } else {
      wait(group, tracks);
    }
    first = last;
  }
  tracks.erase(leftBy(misplaced, tracks.entries()));
}

/// By group; each remembers since when it is. One that has no better place stays as long as nobody wants its.
std::vector<SupporterMove> TrackAssociation::misplacedOf(GlobalTracks& tracks, const LocalReports& reports,
                                                         const std::string& tracker) const {
  std::vector<const GlobalTrack*> candidates;
  for (const GlobalTrackEntry& entry : tracks.entries()) candidates.push_back(&entry.track);
  const std::vector<SupporterMove> moves =
      supporterMoves(tracker, freeTracksOf(tracks, reports, tracker), candidates,
                     {thresholds_.join, misalignment_.sigma(tracker)});

  const auto isWanted = [&moves](std::size_t place) {
    return std::any_of(moves.begin(), moves.end(),
                       [place](const SupporterMove& it) { return it.best == place && it.present != place; });
  };
  std::vector<SupporterMove> misplaced;
  for (const SupporterMove& it : moves) {
    if (!it.isRight() && (it.best || isWanted(*it.present))) misplaced.push_back(it);
  }
  for (std::size_t i = 0; i < tracks.entries().size(); ++i) {
    GlobalTrack& track = tracks.entries()[i].track;
    if (!track.hasTracker(tracker)) continue;
    track.setMisplaced(track.numberOf(tracker),
                       std::any_of(misplaced.begin(), misplaced.end(),
                                   [i](const SupporterMove& it) { return it.present == i; }));
  }
  return misplaced;
}

/// Whether one of the group has been misplaced for `leave_after`.
bool TrackAssociation::isDue(const std::vector<SupporterMove>& moves, const GlobalTracks& tracks) const {
  return std::any_of(moves.begin(), moves.end(), [&](const SupporterMove& it) {
    if (!it.present) return false;
    const GlobalTrack& track = tracks.entries()[*it.present].track;
    const Supporter& supporter = track.supporters()[track.numberOf(it.key.tracker)];
    return seconds(supporter.local.time - *supporter.misplaced_since) >= params_.leave_after;
  });
}

/// First all leave, then each joins. The tracklets of a moved track since it was misplaced are taken back
/// from the global track that it leaves, and those before are not used in the one that it joins.
void TrackAssociation::move(const std::vector<SupporterMove>& moves, GlobalTracks& tracks,
                            const LocalReports& reports, const TrackletMemory& memory) const {
  std::vector<std::optional<Time>> since(moves.size());
  for (std::size_t k = 0; k < moves.size(); ++k) {
    if (!moves[k].present) continue;
    GlobalTrackEntry& entry = tracks.entries()[*moves[k].present];
    const std::size_t number = entry.track.numberOf(moves[k].key.tracker);
    since[k] = entry.track.supporters()[number].misplaced_since;
    removeSupporter(entry, number);
  }
  for (std::size_t k = 0; k < moves.size(); ++k) {
    if (!moves[k].best) continue;
    const LocalTrack& local = *reports.find(moves[k].key);
    if (local.invalid) continue;  // what it says now is of no track: it is free until it says more
    GlobalTrackEntry& entry = tracks.entries()[*moves[k].best];
    if (since[k]) entry.tracklets.passOver(moves[k].key, *since[k], memory);
    entry.track.join(moves[k].key, local);
    entry.track.compareSupporters(misalignment_);
  }
}

/// The free ones of the group that should have a place which another still has wait for it.
void TrackAssociation::wait(const std::vector<SupporterMove>& moves, const GlobalTracks& tracks) {
  for (const SupporterMove& it : moves) {
    if (it.present || !it.best) continue;
    const GlobalTrack& track = tracks.entries()[*it.best].track;
    if (track.hasTracker(it.key.tracker)) waiting_[it.key] = track.id();
  }
}

void TrackAssociation::associate(GlobalTracks& tracks, const LocalReports& reports,
                                 const TrackletMemory& memory, const std::string& tracker, bool merge) {
  std::vector<AssignedRow> rows;
  for (const auto& [key, local] : freeTracksOf(tracks, reports, tracker))
    rows.push_back({key, tracks.formerOf(key, local), local});
  if (rows.empty() && !merge) return;
  const CostContext context{tracks, misalignment_, thresholds_.join};
  const std::vector<GlobalTrackEntry>& entries = tracks.entries();
  std::vector<std::size_t> columns, supported;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (seconds(tracks.time() - entries[i].track.lastFusion()) > params_.delete_after) continue;
    (entries[i].track.hasTracker(tracker) ? supported : columns).push_back(i);
  }
  for (const std::size_t i : supported) {
    if (!merge) break;
    const GlobalTrack& track = entries[i].track;
    const bool has_neighbour = std::any_of(columns.begin(), columns.end(), [&](std::size_t column) {
      return !entries[column].track.supporters().empty() && areNear(track, entries[column].track, context);
    });
    if (!has_neighbour) continue;
    const Estimate<4> estimate = track.opinion();
    LocalTrack as_one;
    as_one.track.state = track.chart().toTracking({estimate.mean, estimate.covariance});
    as_one.time = tracks.time();
    rows.push_back({{}, i, as_one});
  }
  if (rows.empty()) return;

  const Costs costs = costsOf(rows, columns, context);
  const std::vector<int> found = assign(costs.pairs, costs.alone);
  std::vector<std::pair<std::size_t, std::size_t>> same;
  std::vector<LocalKey> alone;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const std::optional<LocalKey>& key = rows[row].key;
    if (found[row] < 0) {
      if (key) alone.push_back(*key);
      continue;
    }
    const std::size_t entry = columns[static_cast<std::size_t>(found[row])];
    if (key) {
      tracks.entries()[entry].track.join(*key, *reports.find(*key));
      tracks.entries()[entry].track.compareSupporters(misalignment_);
    } else {
      same.emplace_back(rows[row].entry, entry);
    }
  }
  tracks.merge(same, misalignment_);
  for (const LocalKey& key : alone) start(key, tracks, reports, memory);
}

void TrackAssociation::start(const LocalKey& key, GlobalTracks& tracks, const LocalReports& reports,
                             const TrackletMemory& memory) {
  const LocalTrack& local = *reports.find(key);
  for (GlobalTrackEntry& entry : tracks.entries()) {
    if (!mayBeBiasedViewOf(entry, key, local) || !isExplainedByBias(entry.track, key, local, memory))
      continue;
    if (entry.track.hasTracker(key.tracker)) {
      waiting_[key] = entry.track.id();
    } else {
      entry.track.join(key, local);
      entry.track.leaveOutContradictions(misalignment_, thresholds_.contradict, {{key.tracker, 1}});
    }
    return;
  }
  tracks.start(key, local);
}

/// Usable tracks of the tracker that support no global one and do not wait for a place.
TrackAssociation::FreeTracks TrackAssociation::freeTracksOf(const GlobalTracks& tracks,
                                                            const LocalReports& reports,
                                                            const std::string& tracker) const {
  FreeTracks free;
  const std::vector<std::uint32_t> supporters = tracks.supportersOf(tracker);
  for (const auto& [id, local] : reports.trackers().at(tracker).tracks) {
    if (std::binary_search(supporters.begin(), supporters.end(), id)) continue;
    if (reports.whyUnusable(tracker, local) || waiting_.count({tracker, id}) > 0) continue;
    free.emplace_back(LocalKey{tracker, id}, local);
  }
  return free;
}

void TrackAssociation::reset() {
  waiting_.clear();
  misalignment_ = TrackerMisalignment(params_.registration_sigma);
}

}  // namespace sightline::core
