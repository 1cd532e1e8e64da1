#include "fuzz/fuzz_targets.h"

namespace sightline_fuzz {

const std::vector<FuzzTarget>& coreTargets() {
  static const std::vector<FuzzTarget> targets = {
      {"local_tracker", "LocalTracker and TrackletBuilder: scans of every make", fuzzLocalTracker},
      {"arrival_order", "LocalTracker: the same bytes for scans in any order within max_lag",
       fuzzArrivalOrder},
      {"track_fusion", "TrackFusion: reports and tracklets of every make", fuzzTrackFusion},
      {"fused_trackers", "TrackFusion behind local trackers, with losses and delays between",
       fuzzFusedTrackers},
      {"position_tracker", "PositionTracker: tracks and tracklets of every make", fuzzPositionTracker},
      {"position_order", "PositionTracker: the same bytes for any order within max_lag",
       fuzzPositionArrivalOrder},
      {"formats", "readers of other programs' files: changed and cut files", fuzzFormats},
      {"csv_tables", "CSV tables of this package: changed and cut files", fuzzCsvTables},
  };
  return targets;
}

}  // namespace sightline_fuzz
