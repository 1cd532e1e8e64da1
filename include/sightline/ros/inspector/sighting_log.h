#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <sightline/AssociationArray.h>

#include "sightline/core/model/time.h"
#include "sightline/ros/inspector/recent_ring.h"

/// What trackers did with their sightings lately, and why.
namespace sightline_ros {

/// Names as numbers: the first ones get their own, all further ones share the last.
class NameTable {
 public:
  explicit NameTable(std::size_t most) : most_(most) {}

  std::uint16_t indexOf(const std::string& name);
  const std::vector<std::string>& names() const { return names_; }

 private:
  std::size_t most_;
  std::vector<std::string> names_;
};

/// One decision on one sighting. Single precision is enough for a picture.
struct SightingRecord {
  sightline::core::Time arrival{}, stamp{};
  std::uint32_t track = 0;              ///< id
  std::uint16_t space = 0, sensor = 0;  ///< of the log's tables: namespace of the tracker's topics; sensor
  std::uint32_t sighting = 0;           ///< index in its scan
  std::uint8_t decision = 0;            ///< as in the message
  std::array<float, 2> innovation{};    ///< [rad]
  std::array<float, 3> covariance{};    ///< of the innovation: (1, 1), (1, 2), (2, 2) [rad^2]
  float distance_squared = 0.0F, threshold = 0.0F;
  /// Of the sighting of the same scan that the track took [1]; NaN = it took none.
  float taken_instead = std::numeric_limits<float>::quiet_NaN();
};

/// "taken", "refused" or "started it".
std::string decisionWord(const SightingRecord& record);

/// The reason, with values: "distance squared 25.1 is beyond the gate's 13.8".
std::string reasonOf(const SightingRecord& record);

/// A local track by the namespace of its tracker's topics, and its id.
using TrackInSpace = std::pair<std::string, std::uint32_t>;

/// "/groups/tracking/tracks" -> "/groups/tracking": what a tracker's topics have in common.
std::string spaceOf(const std::string& topic);

/// Decisions on sightings, of all tracks for as long as there is room, and of followed tracks in a ring of
/// their own, so that others do not crowd theirs out.
class SightingLog {
 public:
  static constexpr double kSpan = 60.0;                ///< of arrival that is kept [s]
  static constexpr std::size_t kMost = 400000;         ///< of all tracks, 26 MB
  static constexpr std::size_t kMostFollowed = 20000;  ///< of the followed ones, 1.3 MB

  SightingLog() : all_(kMost, kSpan), followed_(kMostFollowed, kSpan), spaces_(256), sensors_(256) {}

  /// Decisions without a track are left out: `SensorBoard` counts them.
  void take(const std::string& topic, const sightline::AssociationArray& decisions,
            sightline::core::Time arrival);

  /// From now on these tracks are followed; what is known of them already is copied once.
  void follow(const std::set<TrackInSpace>& tracks);

  void clear();

  const RecentRing<SightingRecord>& followed() const { return followed_; }
  std::size_t size() const { return all_.size(); }
  const std::vector<std::string>& sensors() const { return sensors_.names(); }
  const std::vector<std::string>& spaces() const { return spaces_.names(); }

 private:
  using Key = std::pair<std::uint16_t, std::uint32_t>;

  RecentRing<SightingRecord> all_, followed_;
  NameTable spaces_, sensors_;
  std::set<Key> keys_;  // of followed tracks
};

}  // namespace sightline_ros
