// `rosrun sightline doctor` on a live graph: good sensors, and bad ones beside them.
#include <chrono>
#include <cstdlib>
#include <functional>
#include <future>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <ros/ros.h>
#include <sightline/PositionReport.h>
#include <sightline/SightingArray.h>

#include "support/command.h"
#include "support/position_reports.h"
#include "support/received.h"
#include "support/scans.h"

namespace {

using sightline::SightingArray;

std::string topicOf(const std::string& sensor) {
  return "/sensors/" + sensor + "/sightings";
}

/// The number that follows these words in a text; NaN where they are missing.
double numberAfter(const std::string& words, const std::string& text) {
  const std::size_t begin = text.find(words);
  if (begin == std::string::npos) return std::numeric_limits<double>::quiet_NaN();
  return std::strtod(text.c_str() + begin + words.size(), nullptr);
}

class Doctor : public testing::Test {
 protected:
  using Change = std::function<void(SightingArray& scan)>;

  /// A sensor that sees the target from now on; `change` spoils it.
  void add(
      const std::string& sensor, const std::string& topic, const Change& change = [](SightingArray&) {}) {
    sensors_.push_back({sensor, nh_.advertise<SightingArray>(topic, 100), change,
                        SeenTarget(static_cast<unsigned>(sensors_.size() + 1))});
  }

  void addThreeGoodOnes() {
    for (const char* sensor : {"a", "b", "c"}) add(sensor, topicOf(sensor));
  }

  /// Exit code and words of the doctor, with the sensors at work.
  std::pair<int, std::string> examine() {
    auto outcome =
        std::async(std::launch::async, [] { return outcomeOf("rosrun sightline doctor --seconds 4"); });
    const auto has_ended = [&] {
      return outcome.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    };
    const auto publishAll = [this] {
      if (reports_) {
        report_.header.stamp = ros::Time::now();
        reports_.publish(report_);
      }
      for (Sensor& sensor : sensors_) {
        const double now = ros::Time::now().toSec();
        SightingArray scan = scanOf(sensor.name, now, {sensor.target.at(now)});
        sensor.change(scan);
        sensor.publisher.publish(scan);
      }
    };
    EXPECT_TRUE(eventually(has_ended, publishAll, ros::WallDuration(1.0 / 30.0)));
    return outcome.get();
  }

  struct Sensor {
    std::string name;
    ros::Publisher publisher;
    Change change;
    SeenTarget target;
  };

  ros::NodeHandle nh_;
  std::vector<Sensor> sensors_;
  ros::Publisher reports_;  // of positions, of `report_`; invalid = none
  sightline::PositionReport report_;
};

TEST_F(Doctor, FindsNothingWrongWithGoodSensorsAndSaysSo) {
  addThreeGoodOnes();
  ASSERT_TRUE(eventually([&] { return sensors_[2].publisher.getNumSubscribers() > 0; }));
  const auto [code, said] = examine();
  EXPECT_EQ(code, 0) << said;
  EXPECT_NE(said.find("nothing wrong found"), std::string::npos) << said;
  EXPECT_NE(said.find("sensors: 3, trackers: 1"), std::string::npos) << said;
}

TEST_F(Doctor, SaysOfEveryBadSensorWhatIsWrongWithIt) {
  addThreeGoodOnes();
  add("early", topicOf("early"), [](SightingArray& scan) { scan.header.stamp += ros::Duration(0.8); });
  add("frameless", topicOf("frameless"), [](SightingArray& scan) { scan.header.frame_id = ""; });
  add("lost", topicOf("lost"), [](SightingArray& scan) { scan.header.frame_id = "no_such_frame"; });
  add("sure", topicOf("sure"), [](SightingArray& scan) {
    scan.sightings[0].covariance = {1e-8, 0.0, 0.0, 1e-8};
  });
  add("mirrored", topicOf("mirrored"), [](SightingArray& scan) { scan.sightings[0].azimuth *= -1.0; });
  add("degrees", topicOf("degrees"), [](SightingArray& scan) { scan.sightings[0].azimuth *= 57.3; });
  add("capped", topicOf("capped"), [](SightingArray& scan) { scan.sightings.clear(); });
  add("a", topicOf("a_again"));
  const ros::Publisher silent = nh_.advertise<SightingArray>("/silent", 1);
  const auto [code, said] = examine();
  EXPECT_EQ(code, 1) << said;
  EXPECT_NE(said.find("things are wrong"), std::string::npos) << said;
  const std::vector<std::string> expected{
      "header.frame_id is empty",
      "\"no_such_frame\" has no transform to the tracking frame \"platform_enu\"",
      "sure on /sensors/sure/sightings: its covariance is too small",
      "mirrored on /sensors/mirrored/sightings: what it sees is",
      "are these degrees?",
      "note   capped on /sensors/capped/sightings: saw nothing",
      "a: two sensors have one name",
      "/silent: is published by",
      "/sensors/early/sightings: no tracker listens to it",
  };
  // 0.8 s less what the scans need to arrive
  EXPECT_NEAR(numberAfter("early on /sensors/early/sightings: its stamps are ", said), 0.8, 0.1) << said;
  for (const std::string& words : expected)
    EXPECT_NE(said.find(words), std::string::npos) << words << "\n" << said;
  for (const char* good : {"WRONG  a on", "WRONG  b on", "WRONG  c on"})
    EXPECT_EQ(said.find(good), std::string::npos) << said;
}

TEST_F(Doctor, SaysWhatReportsTellOfStationsThatStandApart) {
  addThreeGoodOnes();
  add("elsewhere", topicOf("elsewhere"), [](SightingArray& scan) { scan.sightings[0].azimuth -= 2.5; });
  EXPECT_NE(examine().second.find("elsewhere on /sensors/elsewhere/sightings: what it sees is"),
            std::string::npos);
  reports_ = nh_.advertise<sightline::PositionReport>("/positions/report", 100);
  report_ = positionReport({"a", "b", "c"});
  report_.positions.resize(1);
  report_.stations[1].clock_behind = 0.0512;
  report_.stations[1].clock_sigma = 0.0017;
  report_.stations[1].corrected = true;
  report_.unlocated = {unlocatedTrack("a/7", "one station only")};
  const auto [code, said] = examine();
  EXPECT_EQ(code, 1) << said;
  EXPECT_EQ(numberAfter("WRONG  b in /positions/report: its clock is ", said), 0.0512) << said;
  EXPECT_EQ(numberAfter("that are right (standard deviation ", said), 0.0017) << said;
  EXPECT_EQ(numberAfter("note   c in /positions/report: its clock is ", said), 0.003) << said;
  const double without = numberAfter("note   a in /positions/report: its a/7 for ", said);
  EXPECT_GE(without, 1.0) << said;  // of the 4 s, less what passed before the doctor listened
  EXPECT_LE(without, 4.5) << said;
  EXPECT_EQ(said.find("from anything that the other sensors see"), std::string::npos) << said;
}

TEST_F(Doctor, RefusesWhatItDoesNotUnderstand) {
  const auto [code, said] = outcomeOf("rosrun sightline doctor --seconds never");
  EXPECT_EQ(code, 2) << said;
  EXPECT_NE(said.find("--seconds: expected a number above 0, got \"never\""), std::string::npos) << said;
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "input_doctor_test");
  ros::NodeHandle keeps_ros_running;
  return RUN_ALL_TESTS();
}
