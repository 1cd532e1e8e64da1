#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sightline/core/model/time.h"
#include "sightline/core/model/tracklet.h"
#include "sightline/core/tracking/local_tracker.h"

namespace sightline::core {

/// The sightings of a scan in the tracking frame with which tracks have been updated, or were started, with
/// the noise that was used.
std::vector<TrackTracklet> sightingsTaken(const Scan& scan, const ScanReport& tracked);

struct TrackletParams {
  bool enabled = true;
  double interval = 0.0;  ///< time between reports [s], >= 0; 0 = with every scan
  CompressionParams compression;
};

/// Collects the sightings with which a local tracker's tracks are updated and reports them as tracklets:
/// those of tentative tracks too, so that a fusion that receives a track has all the information in it. A
/// late sighting makes a later tracklet.
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
