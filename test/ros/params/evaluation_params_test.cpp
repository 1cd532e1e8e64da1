#include "sightline/ros/params/evaluation_params.h"

#include <gtest/gtest.h>

#include "sightline/ros/nodes/track_evaluator_node.h"

#include "support/paths.h"

using namespace sightline_ros;

namespace {

const std::string kShipped = sightline::test::sourceDirectory() + "/config/track_evaluator.yaml";

XmlRpc::XmlRpcValue treeWith(const std::string& key, XmlRpc::XmlRpcValue value) {
  XmlRpc::XmlRpcValue tree;
  tree[key] = value;
  return tree;
}

TEST(TrackEvaluatorParams, TheShippedFileHoldsTheDefaults) {
  const ParamReader reader = ParamReader::fromYaml(kShipped);
  loadTrackEvaluatorParams(reader);
  EXPECT_EQ(reader.differences(), std::vector<std::string>{});
  EXPECT_NO_THROW(reader.finish());
}

TEST(TrackEvaluatorParams, AreWhatIsSet) {
  XmlRpc::XmlRpcValue tree;
  tree["settle_time"] = 1.0;
  tree["azimuth_only"] = true;
  tree["gospa"]["cutoff"] = 0.02;
  tree["duration"] = 20;
  const ParamReader reader(tree, "/evaluator");
  const TrackEvaluatorParams params = loadTrackEvaluatorParams(reader);
  EXPECT_EQ(params.evaluation.settle_time, 1.0);
  EXPECT_EQ(params.evaluation.channels, sightline::core::Channels::azimuth_only);
  EXPECT_EQ(params.evaluation.gospa.cutoff, 0.02);
  EXPECT_EQ(params.duration, 20.0);
  EXPECT_NO_THROW(reader.finish());
}

TEST(TrackEvaluatorParams, OutOfRangeIsRefused) {
  for (const auto& [key, value] : std::map<std::string, double>{{"settle_time", -1.0},
                                                                {"truth_gap", 0.0},
                                                                {"match_gate", -0.1},
                                                                {"sighting_gate", 0.0},
                                                                {"duration", -5.0},
                                                                {"truth_memory", 1.0}}) {
    const ParamReader reader(treeWith(key, value), "/evaluator");
    try {
      loadTrackEvaluatorParams(reader);
      ADD_FAILURE() << key << " = " << value << " was taken";
    } catch (const ParamError& problem) {
      EXPECT_NE(std::string(problem.what()).find("/evaluator/" + key), std::string::npos) << problem.what();
    }
  }
}

}  // namespace
