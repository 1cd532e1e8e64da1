#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include <ros/message_event.h>
#include <ros/node_handle.h>
#include <ros/subscriber.h>
#include <sightline/AssociationArray.h>
#include <sightline/SightingArray.h>
#include <tf2/buffer_core.h>

#include "sightline/ros/diagnosis/graph_view.h"
#include "sightline/ros/diagnosis/input_examination.h"
#include "sightline/ros/diagnosis/position_examination.h"
#include "sightline/ros/diagnosis/sensor_record.h"
#include "sightline/ros/diagnosis/transform_subscriber.h"

namespace sightline_ros {

struct DoctorParams {
  double seconds = 10.0;       ///< how long to look, by the wall's clock [s], > 0
  std::string tracking_frame;  ///< empty = that of the running trackers, or platform_enu
  InputLimits limits;
};

/// Subscribes to everything that has to do with sightings and to the reports of positions for some time, and
/// reports what is wrong.
class InputDoctor {
 public:
  InputDoctor(const ros::NodeHandle& nh, const DoctorParams& params);

  /// Looks; ends early when the node is shut down. Throws std::runtime_error without a master.
  std::vector<Finding> examine();

  const InputExamination& examination() const { return examination_; }
  const GraphView& graph() const { return graph_; }
  const std::string& trackingFrame() const { return tracking_frame_; }

 private:
  void listen();
  void lookFor(double seconds);
  void onScan(const ros::MessageEvent<sightline::SightingArray const>& event, const std::string& topic);
  std::string usedTrackingFrame() const;
  bool doSensorsStandApart() const;
  void findClock(std::vector<Finding>& found) const;

  ros::NodeHandle nh_;
  DoctorParams params_;
  GraphView graph_;
  std::string tracking_frame_;
  tf2::BufferCore transforms_;
  InputExamination examination_;
  PositionExamination positions_;
  bool is_listening_ = true;
  ros::Time first_now_;                                 // of ROS's clock
  std::map<std::string, ros::Subscriber> subscribers_;  // by topic
  TransformSubscriber transform_subscriber_;
};

}  // namespace sightline_ros
