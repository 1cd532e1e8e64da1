#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sightline/core/local_tracker.h"
#include "sightline/core/time.h"
#include "sightline/core/tracklet.h"

namespace sightline::core {

/// A tracklet of one local track.
struct TrackTracklet {
  std::uint32_t track = 0;  ///< id of the local track
  Tracklet tracklet;
};

/// What is new in the sightings of one tracker's tracks.
struct TrackletReport {
  std::string tracker;
  Time time{};                ///< every sighting up to here is in this report or in an earlier one
  std::optional<Time> since;  ///< `time` of the report before; none: this is the tracker's first
  std::vector<TrackTracklet> tracklets;
};

struct TrackletParams {
  bool enabled = true;
  double interval = 0.0;  ///< time between reports [s], >= 0; 0 = with every scan
  CompressionParams compression;
};

/// Collects what a local tracker's tracks take, and says it as tracklets. Those of tentative tracks too, so
/// that a fusion which hears of a track knows all that the track knows. A late sighting makes a later
/// tracklet.
class TrackletBuilder {
 public:
  /// Throws std::invalid_argument for a parameter out of range.
  explicit TrackletBuilder(const TrackletParams& params);

  /// Takes a scan in the tracking frame, with what the tracker made of it. Returns a report (without the
  /// tracker's name) when one is due: when it would be overdue by the next scan, if that comes as soon as
  /// this one did.
  std::optional<TrackletReport> onScan(const Scan& scan, const ScanReport& tracked);

  /// What waits since `interval` before `now`, as no further scan came.
  std::optional<TrackletReport> onTime(Time now);

 private:
  using Key = std::pair<std::uint32_t, std::string>;  // track and sensor

  void collect(const Scan& scan, const ScanReport& tracked);
  TrackletReport report();

  TrackletParams params_;
  std::map<Key, std::vector<Tracklet>> pending_;  // in order of time
  std::size_t waiting_ = 0;                       // in `pending_`
  std::optional<Time> newest_, reported_;
};

}  // namespace sightline::core
