#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <ros/time.h>
#include <sightline/SightingArray.h>
#include <std_msgs/Header.h>

#include "sightline/core/model/refusal.h"
#include "sightline/core/model/sighting.h"
#include "sightline/ros/adapters/adapter_params.h"
#include "sightline/ros/adapters/pixel_rays.h"

namespace sightline_ros {

/// The sightings of a driver's message, before its stamp and frame are checked. Sightings are added one by
/// one; what cannot be used becomes a refusal that names the thing, the value and the remedy.
class Reading {
 public:
  static constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();

  /// `topic` must outlive the reading.
  Reading(const AdapterTopic& topic, const std_msgs::Header& header) : header(header), topic_(topic) {}

  /// A direction of any length, known to the configured sigma. Where the topic says so, here and below a
  /// vector (0, 0, 0) is an unused slot, in which nothing is.
  void addDirection(const Eigen::Vector3d& direction, double snr = kNotKnown);

  /// The direction of a point [m] with its covariance [m^2], if the message has one. An axis of which it says
  /// nothing has the configured sigma at the point's distance.
  void addPoint(const Eigen::Vector3d& point, const std::optional<Eigen::Matrix3d>& covariance,
                double snr = kNotKnown);

  /// (azimuth, elevation) [rad] with their covariance [rad^2], if the message has one. An axis of which it
  /// says nothing has the configured sigma.
  void addAngles(const Eigen::Vector2d& angles, const std::optional<Eigen::Matrix2d>& covariance,
                 double snr = kNotKnown);

  /// A pixel of a camera [px] with its covariance [px^2], if the message has one; `rays` null = its
  /// CameraInfo has not come.
  void addPixel(const Eigen::Vector2d& pixel, const std::optional<Eigen::Matrix2d>& covariance,
                const PixelRays* rays, double snr = kNotKnown);

  /// The middle of a box of an image, from the centres of its first and last pixels [px].
  void addBox(const Eigen::Vector2d& first, const Eigen::Vector2d& last, const PixelRays* rays,
              double snr = kNotKnown);

  /// The configured sigma, which is one of arcs, as that of (azimuth, elevation) at an elevation [rad];
  /// nullopt when there is none.
  std::optional<Eigen::Vector2d> sigmaOfAngles(double elevation) const;

  /// Something in the message that cannot be used.
  void refuse(const std::string& kind, const std::string& detail);

  std::size_t offered() const { return sightings.size() + refusals.size(); }  ///< usable or not

  std_msgs::Header header;
  sightline::core::Duration middle{};                ///< of the exposure, after the header's stamp
  std::vector<sightline::core::Sighting> sightings;  ///< in the frame of `header`
  std::vector<sightline::core::Refusal> refusals;
  std::size_t unknown_covariances = 0;  ///< in whose place the configured sigma was used
  std::string first_unknown;            ///< the first of those, as text
  std::size_t unused_slots = 0;         ///< vectors (0, 0, 0) and such, in which nothing is

 private:
  void add(std::optional<sightline::core::Sighting> sighting, double snr);
  bool mayUseSigma(const std::optional<Eigen::Vector2d>& sigma, const std::string& covariance_text);
  std::optional<sightline::core::Sighting> sightingWithSigma(const Eigen::Vector3d& direction) const;
  Eigen::Matrix3d withSigmaOnAxes(const Eigen::Matrix3d& covariance, const Eigen::Array3i& axes,
                                  double range) const;

  const AdapterTopic& topic_;
};

/// Whether a stated variance or sigma is one of the numbers that drivers write for "not known": a power of
/// ten from 1e5, or one less than it (99999, 999999, 1e6, 1e9), or above 1e30. In the unit of its field.
bool standsForUnknown(double stated);

/// What goes out for a message.
struct AdaptedScan {
  sightline::SightingArray::Ptr scan;  ///< null: the message was refused, or every sighting in it
  std::vector<sightline::core::Refusal> refusals;
  std::string optical_frame;  ///< of which the scan's frame is the boresight frame; empty = it is none
};

/// Checks stamp and frame, and leaves out what the trackers would reject. A message that offers nothing
/// becomes an empty scan (it looked, and saw nothing); one of whose sightings none can be used becomes none.
AdaptedScan adapt(const Reading& reading, const AdapterTopic& topic, const ros::Time& arrival);

/// The name of the frame that looks along x where the optical frame looks along z.
std::string boresightFrameOf(const std::string& optical_frame);

}  // namespace sightline_ros
