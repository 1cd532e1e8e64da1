#pragma once

#include <optional>

#include <Eigen/Core>

#include <std_msgs/Header.h>
#include <tf2/buffer_core.h>

#include "sightline/core/model/field_of_view.h"
#include "sightline/ros/messages/frame_params.h"

/// How a sensor is turned in the tracking frame at the stamp of its scan.
namespace sightline_ros {

/// Brings directions from the sensor's frame into the tracking frame.
struct Turn {
  Eigen::Matrix3d R_tracking_sensor;
  std::optional<Eigen::Matrix3d> attitude_covariance;  ///< about the sensor's axes [rad^2]; none = exact
};

/// Whether the transform of a scan with this header is known: interpolated between two that are published,
/// never extrapolated.
bool isTurnKnown(const std_msgs::Header& header, const FrameChangeParams& params,
                 const tf2::BufferCore& transforms);

/// The turn at the header's stamp; nullopt when the scan is in the tracking frame already. Throws
/// tf2::TransformException when the transform is not known.
std::optional<Turn> turnOf(const std_msgs::Header& header, const FrameChangeParams& params,
                           const tf2::BufferCore& transforms);

/// Where the sensor looks; nullopt when its field of view is not configured. `turn` as from turnOf.
std::optional<sightline::core::FieldOfView> viewOf(const std::string& sensor, const FrameChangeParams& params,
                                                   const std::optional<Turn>& turn);

}  // namespace sightline_ros
