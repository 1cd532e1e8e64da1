#pragma once

#include <map>
#include <string>

#include <rosbag/bag.h>

#include "sightline/core/evaluation/position_evaluation.h"

namespace sightline_ros {

/// Whether a file's header line has the columns of positions (`east_m` or `latitude_deg`).
bool isPositionTruth(const std::string& path);

/// True paths by target from a CSV file: `time[,target],east_m,north_m,up_m` in the axes of `world`, or
/// `time[,target],latitude_deg,longitude_deg,height_m` (WGS-84; the bag says where its `world` is). Without
/// `target` there is one. `gap`: see TruePath [s]. Throws report::CsvError or std::runtime_error.
std::map<std::string, sightline::core::TruePath> positionTruthFromCsv(const std::string& path,
                                                                      const rosbag::Bag& bag, double gap);

/// Whether the recording has PositionTrackArray messages on the topic.
bool isPositionTopic(const std::string& topic, const rosbag::Bag& bag);

/// True paths by id from such a topic, as `simulate` writes it. `gap`: see TruePath [s].
std::map<std::string, sightline::core::TruePath> positionTruthFromTopic(const std::string& topic,
                                                                        const rosbag::Bag& bag, double gap);

}  // namespace sightline_ros
