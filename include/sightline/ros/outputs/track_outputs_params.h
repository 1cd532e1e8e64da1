#pragma once

#include <cstdint>
#include <string>

#include "sightline/ros/outputs/output_tracks.h"
#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {

/// Which track a pan-tilt head follows.
enum class FollowRule {
  best,    ///< of the smallest sigma; changed for one of half its sigma or less
  oldest,  ///< of the lowest id
  chosen,  ///< of one id
};

struct HeadParams {
  FollowRule follow = FollowRule::best;
  std::uint32_t chosen = 0;     ///< id of the track for `chosen`; 0 = none yet
  double lead = 0.0;            ///< how far beyond now the head is aimed [s], >= 0
  double max_prediction = 1.0;  ///< a track whose state is older than this, with the lead, is lost [s], > 0
  double max_sigma = 0.2;       ///< of a direction that is worth following [rad], > 0
};

/// Parameters of `track_outputs`; the file config/track_outputs.yaml explains them.
struct TrackOutputsParams {
  std::string topic = "/fusion/tracks";  ///< of TrackArray or PositionTrackArray
  OutputChoice choice;
  double distance = 10.0;  ///< along a line of sight [m]
  std::string frame_prefix = "track_";
  bool tf = true;
  double tf_interval = 0.05;   ///< least time between transforms [s]
  double path_seconds = 60.0;  ///< length of paths [s]
  double path_interval = 0.1;  ///< least time between poses of a path [s]
  std::string head_frame;      ///< frame of the head's foot; empty = that of the tracks
  double head_rate = 50.0;     ///< [Hz]
  HeadParams head;
};

/// Poses that a path may have.
constexpr double kMostPoses = 10000.0;

/// Throws ParamError.
TrackOutputsParams loadTrackOutputsParams(const ParamReader& reader);

}  // namespace sightline_ros
