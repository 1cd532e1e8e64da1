#include "sightline/ros/adapters/spot_detector_node.h"

#include <boost/function.hpp>
#include <cv_bridge/cv_bridge.h>
#include <opencv2/core.hpp>
#include <utility>

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <ros/console.h>
#include <sensor_msgs/image_encodings.h>
#include <sightline/SightingArray.h>

#include "sightline/core/model/line_of_sight.h"
#include "sightline/core/model/sphere.h"
#include "sightline/ros/adapters/adapter_reading.h"
#include "sightline/ros/messages/clock.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

constexpr std::uint32_t kDetectorQueue = 1000;  // messages a topic
constexpr std::uint32_t kImageQueue = 5;        // images: old ones are of no use to a live tracker
constexpr double kWarning = 60.0;               // between two of the same kind [s]

/// The namespace in which the node runs without the leading slash, or its own name in the root.
std::string sensorNamedAfter(const ros::NodeHandle& nh, const ros::NodeHandle& pnh) {
  const std::string& space = nh.getNamespace();
  return space.size() > 1 ? space.substr(1) : pnh.getNamespace().substr(1);
}

/// Grey images as they are, of any depth; colour ones are made grey.
bool isGrey(const std::string& encoding) {
  using namespace sensor_msgs::image_encodings;
  return encoding == MONO8 || encoding == MONO16 || encoding == TYPE_8UC1 || encoding == TYPE_16UC1 ||
         encoding == TYPE_32FC1 || encoding == TYPE_64FC1;
}

}  // namespace

SpotDetectorNode::SpotDetectorNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh)
    : SpotDetectorNode(nh, pnh, ParamReader(pnh)) {}

SpotDetectorNode::SpotDetectorNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh,
                                   const ParamReader& reader)
    : nh_(nh),
      params_(loadSpotDetectorParams(reader)),
      detector_(params_.detector),
      boresights_(nh),
      transport_(nh) {
  reader.finish();
  if (params_.sensor.empty()) params_.sensor = sensorNamedAfter(nh, pnh);

  diagnostics_.emplace(nh, pnh, "detecting",
                       [this](auto& status, double elapsed) { diagnose(status, elapsed); });
  sightings_ = nh_.advertise<sightline::SightingArray>("sightings", kDetectorQueue);
  if (params_.field_of_view.isZero()) {
    const boost::function<void(const sensor_msgs::CameraInfo::ConstPtr&)> take =
        [this](const sensor_msgs::CameraInfo::ConstPtr& camera) { onCameraInfo(*camera); };
    camera_info_ = nh_.subscribe<sensor_msgs::CameraInfo>("camera_info", kDetectorQueue, take);
  }
  images_ = transport_.subscribe(
      "image", kImageQueue, [this](const sensor_msgs::Image::ConstPtr& image) { onImage(image); }, {},
      image_transport::TransportHints(params_.transport, ros::TransportHints().tcpNoDelay(), pnh));
  ROS_INFO_STREAM(params_.sensor << ": looks for spots in " << images_.getTopic());
}

void SpotDetectorNode::onCameraInfo(const sensor_msgs::CameraInfo& camera) {
  if (rays_ && isSameCalibration(camera, camera_)) return;
  rays_.reset();
  camera_ = camera;
  if (const auto refusal = refusalOf(camera, params_.rectified)) {
    refuse(refusal->kind,
           "topic " + camera_info_.getTopic() + ": " + refusal->detail + ", or set field_of_view [rad]");
  } else {
    rays_.emplace(camera, params_.rectified);
    if (const std::string warning = rays_->warning(); !warning.empty()) {
      ROS_WARN_STREAM_THROTTLE(kWarning, params_.sensor << ": " << warning);
    }
  }
}

void SpotDetectorNode::onImage(const sensor_msgs::Image::ConstPtr& image) {
  const ros::WallTime start = ros::WallTime::now();
  ++image_count_;
  std::string frame = params_.frame.empty() ? image->header.frame_id : params_.frame;
  if (frame.empty() && rays_) frame = rays_->frame();
  if (!frame.empty() && frame.front() == '/') frame.erase(0, 1);
  if (frame.empty()) {
    refuse("no frame", "topic " + images_.getTopic() +
                           ": header.frame_id is empty: let the driver fill it in, or set frame");
  } else if (image->header.stamp.isZero()) {
    refuse("no stamp", "topic " + images_.getTopic() + ": header.stamp is 0: the driver must fill it in");
  } else if (prepareRays(*image, frame) && toGrey(image)) {
    const auto& spots =
        detector_.detect({grey_.data(), static_cast<int>(image->width), static_cast<int>(image->height)});
    if (areSeen(*image) && detector_.isReady()) publish(spots, *image, frame);
  }
  busy_ += (ros::WallTime::now() - start).toSec();
}

