#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "sightline/core/association.h"
#include "sightline/core/estimators.h"
#include "sightline/core/gate.h"
#include "sightline/core/live_track.h"
#include "sightline/core/sighting.h"
#include "sightline/core/track.h"

namespace sightline::core {

struct LocalTrackerParams {
  EstimatorParams estimator;
  GateParams gate;
  bool adapt_gate = true;  ///< enlarge S by the innovations seen, where they are larger than S explains
  LifecycleParams lifecycle;
  double max_lag = 0.5;  ///< scans up to this much older than the newest are put in their place [s], >= 0
  int max_tracks = 500;  ///< no track is started beyond, >= 1
  int max_sightings = 10000;  ///< of one scan; the rest is rejected, >= 1
};

/// What a tracker says after a scan.
struct ScanReport {
  Time time{};                            ///< of `tracks`: the newest scan's
  std::vector<Track> tracks;              ///< ascending id, in the tracking frame, valid at `time`
  std::vector<Association> associations;  ///< one for each sighting of this scan, in its order
  double noise_scale = 1.0;               ///< factor on the variances with which the sightings were used
  std::string dropped;                    ///< why the scan was not used (late, duplicate); empty if it was
  std::string notice;  ///< what else an operator must know (the clock went back); mostly empty
};

/// Tracks targets with the sightings of one sensor or of several. Scans come in the tracking frame, in any
/// order within `max_lag`: for a late one the tracker goes back and tracks again from there, so that the
/// state after it is the same as in order, to the last bit. Ids of tracks that had been started after the
/// late scan may be given anew by this.
class LocalTracker {
 public:
  explicit LocalTracker(const LocalTrackerParams& params);

  /// Takes a scan. Never throws for what is in it: unusable sightings are rejected one by one, with their
  /// reason. Twenty scans in a row that are more than 5 s late mean that the clock went back (a recording
  /// started again): the tracks are given up, said in `notice`, and tracking goes on at the new time.
  ScanReport onScan(const Scan& scan);

 private:
  /// Everything that a scan changes.
  struct State {
    Time time{};
    std::uint32_t next_id = 1;
    std::vector<LiveTrack> tracks;  // ascending id
  };

  /// A scan before which another may still have to be put, and now and then the state before it.
  struct Remembered {
    Scan scan;
    std::unique_ptr<State> before;
  };

  std::string refusalOf(const Scan& scan) const;
  bool clockWentBack(const Scan& scan);
  void startAnew(Time time);

  std::vector<Association> putInPlace(const Scan& scan);
  std::vector<Association> follow(const Scan& scan);
  bool isStateDue(std::size_t k) const;
  void forgetOldScans();

  std::vector<Expectation> predict(Time time);
  void update(const Scan& scan, const std::vector<Expectation>& expectations, const Pairing& pairing);
  void start(const Scan& scan, Pairing& pairing);
  void giveUpTheDead(Time time);
  std::vector<Track> report() const;

  LocalTrackerParams params_;
  State state_;
  std::deque<Remembered> remembered_;  // in order of time; the first one has its state
  int late_in_a_row_ = 0;
};

}  // namespace sightline::core
