#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <diagnostic_updater/DiagnosticStatusWrapper.h>

#include "sightline/core/model/time.h"
#include "sightline/core/ordering/stamp_watch.h"
#include "sightline/core/sensors/recent_values.h"
#include "sightline/ros/components/local_tracker_component.h"
#include "sightline/ros/diagnosis/sensor_record.h"
#include "sightline/ros/diagnosis/track_starts.h"
#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {

/// The first reason that an association gives for rejecting a sighting; empty when none is rejected.
std::string firstRejection(const sightline::AssociationArray& associations);

/// What is reported to an operator about a local tracker: rates and latencies by sensor, drops by reason, age
/// of the last sighting, tracks by status. Times are the clock's, handed in.
class LocalTrackerHealth {
 public:
  /// `silence`: without a scan for so long the tracker is reported as starved [s]. `limits`: what the tracker
  /// bears.
  explicit LocalTrackerHealth(double silence, InputLimits limits = {}) : silence_(silence), limits_(limits) {}

  /// A scan has arrived at `now`, whatever becomes of it; 0 = the clock is not known.
  void noteArrival(const sightline::SightingArray& scan, sightline::core::Time now);

  void note(const TrackerReport& report);

  /// A line to warn with, when the report holds something to complain of that was not complained of lately:
  /// at most one in five seconds of `now` for each reason.
  std::optional<std::string> warningAbout(const TrackerReport& report, sightline::core::Time now);

  /// Lines to log for the changes of sensors in a report: each at once, but of one sensor at most one in five
  /// seconds of `now`; what was held back is counted in the next.
  std::vector<std::string> sensorLines(const TrackerReport& report, sightline::core::Time now);

  /// Lines to log for clocks that were found wrong, or right again, since the last call.
  std::vector<std::string> clockLines(const std::vector<sightline::core::WatchedSensor>& watched);

  /// Fills a diagnostic status; rates and the level are over the time since the last call. `watched`: what
  /// the tracker thinks of its sensors; one that is not healthy is a warning. `calibrated`: what it has
  /// learnt of their noise; one that is much rougher than it states is a warning. `stamps`: how theirs stand
  /// to the others'; one that does not agree is a warning. `detection`: what it has learnt of how they see.
  /// A sensor whose sightings start tracks that are never confirmed is a warning, unless they lie about as
  /// false ones do.
  void diagnose(sightline::core::Time now, std::size_t waiting,
                diagnostic_updater::DiagnosticStatusWrapper& status,
                const std::vector<sightline::core::WatchedSensor>& watched = {},
                const std::vector<sightline::core::CalibratedSensor>& calibrated = {},
                const std::vector<sightline::core::WatchedStamps>& stamps = {},
                const std::vector<sightline::core::CalibratedDetection>& detection = {});

 private:
  struct Sensor {
    std::uint64_t scans = 0;
    std::uint64_t sightings = 0;
    std::uint64_t scans_before = 0;  // at the last diagnosis
    sightline::core::Time last_scan{};
    sightline::core::Time last_sighting{};
    std::map<std::string, std::uint64_t> drops;     // scans, by reason
    std::map<std::string, std::string> last_drops;  // likewise, the last one's frame, values and remedy
    sightline::core::RecentValues latency;          // from stamp to arrival
    SensorRecord record;                            // of the last seconds
    std::vector<Finding> findings;                  // of the seconds before
  };
  struct Counted {
    std::uint64_t count = 0;
    std::uint64_t count_before = 0;  // at the last diagnosis
    std::uint64_t count_warned = 0;  // at the last warning
    std::optional<sightline::core::Time> last_warning;
  };

  Sensor& sensorOf(const std::string& name);
  void examine(sightline::core::Time now);
  void addStarts(diagnostic_updater::DiagnosticStatusWrapper& status) const;
  void addSensor(const std::string& name, const Sensor& sensor, sightline::core::Time now, double elapsed,
                 diagnostic_updater::DiagnosticStatusWrapper& status) const;
  void summarize(sightline::core::Time now, diagnostic_updater::DiagnosticStatusWrapper& status) const;
  std::string latestDrops() const;

  double silence_;
  InputLimits limits_;
  std::map<std::string, Sensor> sensors_;
  TrackStarts starts_;
  std::map<std::string, bool> wrong_clocks_;  // by sensor, as last logged
  std::map<std::string, Counted> changes_;    // by sensor
  std::map<std::string, Counted> drops_;      // by reason; rejected sightings are one of them
  std::array<std::uint64_t, 3> tracks_{};     // by status, in the last report
  std::optional<sightline::core::Time> last_diagnosis_;
  std::optional<sightline::core::Time> last_examination_;
};

}  // namespace sightline_ros
