#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <sightline/SightingArray.h>
#include <tf2/buffer_core.h>

#include "sightline/core/model/attitude.h"
#include "sightline/core/model/sighting.h"
#include "sightline/core/model/time.h"
#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {

struct FrameChangeParams {
  std::string tracking_frame = "platform_enu";  ///< in which targets are tracked
  double tf_timeout = 0.5;                      ///< how long a scan waits for its transform [s], >= 0
  double max_future = 0.1;                      ///< by how much a stamp may be ahead of the clock [s], >= 0
  int max_waiting = 1000;                       ///< scans that wait at once, over all sensors, >= 1

  /// Half widths of the fields of view in azimuth (0, pi] and elevation (0, pi/2] of the frame of its scans
  /// [rad], by sensor. Of a sensor that is not there it is not known where it looks.
  std::map<std::string, Eigen::Vector2d> fields_of_view;

  sightline::core::AttitudeParams attitude;  ///< of the frames of scans in the tracking frame
};

/// Reads tracking_frame, tf_timeout, max_future and max_waiting of this level.
FrameChangeParams loadFrameChangeParams(const ParamReader& reader, FrameChangeParams defaults = {});

/// Reads attitude_sigma and attitude_time_sigma of this level.
sightline::core::AttitudeParams loadAttitudeParams(const ParamReader& reader,
                                                   sightline::core::AttitudeParams defaults = {});

/// And what only who tracks has to know: fields_of_view, attitude_sigma and attitude_time_sigma.
FrameChangeParams loadTrackerFrameParams(const ParamReader& reader, FrameChangeParams defaults = {});

/// A scan message, and what can be said of it.
struct FramedScan {
  sightline::SightingArray::ConstPtr message;

  /// In the tracking frame; as many sightings as the message has, in its order. Those that cannot be used
  /// have a NaN covariance, which the trackers reject, and an entry in `rejections`.
  sightline::core::Scan scan;
  std::vector<std::pair<std::uint32_t, std::string>> rejections;  ///< index, why; ascending

  std::string drop_reason;  ///< short and of few kinds, for counting; empty = the scan can be used
  std::string drop_detail;  ///< the whole story, with values and remedy
};

/// How a scan is brought into the tracking frame.
struct Turn {
  Eigen::Matrix3d R_tracking_sensor;
  std::optional<Eigen::Matrix3d> attitude_covariance;  ///< about the sensor's axes [rad^2]; none = exact
};

/// Brings scans into the tracking frame with the transform at the stamp of exposure, interpolated between two
/// that are published, never extrapolated: of a turn that changes by `a` [rad/s^2], transforms `T` apart lose
/// up to a T^2 / 8. A scan whose transform is not there yet waits, behind the earlier ones of its frame,
/// until it comes or `tf_timeout` is over. Only the rotation matters: directions have no origin.
class FrameChange {
 public:
  /// `transforms` is filled by others and must outlive this.
  FrameChange(FrameChangeParams params, const tf2::BufferCore& transforms);

  /// Takes a scan; its result comes out of `release`, now or later. `now` is the clock, 0 = not known.
  void add(const sightline::SightingArray::ConstPtr& message, sightline::core::Time now);

  /// Everything that has become ready, or will not any more, in the order of arrival within each frame.
  std::vector<FramedScan> release(sightline::core::Time now);

  std::size_t waiting() const { return waiting_count_; }

  const FrameChangeParams& params() const { return params_; }

 private:
  struct Waiting {
    sightline::SightingArray::ConstPtr message;
    sightline::core::Time since;
  };

  bool isHere(const sightline::SightingArray& message) const;
  std::optional<Turn> turnOf(const std_msgs::Header& header) const;
  Eigen::Vector3d angularVelocityOf(const std_msgs::Header& header,
                                    const Eigen::Matrix3d& R_tracking_sensor) const;
  std::optional<sightline::core::FieldOfView> viewOf(const std::string& sensor,
                                                     const std::optional<Turn>& turn) const;
  bool hasWaitedEnough(Waiting& scan, sightline::core::Time now) const;
  FramedScan inTrackingFrame(const sightline::SightingArray::ConstPtr& message) const;
  FramedScan withoutTransform(const Waiting& scan, sightline::core::Time now) const;
  void releaseFirst(std::deque<Waiting>& scans, sightline::core::Time now);
  void dropOldest();

  FrameChangeParams params_;
  const tf2::BufferCore& transforms_;
  std::map<std::string, std::deque<Waiting>> waiting_;  // by frame, oldest first, none empty
  std::size_t waiting_count_ = 0;
  std::vector<FramedScan> finished_;  // to be handed out by the next release
};

/// What is wrong with a scan as a whole, as (reason for counting, detail); nullopt when nothing is.
std::optional<std::pair<std::string, std::string>> complaintAbout(const sightline::SightingArray& message);

}  // namespace sightline_ros
