#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <sightline/AssociationArray.h>
#include <sightline/TrackArray.h>

#include "sightline/core/model/time.h"
#include "sightline/core/sensors/recent_values.h"
#include "sightline/core/sensors/scatter.h"
#include "sightline/ros/diagnosis/sensor_record.h"

namespace sightline_ros {

/// What becomes of the sightings that start tracks, of the sensors of one tracker: whether any of these
/// tracks is confirmed, and if none is, why that may be. The memory is bounded.
class TrackStarts {
 public:
  /// What became of a scan.
  void take(const sightline::AssociationArray& associations);

  /// What the tracker tracks; after the associations of the same scan, or before.
  void take(const sightline::TrackArray& tracks);

  ///  /// By sensor, what is to be said of it. A note where its sightings lie about as false ones do, and no
  /// confirmed track ever took one: then there may be no target. Nothing for a sensor of which a confirmed
  /// track has taken a sighting lately.
  std::map<std::string, std::optional<Finding>> findings() const;

 private:
  /// Since a confirmed track has taken a sighting of the sensor last.
  struct Sensor {
    bool was_used = false;  // by a confirmed track, ever
    std::size_t sightings = 0;
    std::size_t started = 0;
    std::size_t compared = 0, near = 0;  // starts, and those that lie nearer to the last than to an old one
    std::array<Eigen::Vector3d, 8> last{};  // directions of the last starts, the next goes to located % 8
    std::size_t located = 0;                // starts with a direction
    sightline::core::Time last_start{};
    sightline::core::RecentValues intervals;  // between scans that start tracks [s]
    sightline::core::RecentValues steps;      // from one start to the next [rad]
    sightline::core::RecentValues sigmas;     // stated [rad]
    sightline::core::Scatter scatter;
    sightline::core::Scatter::Chain chain;
  };
  struct Start {
    std::string sensor;
    sightline::core::Time time{};
    bool is_located = false;
    sightline::core::Time last_seen{};  // of the last report that has the track
  };

  /// A track with one sighting.
  struct Place {
    Eigen::Vector2d angles;      // [rad]
    Eigen::Matrix2d covariance;  // [rad^2]
  };

  bool isUsed(const sightline::AssociationArray& associations) const;
  static void noteUse(Sensor& sensor);
  static Place placeOf(const sightline::Track& track);
  static void locate(Sensor& sensor, const Place& place, sightline::core::Time time);
  static std::optional<Finding> findingOf(const std::string& name, const Sensor& sensor);

  std::map<std::string, Sensor> sensors_;
  std::map<std::uint32_t, Start> pending_;  // started tracks that are not confirmed yet
  std::map<std::uint32_t, Place> places_;   // of the tracks with one sighting in the last report
  std::vector<std::uint32_t> established_;  // in the last report, ascending
};

}  // namespace sightline_ros
