#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <sightline/AssociationArray.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>
#include <std_msgs/Header.h>
#include <tf2/buffer_core.h>

#include "sightline/core/model/time.h"
#include "sightline/core/sensors/view_overlap.h"
#include "sightline/ros/diagnosis/graph_view.h"
#include "sightline/ros/diagnosis/sensor_record.h"
#include "sightline/ros/diagnosis/track_starts.h"

namespace sightline_ros {

/// What all sensors sent over some time, and what is wrong with it: each sensor by itself, and one beside the
/// other. No node: scans are handed in.
class InputExamination {
 public:
  /// One line of the overview.
  struct Row {
    std::string sensor;
    std::string topic;
    const SensorRecord* record;
  };

  /// A scan of that topic, from that node, has arrived at `arrival`; 0 = the clock is not known.
  void take(const sightline::SightingArray& scan, const std::string& topic, const std::string& publisher,
            sightline::core::Time arrival);

  /// What a tracker did with a scan that was taken before, on the topic `.../associations` ...
  void take(const sightline::AssociationArray& associations, const std::string& topic);

  /// ... and what it tracks, on `.../tracks` beside it.
  void take(const sightline::TrackArray& tracks, const std::string& topic);

  /// Brings the newest scans into the tracking frame, while their transforms are known: for recordings whose
  /// transforms are not all kept. `findings` does so for those that are left.
  void turn(const tf2::BufferCore& transforms, const std::string& tracking_frame);

  std::vector<Row> sensors() const;

  /// What is wrong with the sensors, by name: what each of them sent, names that are not unique, frames
  /// without transform to the tracking frame, views that never overlap.
  /// Likewise sensors whose sightings start tracks that are never confirmed.
  std::vector<Finding> findings(const tf2::BufferCore& transforms, const std::string& tracking_frame,
                                const InputLimits& limits);

  /// Topics of sightings that are published, and brought nothing within `seconds`.
  std::vector<Finding> silentTopics(const GraphView& graph, double seconds) const;

 private:
  using Key = std::pair<std::string, std::string>;  // sensor, topic

  /// A sighting in the sensor's frame.
  struct Seen {
    Eigen::Vector2d angles;      // [rad]
    Eigen::Matrix2d covariance;  // [rad^2]
    bool is_usable = false;
    std::uint64_t track = 0;  // that took it, of any tracker (see `Tracker`); 0 = none
  };

  struct Shot {
    std_msgs::Header header;
    std::vector<Seen> sightings;  // in the order of the scan
    bool is_turned = false;       // with or without success:
    std::optional<Eigen::Matrix3d> R_tracking_sensor;
    std::string why;  // there is no transform
  };

  struct Source {
    SensorRecord record;
    std::set<std::string> publishers;
    std::vector<Shot> shots;  // every `every`th scan
    std::size_t every = 1;
  };

  /// A tracker's tracks are `number` << 32 and their id.
  struct Tracker {
    std::uint32_t number = 0;
    TrackStarts starts;
  };

  /// How a driver may have got its angles wrong.
  using Reading = Eigen::Vector2d (*)(const Eigen::Vector2d& angles);

  void keepShot(const sightline::SightingArray& scan, Source& source);
  static void turn(Shot& shot, const tf2::BufferCore& transforms, const std::string& tracking_frame);
  std::string subjectOf(const Key& key) const;
  void findSharedNames(std::vector<Finding>& found) const;
  void findTransforms(const tf2::BufferCore& transforms, const std::string& tracking_frame,
                      std::vector<Finding>& found) const;
  void findSeparateViews(std::vector<Finding>& found) const;
  void findScatter(std::vector<Finding>& found) const;
  void findStarts(std::vector<Finding>& found) const;
  static std::optional<double> scatterOf(const Source& source);
  static std::vector<sightline::core::Glimpse> glimpsesOf(const Source& source, Reading reading);

  std::map<Key, Source> sources_;
  std::map<std::string, Tracker> trackers_;  // by namespace
};

}  // namespace sightline_ros
