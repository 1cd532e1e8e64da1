#include "sightline/ros/adapters/boresight_broadcaster.h"

#include <vector>

#include "sightline/core/model/line_of_sight.h"
#include "sightline/ros/adapters/adapter_reading.h"
#include "sightline/ros/messages/transform_messages.h"

namespace sightline_ros {

geometry_msgs::TransformStamped boresightTransform(const std::string& optical_frame, const ros::Time& stamp) {
  return transformMessage(stamp, optical_frame, boresightFrameOf(optical_frame), Eigen::Vector3d::Zero(),
                          sightline::core::R_boresight_optical().transpose());
}

BoresightBroadcaster::BoresightBroadcaster(const ros::NodeHandle& nh)
    : repetition_(nh.createWallTimer(ros::WallDuration(kSecondsBetweenStaticTransforms),
                                     [this](const ros::WallTimerEvent&) { broadcast(); })) {}

void BoresightBroadcaster::add(const std::string& optical_frame) {
  if (optical_frames_.insert(optical_frame).second) broadcast();
}

void BoresightBroadcaster::broadcast() {
  std::vector<geometry_msgs::TransformStamped> transforms;
  for (const std::string& frame : optical_frames_) {
    transforms.push_back(boresightTransform(frame, ros::Time::now()));
  }
  if (!transforms.empty()) static_transforms_.sendTransform(transforms);
}

}  // namespace sightline_ros
