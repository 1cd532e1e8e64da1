#include "sightline/ros/outputs/track_outputs_params.h"

#include <algorithm>
#include <cctype>
#include <limits>
#include <vector>

#include "sightline/ros/params/param_text.h"

namespace sightline_ros {
namespace {

/// In the order of the enum.
const std::vector<std::string> kFollowRules{"best", "oldest", "chosen"};

FollowRule followRuleFrom(const ParamReader& reader) {
  const std::string rule = reader.choice("follow", kFollowRules.front(), kFollowRules);
  return static_cast<FollowRule>(std::find(kFollowRules.begin(), kFollowRules.end(), rule) -
                                 kFollowRules.begin());
}

/// The prefix begins the names of frames and of topics.
bool isPrefix(const std::string& text) {
  return !text.empty() && std::isalpha(static_cast<unsigned char>(text.front())) != 0 &&
         std::all_of(text.begin(), text.end(), [](unsigned char letter) {
           return letter == '_' || (letter < 128 && std::isalnum(letter) != 0);
         });
}

}  // namespace

TrackOutputsParams loadTrackOutputsParams(const ParamReader& reader) {
  TrackOutputsParams params;
  params.topic = reader.text("topic", params.topic);
  if (params.topic.empty())
    throw reader.error(
        "topic",
        "expected a topic of sightline/TrackArray or PositionTrackArray, got \"\" (set it, for "
        "instance to /positions/tracks)");
  params.choice.coasting = reader.flag("coasting", params.choice.coasting);
  params.choice.tentative = reader.flag("tentative", params.choice.tentative);
  params.choice.max_tracks = reader.integer("max_tracks", params.choice.max_tracks, 1, 10000);
  params.distance = reader.number("distance", params.distance, above(0.0), "m");
  params.frame_prefix = reader.text("frame_prefix", params.frame_prefix);
  if (!isPrefix(params.frame_prefix)) {
    throw reader.error("frame_prefix", "expected a letter, then letters, digits and _, got " +
                                           sightline_ros::quoted(params.frame_prefix) +
                                           " (for instance west_track_)");
  }
  params.tf = reader.flag("tf", params.tf);
  params.tf_interval = reader.number("tf_interval", params.tf_interval, between(0.0, 10.0), "s");
  params.path_seconds = reader.number("path_seconds", params.path_seconds, between(0.1, 86400.0), "s");
  params.path_interval = reader.number("path_interval", params.path_interval, between(0.001, 3600.0), "s");
  if (params.path_seconds > kMostPoses * params.path_interval) {
    throw reader.error("path_seconds", "a path of " + shortestText(params.path_seconds) +
                                           " s with a pose every " + shortestText(params.path_interval) +
                                           " s has more than 10000 poses (raise path_interval)");
  }
  params.head_frame = reader.text("head_frame", params.head_frame);
  params.head_rate = reader.number("head_rate", params.head_rate, between(0.1, 1000.0), "Hz");
  HeadParams& head = params.head;
  head.follow = followRuleFrom(reader);
  head.chosen = static_cast<std::uint32_t>(
      reader.integer("chosen", static_cast<int>(head.chosen), 0, std::numeric_limits<int>::max()));
  head.lead = reader.number("lead", head.lead, between(0.0, 10.0), "s");
  head.max_prediction = reader.number("max_prediction", head.max_prediction, between(0.01, 60.0), "s");
  head.max_sigma = reader.number("max_sigma", head.max_sigma, above(0.0), "rad");
  if (head.lead >= head.max_prediction)
    throw reader.error("lead", "must be less than max_prediction, or nothing is ever followed, got " +
                                   shortestText(head.lead) + " s (raise max_prediction)");
  if (head.chosen != 0 && head.follow != FollowRule::chosen)
    throw reader.error("chosen", "is of no use while follow is not chosen (set follow: chosen)");
  return params;
}

}  // namespace sightline_ros
