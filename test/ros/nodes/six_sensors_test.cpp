// The whole platform, launched as a user does, in each of the paper's architectures: is the track it is for
// better than the best raw sensor, by as much as theory promises?
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include <ros/ros.h>
#include <sightline/Evaluation.h>

#include "support/launch.h"

namespace {

constexpr double kLaunchPatience = 90.0;  // [s], for a launch of 12 s of data

// What a straight line through the sightings of a window makes of the paper's benchmark (sigma 0.08 rad, 33
// Hz, a sinusoid of amplitude 1 rad and 1 rad/s). Through N = 20 sightings in 0.6 s its end has the variance
// 4 sigma^2 / N, so 0.447 sigma. The target's acceleration, 0.71 rad/s^2 rms, bends the truth away from the
// line by a T^2 / 12 there, so by 0.27 sigma. Together 0.52 sigma.
constexpr double kNoise = 0.447;
constexpr double kBend = 0.27;
// In 10 s there are about 17 windows that know nothing of each other, of two channels: the RMSE over them
// scatters by 1 / sqrt(2 * 34) = 12 %. Four times that is allowed.
constexpr double kScatter = 1.5;
// Three sensors of 0.08 and three of 0.15 rad together have as much information as one of 0.51 * 0.08 rad.
const double kOfSixSensors = std::sqrt((1.0 / 0.0064) / (3.0 / 0.0064 + 3.0 / 0.0225));

const double kSingleSensorBound = kScatter * std::hypot(kNoise, kBend);                // 0.78
const double kSixSensorsBound = kScatter * std::hypot(kOfSixSensors * kNoise, kBend);  // 0.53

class SixSensors : public testing::Test {
 protected:
  /// Launches an architecture for 12 s of data, and keeps the last evaluation.
  void run(const std::string& architecture) {
    ros::NodeHandle nh;
    const auto subscriber = nh.subscribe("/evaluation", 100, &SixSensors::take, this);
    Launch launch("six_sensors.launch",
                  {"architecture:=" + architecture, "rviz:=false", "live:=false", "duration:=12"});
    ASSERT_TRUE(launch.endsWithin(kLaunchPatience)) << "the launch did not end by itself";
    EXPECT_EQ(*launch.exitCode(), 0);
  }

  void take(const sightline::Evaluation& evaluation) { last_ = evaluation; }

  const sightline::EvaluationRow* rowOf(const std::string& topic) const {
    for (const auto& row : last_.rows) {
      if (row.topic == topic && row.samples > 0) return &row;
    }
    return nullptr;
  }

  double rmseOfBestSensor() const {
    double best = HUGE_VAL;
    for (const auto& row : last_.rows) {
      const std::string ending = "/sightings";
      const bool is_raw = row.topic.size() > ending.size() &&
                          row.topic.compare(row.topic.size() - ending.size(), ending.size(), ending) == 0;
      if (is_raw && row.samples > 0) best = std::min(best, row.rmse);
    }
    return best;
  }

  /// The topic has one unbroken track, better than the best raw sensor by the factor `bound`.
  void expectGoodTrack(const std::string& topic, double bound) const {
    const auto* row = rowOf(topic);
    ASSERT_NE(row, nullptr) << "nothing was evaluated on " << topic;
    ASSERT_TRUE(std::isfinite(rmseOfBestSensor()));
    EXPECT_LT(row->rmse, bound * rmseOfBestSensor());
    EXPECT_GT(row->coverage, 0.95);
    EXPECT_EQ(row->breaks, 0u);
    EXPECT_EQ(row->id_switches, 0u);
  }

  sightline::Evaluation last_;
};

TEST_F(SixSensors, TrackOfASingleSensorIsBetterThanItsSightings) {
  run("single_sensor");
  expectGoodTrack("/sensors/tracking_1/tracks", kSingleSensorBound);
  EXPECT_EQ(rowOf("/sensors/tracking_2/sightings"), nullptr);
}

TEST_F(SixSensors, SightingsOfSixAsynchronousSensorsMakeOneTrackBetterThanTheBestSensor) {
  run("sensor_fusion");
  expectGoodTrack("/sensor_fusion/tracks", kSixSensorsBound);
}

TEST_F(SixSensors, FusedTrackOfTwoSynchronousGroupsIsBetterThanTheBestSensor) {
  run("track_fusion");
  expectGoodTrack("/fusion/tracks", kSixSensorsBound);
  for (const char* sensor :
       {"acquisition_1", "acquisition_2", "acquisition_3", "tracking_1", "tracking_2", "tracking_3"}) {
    EXPECT_NE(rowOf(std::string("/sensors/") + sensor + "/tracks"), nullptr) << sensor;
  }
  for (const char* group : {"acquisition", "tracking"}) {
    EXPECT_NE(rowOf(std::string("/groups/") + group + "/tracks"), nullptr) << group;
  }
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "six_sensors_test");
  ros::NodeHandle keeps_ros_running;
  return RUN_ALL_TESTS();
}
