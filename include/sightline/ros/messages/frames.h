#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include <sightline/SightingArray.h>
#include <tf2/buffer_core.h>

#include "sightline/core/model/time.h"
#include "sightline/ros/messages/frame_params.h"
#include "sightline/ros/messages/framed_scan.h"

namespace sightline_ros {

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

  bool hasWaitedEnough(const Waiting& scan, sightline::core::Time now) const;
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

}  // namespace sightline_ros
