#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <nav_msgs/Path.h>
#include <optional>
#include <string>
#include <vector>

#include <geometry_msgs/PoseStamped.h>

#include "sightline/core/model/refusal.h"
#include "sightline/core/model/time.h"
#include "sightline/ros/outputs/head_pointer.h"
#include "sightline/ros/outputs/output_tracks.h"
#include "sightline/ros/outputs/track_outputs_params.h"

namespace sightline_ros {

/// What became of one message of tracks.
struct OutputResult {
  std::optional<OutputTracks> tracks;  ///< nullopt when the message is refused
  bool sends_transforms = false;       ///< tf is due; never twice for one stamp
  std::vector<std::uint32_t> grown;    ///< ids whose path has a new pose, ascending
  std::vector<sightline::core::Refusal> refusals;
  std::string notice;  ///< what else an operator must know; mostly empty
};

/// Tracks of one source from message to message, for outputs, without a node round it: what is usable, the
/// paths of positions, and the head that follows one of them.
///
/// A message older than the last is refused; one that is older by more than a second is the beginning of a
/// new time (a recording in a loop): paths begin anew.
class TrackOutputsComponent {
 public:
  explicit TrackOutputsComponent(const TrackOutputsParams& params) : params_(params), head_(params.head) {}

  OutputResult onTracks(const sightline::TrackArray& message) { return take(message); }
  OutputResult onTracks(const sightline::PositionTrackArray& message) { return take(message); }

  /// The path of a position that is in the last message, oldest pose first; empty of others.
  nav_msgs::Path pathOf(std::uint32_t id) const;

  HeadPointer& head() { return head_; }
  const HeadPointer& head() const { return head_; }

  const TrackOutputsParams& params() const { return params_; }

 private:
  template <typename Message>
  OutputResult take(const Message& message);
  bool isRefused(const std_msgs::Header& header, OutputResult& result);
  std::vector<std::uint32_t> growPaths(const OutputTracks& tracks);
  bool areTransformsDue(const ros::Time& stamp);
  void reset();

  TrackOutputsParams params_;
  HeadPointer head_;
  std_msgs::Header newest_;                                                // of the tracks
  std::optional<ros::Time> last_transforms_;                               // stamp
  std::map<std::uint32_t, std::deque<geometry_msgs::PoseStamped>> paths_;  // of the last message's tracks
};

}  // namespace sightline_ros
