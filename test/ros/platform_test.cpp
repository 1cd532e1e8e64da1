#include <map>
#include <string>

#include <gtest/gtest.h>

#include <ros/ros.h>
#include <sightline/Evaluation.h>

namespace {

/// What an architecture must reach.
struct Goal {
  std::string topic;     // of its best track
  double relative_rmse;  // over the sigma that the best sensor states
  std::size_t trackers;  // that must have tracks
};

/// The bounds are the core's accuracy on the same benchmark and the luck of one run. bench/accuracy gives
/// 0.48 for one sensor; estimators of six sensors have 0.28 to 0.33 (reference_results.md, E4). Errors of a
/// track are correlated over some 0.3 s, so 15 s of both channels hold about 100 independent ones, and an
/// RMSE varies by 1 / sqrt(200) = 7 %: five times that on 0.48 and on 0.33 are 0.65 and 0.45. The best raw
/// sensor has 1.
const std::map<std::string, Goal> kGoals = {{"single_sensor", {"/sensors/tracking_1/tracks", 0.65, 1}},
                                            {"sensor_fusion", {"/sensor_fusion/tracks", 0.45, 1}},
                                            {"track_fusion", {"/fusion/tracks", 0.45, 9}}};
constexpr double kSeconds = 15.0;    // of data
constexpr double kPatience = 150.0;  // [s], for a busy machine

const sightline::EvaluationRow* rowOf(const sightline::Evaluation& evaluation, const std::string& topic) {
  for (const auto& row : evaluation.rows) {
    if (row.topic == topic) return &row;
  }
  return nullptr;
}

TEST(Platform, TracksBetterThanItsBestSensorByTheDerivedMargin) {
  ros::NodeHandle nh;
  std::string architecture;
  ASSERT_TRUE(ros::NodeHandle("~").getParam("architecture", architecture));
  const Goal& goal = kGoals.at(architecture);

  sightline::Evaluation evaluation;
  ros::Time first;
  const ros::Subscriber subscriber = nh.subscribe<sightline::Evaluation>(
      "/evaluation", 10, [&](const sightline::Evaluation::ConstPtr& message) {
        evaluation = *message;
        const auto* row = rowOf(evaluation, goal.topic);
        if (first.isZero() && row != nullptr && row->samples > 0) first = message->header.stamp;
      });
  const ros::WallTime give_up = ros::WallTime::now() + ros::WallDuration(kPatience);
  while (first.isZero() || (evaluation.header.stamp - first).toSec() < kSeconds) {
    ASSERT_LT(ros::WallTime::now(), give_up)
        << "only " << evaluation.rows.size() << " rows, the last of " << evaluation.header.stamp;
    ros::spinOnce();
    ros::WallDuration(0.01).sleep();
  }

  const auto* best = rowOf(evaluation, goal.topic);
  ASSERT_NE(best, nullptr);
  EXPECT_LT(best->relative_rmse, goal.relative_rmse);
  EXPECT_GT(best->coverage, 0.95);
  EXPECT_EQ(best->breaks, 0u);
  EXPECT_EQ(best->id_switches, 0u);
  std::size_t trackers = 0;
  for (const auto& row : evaluation.rows) {
    const bool is_tracker = row.topic.find("/tracks") != std::string::npos && row.samples > 0;
    trackers += is_tracker ? 1 : 0;
    if (!is_tracker && row.samples > 0) {
      EXPECT_GT(row.relative_rmse, best->relative_rmse) << row.topic;
    }
  }
  EXPECT_EQ(trackers, goal.trackers);
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "platform_test");
  const ros::NodeHandle keeps_the_node;
  return RUN_ALL_TESTS();
}
