#pragma once

#include <string>
#include <vector>

#include <rosbag/bag.h>

#include "sightline/ros/diagnosis/graph_view.h"
#include "sightline/ros/diagnosis/input_examination.h"
#include "sightline/ros/diagnosis/position_examination.h"

namespace sightline_ros {

/// What a recording says about the sensors, trackers and fusions that it is of.
struct RecordingExamination {
  GraphView graph;  ///< the topics, and who published them; a topic without a known publisher is its own
  InputExamination inputs;
  PositionExamination positions;
  std::string tracking_frame;
  double seconds = 0.0;           ///< from the first scan's arrival to the last's
  std::vector<Finding> findings;  ///< as the doctor's of a live graph
};

struct RecordingExaminationParams {
  std::string tracking_frame;          ///< empty = that of the recorded tracks, or platform_enu
  std::string metric_frame = "world";  ///< in which it is told whether the sensors stand apart
  bool with_latency =
      true;  ///< whether the times of arrival are examined, which matter to live trackers only
  bool with_positions = true;  ///< whether the findings say what the reports of positions tell
  InputLimits limits;
};

/// Examines the scans, associations, tracks, reports of positions and transforms of a recording. Throws
/// std::runtime_error.
RecordingExamination examineRecording(const rosbag::Bag& bag, const RecordingExaminationParams& params = {});

/// A line for each thing that is wrong with the inputs, and for each sensor whose sightings start tracks that
/// are never confirmed: "  WRONG  cam on /sensors/cam/sightings: its ...".
std::string linesOf(const std::vector<Finding>& findings);

}  // namespace sightline_ros
