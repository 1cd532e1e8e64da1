#pragma once

#include <limits>
#include <string>

#include <Eigen/Core>

#include "sightline/core/imaging/spot_detector.h"
#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {

/// What the spot detector's node does round the detector of the core.
struct SpotDetectorNodeParams {
  sightline::core::SpotDetectorParams detector;
  std::string sensor;             ///< unique name; empty = the node's namespace
  std::string frame;              ///< instead of the image's frame_id (an optical frame); empty = the image's
  std::string transport = "raw";  ///< of image_transport
  bool rectified = false;         ///< the image is rectified (image_rect)
  double stamp_offset = 0.0;      ///< added to the stamp [s]

  /// Full angles that the image spans [rad], in (0, pi): a pinhole camera in the place of a CameraInfo; (0,
  /// 0) = there is a CameraInfo.
  Eigen::Vector2d field_of_view = Eigen::Vector2d::Zero();

  double detection_probability = std::numeric_limits<double>::quiet_NaN();  ///< NaN = the tracker's
  double clutter_density = std::numeric_limits<double>::quiet_NaN();        ///< [1/sr], NaN = the tracker's
};

/// All parameters of this level, strictly; the caller calls `finish`. Throws ParamError.
SpotDetectorNodeParams loadSpotDetectorParams(const ParamReader& reader);

}  // namespace sightline_ros
