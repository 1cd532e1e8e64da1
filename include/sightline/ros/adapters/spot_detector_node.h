#pragma once

#include <cstdint>
#include <image_transport/image_transport.h>
#include <optional>
#include <string>
#include <vector>

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include "sightline/core/imaging/spot_detector.h"
#include "sightline/ros/adapters/boresight_broadcaster.h"
#include "sightline/ros/adapters/pixel_rays.h"
#include "sightline/ros/adapters/spot_detector_params.h"
#include "sightline/ros/diagnosis/periodic_diagnostics.h"
#include "sightline/ros/diagnosis/refusals.h"

namespace sightline_ros {

/// Node and nodelet: `image` and `camera_info` in; `sightings` out, one scan for each image, also when
/// nothing is seen; the boresight frame to /tf_static, /diagnostics.
class SpotDetectorNode {
 public:
  /// Throws ParamError.
  SpotDetectorNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh);

 private:
  SpotDetectorNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh, const ParamReader& reader);

  void onCameraInfo(const sensor_msgs::CameraInfo& camera);
  void onImage(const sensor_msgs::Image::ConstPtr& image);
  bool prepareRays(const sensor_msgs::Image& image, const std::string& frame);
  bool toGrey(const sensor_msgs::Image::ConstPtr& image);
  bool areSeen(const sensor_msgs::Image& image);
  void publish(const std::vector<sightline::core::Spot>& spots, const sensor_msgs::Image& image,
               const std::string& frame);
  void refuse(const std::string& kind, const std::string& detail);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status, double elapsed);

  ros::NodeHandle nh_;
  SpotDetectorNodeParams params_;
  sightline::core::SpotDetector detector_;
  std::optional<PixelRays> rays_;
  sensor_msgs::CameraInfo camera_;  // that `rays_` was made of
  std::vector<float> grey_;
  Refusals refusals_;
  BoresightBroadcaster boresights_;
  image_transport::ImageTransport transport_;
  image_transport::Subscriber images_;
  ros::Subscriber camera_info_;
  ros::Publisher sightings_;
  std::uint64_t image_count_ = 0, image_count_before_ = 0, sighting_count_ = 0;
  std::uint64_t bad_pixels_ = 0, masked_image_count_ = 0;  // of the newest image; images with such pixels
  double busy_ = 0.0;  // on images, since the last diagnosis [s of the wall's clock]
  std::optional<PeriodicDiagnostics> diagnostics_;
};

}  // namespace sightline_ros
