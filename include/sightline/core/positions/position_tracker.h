#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "sightline/core/model/refusal.h"
#include "sightline/core/model/time.h"
#include "sightline/core/ordering/timeline.h"
#include "sightline/core/positions/position_scene.h"
#include "sightline/core/positions/position_track.h"

namespace sightline::core {

struct PositionTrackerParams {
  PositionSceneParams scene;
  double max_lag = 1.0;  ///< what comes by so much later than the newest is put in its place [s], >= 0
};

/// Positions of targets from the local tracks and tracklets of stations that stand apart. Tracks and
/// tracklets come in any order within `max_lag`: what is late is put in its place, and all from there is
/// processed again, so that the output is the same to the last bit. Work is done when a report is asked for.
class PositionTracker {
 public:
  /// Throws std::invalid_argument for a parameter out of range.
  explicit PositionTracker(const PositionTrackerParams& params = {});

  /// Returns why they are not used: late, duplicate, invalid, limit (too many names of trackers or sensors).
  std::optional<Refusal> onTracks(const StationTracks& tracks);

  /// Of each tracklet that is not used, why.
  std::vector<Refusal> onTracklets(const std::vector<StationTracklet>& tracklets);

  /// The positions at the time of the newest tracks or tracklets, of whatever station: those of another may
  /// come late. Nothing before the first tracks.
  std::optional<PositionOutput> report();

  /// From now on keeps what targets are updated with, for a smoother; it must be handed out after reports.
  void keepMeasurements() { scene_.keepMeasurements(); }

  /// The measurements that no late message can change any more, and that have not been handed out before;
  /// `all`: those that one could as well, when there will be no further message.
  std::vector<TakenMeasurement> handOut(bool all = false);

 private:
  struct Item {
    Time time{};
    std::variant<StationTracklet, StationTracks> what;  // in this order at one time

    friend Time timeOf(const Item& item) { return item.time; }
    bool isBefore(const Item& other) const;
    friend bool precedes(const Item& a, const Item& b) { return a.isBefore(b); }
  };
  struct NoUse {};

  std::optional<Refusal> insert(Item item);
  std::optional<Refusal> admit(const std::string& tracker, const std::string& sensor);

  double max_lag_;
  Timeline<Item, NoUse, PositionScene> items_;
  PositionScene scene_;                                  // has taken the items before the timeline's next
  std::optional<Time> closed_;                           // nothing can be put before it
  Time handed_out_ = Time::min();                        // measurements taken before it have been handed out
  std::optional<Time> newest_;                           // of all items
  bool has_tracks_ = false;                              // whether tracks have been taken
  std::set<std::pair<std::string, std::string>> names_;  // of trackers and sensors that have been admitted
};

}  // namespace sightline::core
