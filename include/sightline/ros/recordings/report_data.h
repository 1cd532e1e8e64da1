#pragma once

#include <string>

#include <rosbag/bag.h>

#include "sightline/ros/recordings/bag_evaluation.h"

namespace sightline_ros {

/// Writes what a report shows of a recording beside its scores, as CSV files into `folder`, which exists:
///   innovations.csv  topic,time,accepted,nis    (of associations; one line a window)
///   lives.csv        topic,track,first,last    (of confirmed and coasting tracks; stamps)
///   sensors.csv      topic,time,sensor,verdict,noise_scale,clock_behind,slow_scale,reason
///                    (of reports; one line a window, and every change of a verdict)
///   scene.csv        kind,name,time,x_m,y_m,z_m    (kind: station, or the topic of positions)
///   recorded.csv     topic,key,value    (what the recording tells of its settings)
/// Times are seconds. A window is a part of the recording's duration, so that the files are bounded but for
/// the number of tracks. Throws OutputError or std::runtime_error.
void writeReportData(const rosbag::Bag& bag, const std::string& folder);

/// The truth that a recording has of its own: /truth/positions where there are positions to compare with it,
/// else /truth; empty where it has neither.
std::string truthTopicOf(const rosbag::Bag& bag);

/// Evaluates a recording, and writes into the folder `settings.csv`, which is made where it is missing,
/// everything that a report shows: the files of `evaluateBag`, those of `writeReportData`, console.txt (the
/// tables) and settings.csv (key,value: how it was evaluated). Returns the tables.
std::string evaluateForReport(const std::string& bag, const BagEvaluationSettings& settings);

}  // namespace sightline_ros
