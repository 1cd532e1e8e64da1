#include "sightline/ros/outputs/track_outputs_component.h"

#include <utility>

#include "sightline/report/value_text.h"
#include "sightline/ros/outputs/output_messages.h"

namespace sightline_ros {

namespace core = sightline::core;
using sightline::report::valueOf;

namespace {

constexpr double kMostLate = 1.0;  // [s]: what is older begins a new time

}  // namespace

template <typename Message>
OutputResult TrackOutputsComponent::take(const Message& message) {
  OutputResult result;
  if (isRefused(message.header, result)) return result;
  newest_ = message.header;
  result.tracks = outputTracksOf(message, params_.choice, result.refusals);
  result.sends_transforms = areTransformsDue(message.header.stamp);
  result.grown = growPaths(*result.tracks);
  head_.onTracks(*result.tracks);
  return result;
}

template OutputResult TrackOutputsComponent::take(const sightline::TrackArray&);
template OutputResult TrackOutputsComponent::take(const sightline::PositionTrackArray&);

bool TrackOutputsComponent::isRefused(const std_msgs::Header& header, OutputResult& result) {
  if (header.stamp.isZero()) {
    result.refusals.push_back(core::invalid("the stamp of the tracks is 0: set header.stamp"));
  } else if (header.frame_id.empty()) {
    result.refusals.push_back(core::invalid("the tracks have no frame: set header.frame_id"));
  } else {
    const double late = (newest_.stamp - header.stamp).toSec();
    if (late > kMostLate) {
      result.notice = "the stamps of the tracks went back by " + valueOf(late, "s") + ": begins anew";
      reset();
    } else if (late > 0.0) {
      result.refusals.push_back({"late", "tracks are " + valueOf(late, "s") + " older than the last"});
    } else if (header.frame_id != newest_.frame_id) {
      paths_.clear();
    }
  }
  return !result.refusals.empty();
}

void TrackOutputsComponent::reset() {
  newest_ = {};
  last_transforms_.reset();
  paths_.clear();
  head_.reset();
}

/// A stamp that is sent twice is a fault to tf, whatever stands in it.
bool TrackOutputsComponent::areTransformsDue(const ros::Time& stamp) {
  if (last_transforms_ &&
      (stamp == *last_transforms_ || (stamp - *last_transforms_).toSec() < params_.tf_interval))
    return false;
  last_transforms_ = stamp;
  return true;
}

std::vector<std::uint32_t> TrackOutputsComponent::growPaths(const OutputTracks& tracks) {
  std::vector<std::uint32_t> grown;
  if (!tracks.are_positions) {
    paths_.clear();
    return grown;
  }
  auto old = std::exchange(paths_, {});
  for (const OutputTrack& track : tracks.tracks) {
    auto& path = paths_[track.id] = std::move(old[track.id]);
    const ros::Time stamp = tracks.header.stamp;
    if (!path.empty() && (stamp - path.back().header.stamp).toSec() < params_.path_interval) continue;
    path.emplace_back();
    path.back().header = tracks.header;
    path.back().pose = poseOf(track, 0.0);
    while ((stamp - path.front().header.stamp).toSec() > params_.path_seconds) path.pop_front();
    grown.push_back(track.id);
  }
  return grown;
}

nav_msgs::Path TrackOutputsComponent::pathOf(std::uint32_t id) const {
  nav_msgs::Path message;
  const auto path = paths_.find(id);
  if (path == paths_.end() || path->second.empty()) return message;
  message.header = path->second.back().header;
  message.poses.assign(path->second.begin(), path->second.end());
  return message;
}

}  // namespace sightline_ros
