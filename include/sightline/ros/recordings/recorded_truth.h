#pragma once

#include <cstdint>
#include <map>
#include <string>

#include <Eigen/Core>

#include <rosbag/bag.h>

#include "sightline/core/evaluation/metrics.h"
#include "sightline/core/model/time.h"

namespace sightline_ros {

/// Motions (azimuth, elevation and their rates) [rad, rad/s] of all targets, by time and id.
using Motions = std::map<sightline::core::Time, std::map<std::uint32_t, Eigen::Vector4d>>;

/// A recorded truth. Sensors that stand apart each see the targets in directions of their own.
struct RecordedTruth {
  std::map<std::string, Motions> motions;  ///< by the sensor that it is meant for; "" = for all
  std::string frame;                       ///< of the angles; empty = not known (of a CSV file)
};

/// Truth on a TrackArray topic of a bag. Throws std::runtime_error when there is none, naming what there is.
RecordedTruth truthFromBag(const rosbag::Bag& bag, const std::string& topic);

/// Truth in a CSV file with the columns time [s], azimuth [rad] and, each optional, elevation [rad] (needed
/// unless `channels` is azimuth_only), target (any name; without it there is one), sensor (whose directions
/// these are) and range_m (ignored); rows in any order. Rates are those of the parabola through a sample and
/// its neighbours within `gap` [s]. Throws CsvError.
RecordedTruth truthFromCsv(const std::string& path, sightline::core::Channels channels, double gap);

/// One or the other: a topic of the bag, or else a file. Throws std::runtime_error when it is neither.
RecordedTruth readTruth(const std::string& topic_or_csv, const rosbag::Bag& bag,
                        sightline::core::Channels channels, double gap);

}  // namespace sightline_ros
