#include "sightline/ros/outputs/track_outputs_params.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "sightline/ros/components/component_params.h"

#include "support/paths.h"
#include "support/scratch_folder.h"

namespace {

using sightline_ros::FollowRule;
using sightline_ros::ParamError;
using sightline_ros::ParamReader;
using sightline_ros::TrackOutputsParams;

TrackOutputsParams outputParamsOf(const std::string& yaml) {
  const ScratchFolder folder;
  const ParamReader reader = ParamReader::fromYaml(folder.write("params.yaml", yaml));
  const TrackOutputsParams params = sightline_ros::loadTrackOutputsParams(reader);
  reader.finish();
  return params;
}

void expectComplaint(const std::string& yaml, const std::string& complaint) {
  try {
    outputParamsOf(yaml);
    ADD_FAILURE() << yaml << " is taken";
  } catch (const ParamError& problem) {
    const std::string said = problem.what();
    EXPECT_NE(said.find(complaint), std::string::npos) << said;
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  }
}

TEST(TrackOutputsParams, ShippedFileSaysTheDefaultsAndNothingElse) {
  const ParamReader reader =
      ParamReader::fromYaml(sightline::test::sourceDirectory() + "/config/track_outputs.yaml");
  sightline_ros::loadTrackOutputsParams(reader);
  sightline_ros::silenceFrom(reader);
  EXPECT_NO_THROW(reader.finish());
  EXPECT_EQ(reader.differences(), std::vector<std::string>{});
}

TEST(TrackOutputsParams, EveryKeyReachesItsField) {
  const TrackOutputsParams params = outputParamsOf(
      "{topic: /positions/tracks, coasting: false, tentative: true, max_tracks: 7, distance: 3.0,"
      " frame_prefix: west_, tf: false, tf_interval: 0.2, path_seconds: 5.0, path_interval: 0.5, follow: "
      "chosen,"
      " chosen: 12, head_frame: mast, head_rate: 10.0, lead: 0.3, max_prediction: 2.0, max_sigma: 0.1}");
  EXPECT_EQ(params.topic, "/positions/tracks");
  EXPECT_FALSE(params.choice.coasting);
  EXPECT_TRUE(params.choice.tentative);
  EXPECT_EQ(params.choice.max_tracks, 7);
  EXPECT_EQ(params.distance, 3.0);
  EXPECT_EQ(params.frame_prefix, "west_");
  EXPECT_FALSE(params.tf);
  EXPECT_EQ(params.tf_interval, 0.2);
  EXPECT_EQ(params.path_seconds, 5.0);
  EXPECT_EQ(params.path_interval, 0.5);
  EXPECT_EQ(params.head.follow, FollowRule::chosen);
  EXPECT_EQ(params.head.chosen, 12u);
  EXPECT_EQ(params.head_frame, "mast");
  EXPECT_EQ(params.head_rate, 10.0);
  EXPECT_EQ(params.head.lead, 0.3);
  EXPECT_EQ(params.head.max_prediction, 2.0);
  EXPECT_EQ(params.head.max_sigma, 0.1);
  EXPECT_EQ(outputParamsOf("{follow: oldest}").head.follow, FollowRule::oldest);
}

TEST(TrackOutputsParams, WhatCannotBeUsedIsRefusedWithKeyValueAndRemedy) {
  expectComplaint("{topic: ''}", "/topic: expected a topic");
  expectComplaint("{frame_prefix: 'my track/'}",
                  "/frame_prefix: expected a letter, then letters, digits and _, "
                  "got \"my track/\" (for instance west_track_)");
  expectComplaint("{follow: fastest}",
                  "/follow: expected one of best, oldest, chosen, got the string \"fastest\"");
  expectComplaint("{lead: 2.0}", "/lead: must be less than max_prediction");
  expectComplaint("{chosen: 4}", "/chosen: is of no use while follow is not chosen (set follow: chosen)");
  expectComplaint("{path_seconds: 3600.0}", "has more than 10000 poses (raise path_interval)");
  expectComplaint("{distance: 1e1}", "/distance: expected a number > 0 [m], got the string \"1e1\"");
  expectComplaint("{head_rat: 50.0}", "/head_rat: nobody reads this parameter (did you mean");
}

}  // namespace
