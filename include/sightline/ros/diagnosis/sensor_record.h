#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <sightline/SightingArray.h>

#include "sightline/core/model/time.h"
#include "sightline/core/sensors/recent_values.h"

namespace sightline_ros {

/// Something that is wrong with the inputs, or worth knowing.
struct Finding {
  std::string subject;   ///< the sensor, topic or node
  std::string words;     ///< what, the value, and the remedy
  bool is_note = false;  ///< may be intended
};

/// Limits of the trackers, beyond which something is wrong.
struct InputLimits {
  double max_lag = 0.5;      ///< lateness up to which a scan is put in its place [s]
  double max_future = 0.1;   ///< by how much a stamp may be ahead of the clock [s]
  bool stand_apart = false;  ///< sensors at several places: what they see is not in one direction
};

/// The scans of one sensor over some time, as they were sent: neither turned nor tracked. The memory is
/// bounded.
class SensorRecord {
 public:
  /// A scan has come at `arrival`; 0 = the clock is not known.
  void take(const sightline::SightingArray& scan, sightline::core::Time arrival);

  /// A tracker's squared innovation over what it expects, of two angles.
  void takeInnovation(double distance_squared) { innovations_.add(distance_squared); }

  /// What is wrong with it, with values and remedies.
  std::vector<Finding> findings(const std::string& subject, const InputLimits& limits) const;

  std::size_t scans() const { return scans_; }
  std::size_t sightings() const { return sightings_; }
  const std::set<std::string>& frames() const { return frames_; }

  /// Whether more than half of its sightings cannot be used.
  bool isMostlyRefused() const { return 2 * refused_sightings_.count > sightings_; }

  /// From stamp to arrival: that of a share `p` of the scans is no larger [s].
  std::optional<double> latency(double p) const { return latencies_.quantile(p); }

  /// Between stamps [s], likewise.
  std::optional<double> interval(double p) const { return intervals_.quantile(p); }

  /// Median of the stated sigmas [rad].
  std::optional<double> statedSigma() const { return sigmas_.quantile(0.5); }

 private:
  struct Counted {
    std::size_t count = 0;
    std::string first;  // the first one, with value and remedy
  };

  void takeStamp(sightline::core::Time stamp, sightline::core::Time arrival);
  void takeSightings(const sightline::SightingArray& scan);
  std::string count(std::size_t number) const;
  std::optional<std::string> latencyText(const InputLimits& limits) const;
  std::optional<std::string> stampText(const InputLimits& limits) const;
  std::optional<std::string> duplicateText() const;
  std::optional<std::string> gapText() const;
  std::optional<std::string> emptyText() const;
  std::optional<std::string> innovationText() const;

  std::size_t scans_ = 0;
  std::size_t empty_ = 0;
  std::size_t sightings_ = 0;
  std::size_t stamped_ = 0;     // scans with a stamp
  std::size_t back_ = 0;        // stamps older than the one before
  double farthest_back_ = 0.0;  // [s]
  std::size_t repeated_ = 0;    // stamps like the one before
  double longest_gap_ = 0.0;    // between stamps [s]
  sightline::core::Time last_stamp_{};
  sightline::core::Time newest_stamp_{};
  sightline::core::RecentValues latencies_;
  sightline::core::RecentValues intervals_;
  sightline::core::RecentValues innovations_;
  sightline::core::RecentValues sigmas_;          // [rad]
  std::map<std::string, Counted> refused_scans_;  // by kind
  Counted refused_sightings_;
  std::set<std::string> frames_;
};

}  // namespace sightline_ros
