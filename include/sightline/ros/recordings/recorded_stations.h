#pragma once

#include <string>
#include <vector>

#include <rosbag/bag.h>

/// Which sensors of a recording stand at one place.
namespace sightline_ros {

/// A place with the sensors that stand there.
struct RecordedStation {
  std::string name;                  ///< of the first of its sensors
  std::string frame;                 ///< of that sensor's scans; the station's directions are told in it
  std::vector<std::string> sensors;  ///< sorted
};

struct RecordedStations {
  std::vector<RecordedStation> stations;  ///< by name
  double apart = 0.0;                     ///< largest distance of two of them [m]

  bool standApart() const { return stations.size() > 1 && apart > kOnePlace; }

  static constexpr double kOnePlace = 1.0;      ///< [m]: sensors closer together than that are one station
  static constexpr double kOnePlatform = 10.0;  ///< [m]: the same of sensors that are mounted on one platform
                                                ///< which moves; as the default of the fusion's max_baseline
};

/// Sensors by the places of their frames in `metric_frame`, at the time from which all have spoken. Those on
/// one platform (by /tf_static below a frame that /tf moves) are one station even metres apart. A sensor
/// without a place there is a station of its own, which does not count for `apart`.
RecordedStations recordedStationsOf(const rosbag::Bag& bag, const std::string& metric_frame);

}  // namespace sightline_ros
