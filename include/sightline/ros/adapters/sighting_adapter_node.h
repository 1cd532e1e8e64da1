#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <topic_tools/shape_shifter.h>
#include <vector>

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>
#include <sensor_msgs/CameraInfo.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include "sightline/ros/adapters/adapter_messages.h"
#include "sightline/ros/adapters/adapter_params.h"
#include "sightline/ros/adapters/boresight_broadcaster.h"
#include "sightline/ros/diagnosis/periodic_diagnostics.h"
#include "sightline/ros/diagnosis/refusals.h"

namespace sightline_ros {

/// Node and nodelet: what drivers publish in; `sightline/SightingArray` out, one topic for each of theirs.
/// The frames of cameras' sightings, which look along x, go to /tf_static.
class SightingAdapterNode {
 public:
  /// Throws ParamError.
  SightingAdapterNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh);

 private:
  /// One entry of the configuration at work.
  struct Source {
    AdapterTopic topic;
    ros::Subscriber messages, camera_info;
    ros::Publisher sightings;
    std::optional<PixelRays> rays;
    sensor_msgs::CameraInfo camera;       // that `rays` was made of
    std::optional<MessageLayout> layout;  // of messages read by field paths
    std::string layout_md5;
    std::uint64_t message_count = 0, message_count_before = 0, sighting_count = 0, sigma_count = 0,
                  unused_count = 0;
  };

  SightingAdapterNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh, const ParamReader& reader);

  void start(Source& source);
  template <typename Message>
  void subscribe(Source& source);
  void onCameraInfo(Source& source, const sensor_msgs::CameraInfo& camera);
  void onAnyMessage(Source& source, const topic_tools::ShapeShifter& message);
  Reading readAny(Source& source, const topic_tools::ShapeShifter& message);
  void publish(Source& source, const Reading& reading);
  void note(const sightline::core::Refusal& refusal);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status, double elapsed);

  ros::NodeHandle nh_;
  std::vector<std::unique_ptr<Source>> sources_;
  Refusals refusals_;
  BoresightBroadcaster boresights_;
  std::optional<PeriodicDiagnostics> diagnostics_;
};

}  // namespace sightline_ros
