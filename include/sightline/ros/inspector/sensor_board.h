#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <sightline/AssociationArray.h>
#include <sightline/FusionReport.h>

#include "sightline/core/model/time.h"

/// What trackers and the fusion say of each sensor, side by side.
namespace sightline_ros {

/// One node's opinion of one sensor, in its own words; empty where it says nothing.
struct SensorRow {
  std::string sensor;
  std::string by;         ///< name of the node, or topic of the report
  std::string verdict;    ///< healthy, noisy or biased, since when, noticed when, and the consequence
  std::string noise;      ///< found over stated
  std::string bias;       ///< in sigmas
  std::string clock;      ///< offset, stamps and latency
  std::string detection;  ///< and what is wrong with its input
  bool is_suspect = false;
  double silence = 0.0;  ///< since this was said [s]
};

/// A verdict that changed.
struct VerdictChange {
  sightline::core::Time time{};  ///< when the panel heard of it, ROS's clock
  std::string sensor, by, words;
};

/// Bounded: so many rows and so many changes, whatever comes.
class SensorBoard {
 public:
  static constexpr std::size_t kMostRows = 512;
  static constexpr std::size_t kMostChanges = 200;

  /// Statuses of local trackers; others say nothing of sensors and are passed over.
  void take(const diagnostic_msgs::DiagnosticArray& diagnostics, sightline::core::Time now);

  /// Of a sensor in several tracks the worst is shown.
  void take(const std::string& topic, const sightline::FusionReport& report, sightline::core::Time now);

  /// Counts sightings that were rejected as input.
  void take(const std::string& topic, const sightline::AssociationArray& decisions,
            sightline::core::Time now);

  void clear();

  std::vector<SensorRow> rows(sightline::core::Time now) const;          ///< by sensor, then by node
  const std::deque<VerdictChange>& changes() const { return changes_; }  ///< the newest last

 private:
  struct Opinion {
    SensorRow row;
    sightline::core::Time time{};
    std::map<std::string, std::string> said;  // by kind: guard, noise, clock, ...
    std::uint64_t rejected = 0;
  };

  Opinion* opinionOf(const std::string& sensor, const std::string& by);
  void note(sightline::core::Time now, const std::string& sensor, const std::string& by,
            const std::string& words);

  std::map<std::pair<std::string, std::string>, Opinion> opinions_;  // by sensor and node
  std::deque<VerdictChange> changes_;
};

}  // namespace sightline_ros