bool SpotDetectorNode::prepareRays(const sensor_msgs::Image& image, const std::string& frame) {
  const bool has_field_of_view = !params_.field_of_view.isZero();
  const bool is_new = !rays_ || rays_->width() != image.width || rays_->height() != image.height;
  if (has_field_of_view && is_new && image.width > 0 && image.height > 0) {
    sensor_msgs::CameraInfo camera = pinholeCamera(image.width, image.height, params_.field_of_view);
    camera.header.frame_id = frame;
    rays_.emplace(camera, true);
  }
  if (!rays_) {
    refuse("no calibration", "no usable CameraInfo has come on " + camera_info_.getTopic() +
                                 " yet, and field_of_view is not set: without them a pixel has no direction");
    return false;
  }
  if (rays_->width() != image.width || rays_->height() != image.height) {
    refuse("wrong size", "the image is of " + std::to_string(image.width) + "x" +
                             std::to_string(image.height) + " pixels, its CameraInfo of " +
                             std::to_string(rays_->width()) + "x" + std::to_string(rays_->height()) +
                             ": is it that camera's?");
    return false;
  }
  return true;
}

bool SpotDetectorNode::toGrey(const sensor_msgs::Image::ConstPtr& image) {
  try {
    const cv_bridge::CvImageConstPtr grey =
        isGrey(image->encoding) ? cv_bridge::toCvShare(image)
                                : cv_bridge::toCvShare(image, sensor_msgs::image_encodings::MONO8);
    grey_.resize(static_cast<std::size_t>(image->width) * image->height);
    cv::Mat out(static_cast<int>(image->height), static_cast<int>(image->width), CV_32F, grey_.data());
    grey->image.convertTo(out, CV_32F);
    return true;
  } catch (const std::exception& problem) {  // cv_bridge's and OpenCV's
    refuse("image unusable", "topic " + images_.getTopic() + ": encoding \"" + image->encoding + "\", " +
                                 problem.what() + ": mono8, mono16, 32FC1 or a colour encoding is expected");
    return false;
  }
}

/// Whether an image has good pixels; says how many are bad.
bool SpotDetectorNode::areSeen(const sensor_msgs::Image& image) {
  bad_pixels_ = static_cast<std::uint64_t>(detector_.badPixels());
  if (bad_pixels_ == 0) return true;
  const std::uint64_t pixels = std::uint64_t{image.width} * image.height;
  if (bad_pixels_ == pixels) {
    refuse("no good pixel", "topic " + images_.getTopic() + ": all " + std::to_string(pixels) +
                                " pixels of the image are NaN or infinite: what does its driver publish?");
    return false;
  }
  ++masked_image_count_;
  ROS_WARN_STREAM_THROTTLE(kWarning, params_.sensor << ": " << bad_pixels_ << " of " << pixels
                                                    << " pixels of " << images_.getTopic()
                                                    << " are NaN or infinite: they are masked, no target is "
                                                       "seen where they are");
  return true;
}

void SpotDetectorNode::publish(const std::vector<core::Spot>& spots, const sensor_msgs::Image& image,
                               const std::string& frame) {
  core::Scan scan;
  scan.time = toCore(image.header.stamp) + core::durationOf(params_.stamp_offset);
  scan.sensor = params_.sensor;
  scan.ifov = rays_->ifov();
  scan.detection_probability = params_.detection_probability;
  scan.clutter_density = params_.clutter_density;
  for (const core::Spot& spot : spots) {
    const auto optical = rays_->sightingAt(spot.pixel, spot.covariance);
    if (!optical) {
      refuse("no ray",
             rays_->whyNoRay(spot.pixel).value_or("the spot's covariance is not positive definite"));
      continue;
    }
    core::Sighting seen = core::rotate(*optical, core::R_boresight_optical());
    seen.snr = spot.snr;
    if (const auto why = core::rejectionOf(core::anglesOf(seen.direction), core::anglesCovariance(seen))) {
      refuse("sighting unusable", why->detail);
    } else {
      scan.sightings.push_back(seen);
    }
  }
  sighting_count_ += scan.sightings.size();
  boresights_.add(frame);
  sightings_.publish(toMessage(scan, boresightFrameOf(frame)));
}

void SpotDetectorNode::refuse(const std::string& kind, const std::string& detail) {
  if (const auto warning = refusals_.note({kind, detail}, clockNow())) {
    ROS_WARN_STREAM(params_.sensor << ": " << *warning);
  }
}

void SpotDetectorNode::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status, double elapsed) {
  using diagnostic_msgs::DiagnosticStatus;
  const auto fresh = static_cast<double>(image_count_ - image_count_before_);
  image_count_before_ = image_count_;
  status.summary(DiagnosticStatus::OK, "looking");
  if (bad_pixels_ > 0) {
    status.summary(DiagnosticStatus::OK, "looking; " + std::to_string(bad_pixels_) + " bad pixels masked");
  }
  if (image_count_ == 0) status.summary(DiagnosticStatus::WARN, "no image yet on " + images_.getTopic());
  status.addf("image rate [Hz]", "%.1f", elapsed > 0.0 ? fresh / elapsed : 0.0);
  status.addf("time an image [ms]", "%.2f", fresh > 0.0 ? 1e3 * busy_ / fresh : 0.0);
  status.add("images", image_count_);
  status.add("sightings", sighting_count_);
  status.add("bad pixels of the newest image, masked", bad_pixels_);
  status.add("images with bad pixels", masked_image_count_);
  if (rays_ && rays_->shareWithoutRay() > 0.0) {
    status.addf("pixels without a ray [%]", "%.2f", 100.0 * rays_->shareWithoutRay());
  }
  busy_ = 0.0;
  refusals_.diagnose(status);
}

}  // namespace sightline_ros
