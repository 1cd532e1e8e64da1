#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "sightline/core/fusion/association/supporter_assignment.h"
#include "sightline/core/fusion/association/tracker_misalignment.h"
#include "sightline/core/fusion/global_tracks.h"
#include "sightline/core/fusion/reports/local_reports.h"
#include "sightline/core/fusion/track_fusion_params.h"
#include "sightline/core/fusion/tracklets/tracklet_memory.h"

namespace sightline::core {

/// Decides which local track supports which global track. Remembered between reports: the misalignment
/// between trackers, and local tracks that wait for a supporter's place.
class TrackAssociation {
 public:
  explicit TrackAssociation(const TrackFusionParams& params);

  /// Goes on with parameters that differ in what may change in flight (see whyNotInFlight).
  void reconfigure(const TrackFusionParams& wanted);

  /// Learns from how far the reporting tracker's tracks are from the other trackers' estimates.
  void learnMisalignment(const GlobalTracks& tracks, const std::string& reporting);

  /// Supporters that contradict the others do not count; those that have contradicted them for `leave_after`
  /// are removed, unless a biased sensor explains it.
  void splitContradicting(GlobalTracks& tracks, const TrackletMemory& memory,
                          const NewReports& new_reports) const;

  /// Moves those of the tracker's supporters that have supported the wrong global track for `leave_after`
  /// (their tracker took one target for another, or started a second track), all of a group at once. A free
  /// local track whose place another one still has waits, and does not start a global track meanwhile.
  void reassign(GlobalTracks& tracks, const LocalReports& reports, const TrackletMemory& memory,
                const std::string& tracker);

  /// Finds a global track for each free local track of the tracker, by optimal assignment; with `merge` also
  /// for the global tracks that it supports already, which then become one with the one found. A local track
  /// for which none is found starts a global track, unless it is what a biased sensor shows of the target of
  /// one that its tracker has supported: then it supports that, and contradicts, or waits for the place.
  void associate(GlobalTracks& tracks, const LocalReports& reports, const TrackletMemory& memory,
                 const std::string& tracker, bool merge);

  /// Free local tracks whose place another supporter still has: the global track's id.
  const std::map<LocalKey, std::uint32_t>& waiting() const { return waiting_; }

  void reset();

 private:
  using FreeTracks = std::vector<std::pair<LocalKey, LocalTrack>>;

  FreeTracks freeTracksOf(const GlobalTracks& tracks, const LocalReports& reports,
                          const std::string& tracker) const;
  std::vector<SupporterMove> misplacedOf(GlobalTracks& tracks, const LocalReports& reports,
                                         const std::string& tracker) const;
  bool isDue(const std::vector<SupporterMove>& moves, const GlobalTracks& tracks) const;
  void move(const std::vector<SupporterMove>& moves, GlobalTracks& tracks, const LocalReports& reports,
            const TrackletMemory& memory) const;
  void wait(const std::vector<SupporterMove>& moves, const GlobalTracks& tracks);
  void start(const LocalKey& key, GlobalTracks& tracks, const LocalReports& reports,
             const TrackletMemory& memory);

  TrackFusionParams params_;
  DistanceThresholds thresholds_;
  TrackerMisalignment misalignment_;
  std::map<LocalKey, std::uint32_t> waiting_;
};

}  // namespace sightline::core
