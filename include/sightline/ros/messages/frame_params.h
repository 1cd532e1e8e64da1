#pragma once

#include <map>
#include <string>

#include <Eigen/Core>

#include "sightline/core/model/attitude.h"
#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {

struct FrameChangeParams {
  std::string tracking_frame = "platform_enu";  ///< in which targets are tracked
  double tf_timeout = 0.5;                      ///< how long a scan waits for its transform [s], >= 0
  double max_future = 0.1;                      ///< by how much a stamp may be ahead of the clock [s], >= 0
  int max_waiting = 1000;                       ///< scans that wait at once, over all sensors, >= 1

  /// Half widths of the fields of view in azimuth (0, pi] and elevation (0, pi/2] of the frame of its scans
  /// [rad], by sensor. The field of view of a sensor that is not in the map is not known.
  std::map<std::string, Eigen::Vector2d> fields_of_view;

  sightline::core::AttitudeParams attitude;  ///< of the frames of scans in the tracking frame
};

/// Reads tracking_frame, tf_timeout, max_future and max_waiting of this level.
FrameChangeParams loadFrameChangeParams(const ParamReader& reader, FrameChangeParams defaults = {});

/// Reads attitude_sigma and attitude_time_sigma of this level.
sightline::core::AttitudeParams loadAttitudeParams(const ParamReader& reader,
                                                   sightline::core::AttitudeParams defaults = {});

/// The same, and what only a tracker needs: fields_of_view, attitude_sigma and attitude_time_sigma.
FrameChangeParams loadTrackerFrameParams(const ParamReader& reader, FrameChangeParams defaults = {});

}  // namespace sightline_ros
