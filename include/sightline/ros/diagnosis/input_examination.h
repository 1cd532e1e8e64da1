#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <sightline/AssociationArray.h>
#include <sightline/SightingArray.h>
#include <std_msgs/Header.h>
#include <tf2/buffer_core.h>

#include "sightline/core/model/time.h"
#include "sightline/core/sensors/view_overlap.h"
#include "sightline/ros/diagnosis/graph_view.h"
#include "sightline/ros/diagnosis/sensor_record.h"

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

  /// What a tracker did with a scan that was taken before; `tracker` tells its tracks from those of others.
  void take(const sightline::AssociationArray& associations, const std::string& tracker);

  std::vector<Row> sensors() const;

  /// What is wrong with the sensors, by name: what each of them sent, names that are not unique, frames
  /// without transform to the tracking frame, views that never overlap.
  std::vector<Finding> findings(const tf2::BufferCore& transforms, const std::string& tracking_frame,
                                const InputLimits& limits) const;

  /// Topics of sightings that are published, and brought nothing within `seconds`.
  std::vector<Finding> silentTopics(const GraphView& graph, double seconds) const;

 private:
  using Key = std::pair<std::string, std::string>;  // sensor, topic

  /// A sighting in the sensor's frame.
  struct Seen {
    Eigen::Vector2d angles;      // [rad]
    Eigen::Matrix2d covariance;  // [rad^2]
    bool is_usable = false;
    std::string track;  // that took it, of any tracker; empty = none
  };

  struct Shot {
    std_msgs::Header header;
    std::vector<Seen> sightings;  // in the order of the scan
  };

  struct Source {
    SensorRecord record;
    std::set<std::string> publishers;
    std::vector<Shot> shots;  // every `every`th scan
    std::size_t every = 1;
  };

  /// How a driver may have got its angles wrong.
  using Reading = Eigen::Vector2d (*)(const Eigen::Vector2d& angles);

  void keepShot(const sightline::SightingArray& scan, Source& source);
  std::string subjectOf(const Key& key) const;
  void findSharedNames(std::vector<Finding>& found) const;
  void findTransforms(const tf2::BufferCore& transforms, const std::string& tracking_frame,
                      std::vector<Finding>& found) const;
  void findSeparateViews(const tf2::BufferCore& transforms, const std::string& tracking_frame,
                         std::vector<Finding>& found) const;
  void findScatter(const tf2::BufferCore& transforms, const std::string& tracking_frame,
                   std::vector<Finding>& found) const;
  static std::optional<double> scatterOf(const Source& source, const tf2::BufferCore& transforms,
                                         const std::string& tracking_frame);
  static std::vector<sightline::core::Glimpse> glimpsesOf(const Source& source,
                                                          const tf2::BufferCore& transforms,
                                                          const std::string& tracking_frame, Reading reading);

  std::map<Key, Source> sources_;
};

}  // namespace sightline_ros
