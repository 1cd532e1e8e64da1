#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sightline/core/fusion/association/tracker_misalignment.h"
#include "sightline/core/fusion/fusion_report.h"
#include "sightline/core/fusion/global_track.h"
#include "sightline/core/fusion/reports/local_reports.h"
#include "sightline/core/fusion/track_fusion_params.h"
#include "sightline/core/fusion/tracklets/tracklet_fusion.h"
#include "sightline/core/model/time.h"

namespace sightline::core {

/// A global track, the fusion of its supporters' tracklets, and what was last reported of it.
struct GlobalTrackEntry {
  GlobalTrack track;
  TrackletFusion tracklets;
  FusedTrack report;
  std::vector<std::pair<LocalKey, std::uint32_t>> former;  ///< local tracks that it had, with their hits then
};

/// Removes a supporter. Its later tracklets are not used; those since it began to contradict the others, or
/// to support the wrong global track, are taken back.
void removeSupporter(GlobalTrackEntry& entry, std::size_t supporter);

/// Supporters all of whose sensors are known to be biased do not count, and do not contradict.
void leaveOutBiased(GlobalTrackEntry& entry);

/// All global tracks at one time, and their life: started by a confirmed local track, continued when a local
/// track returns, merged when two of them are one target, deleted when nobody reports them any more.
class GlobalTracks {
 public:
  explicit GlobalTracks(const TrackFusionParams& params);

  /// Goes on with parameters that differ in what may change in flight (see whyNotInFlight).
  void reconfigure(const TrackFusionParams& wanted);

  Time time() const { return time_; }

  /// Ascending id. Indices hold until the next `merge`, `erase` or `deleteSilent`.
  std::vector<GlobalTrackEntry>& entries() { return entries_; }
  const std::vector<GlobalTrackEntry>& entries() const { return entries_; }

  /// Predicts every global track to the newest report and renews its supporters from the reports; removes
  /// those that their tracker does not report any more, or reports as another target. `new_reports`: since
  /// the last time. Starts again when the trackers' stamps do.
  void follow(const LocalReports& reports, const NewReports& new_reports);

  /// The global track without supporters that this local track supported last, and would continue; size() of
  /// the entries when there is none.
  std::size_t formerOf(const LocalKey& key, const LocalTrack& local) const;

  /// Continues the global track that this local track supported before, also when it was deleted meanwhile:
  /// under its id. Else starts one. Nothing is done unless the local track is confirmed and `max_tracks`
  /// allows it.
  void start(const LocalKey& key, const LocalTrack& local);

  /// Each pair of entries becomes one, under the older's id.
  void merge(const std::vector<std::pair<std::size_t, std::size_t>>& pairs,
             const TrackerMisalignment& misalignment);

  void erase(const std::vector<std::uint32_t>& ids);

  /// Deletes those that were not fused for so long that no local track may continue them.
  void deleteSilent();

  /// Ids of the tracker's tracks that support a global one, ascending.
  std::vector<std::uint32_t> supportersOf(const std::string& tracker) const;

  /// Forgets all but the next id.
  void reset();

 private:
  void followReports(GlobalTrackEntry& entry, const LocalReports& reports, const NewReports& new_reports);

  /// A local track of a global one that has been deleted.
  struct Retired {
    LocalKey key;
    std::uint32_t hits = 0;  // when it was reported last
    std::uint32_t id = 0;    // of the global track
  };

  void retire(const GlobalTrackEntry& entry);
  std::optional<std::uint32_t> retiredIdOf(const LocalKey& key, const LocalTrack& local);

  TrackFusionParams params_;
  DistanceThresholds thresholds_;
  Time time_{};
  std::uint32_t next_id_ = 1;
  std::vector<GlobalTrackEntry> entries_;
  std::deque<Retired> retired_;  // the last ones
};

}  // namespace sightline::core
