// What the doctor says, judged without a node: scans in, words out.
#include "sightline/ros/diagnosis/input_examination.h"

#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "sightline/ros/messages/conversions.h"

#include "support/scans.h"

namespace {

namespace core = sightline::core;
using sightline::SightingArray;
using sightline_ros::Finding;
using sightline_ros::GraphView;
using sightline_ros::InputExamination;
using sightline_ros::InputLimits;

constexpr double kStart = 1000.0;   // [s]
constexpr double kPeriod = 0.033;   // [s]
constexpr double kLatency = 0.005;  // [s]
constexpr int kScans = 300;

using Change = std::function<void(int number, SightingArray& scan, double& latency)>;

void nothing(int, SightingArray&, double&) {}

class Examination : public testing::Test {
 protected:
  /// Ten seconds of a sensor that sees the target; `change` spoils it.
  void look(const std::string& sensor, const Change& change = nothing,
            const std::string& publisher = "/driver") {
    SeenTarget target(static_cast<unsigned>(sensor.size() + static_cast<unsigned char>(sensor.back())));
    for (int k = 0; k < kScans; ++k) {
      const double time = kStart + kPeriod * k;
      SightingArray scan = scanOf(sensor, time, {target.at(time)});
      double latency = kLatency;
      change(k, scan, latency);
      examination_.take(scan, topicOf(sensor), publisher, core::Time(core::durationOf(time + latency)));
    }
  }

  static std::string topicOf(const std::string& sensor) { return "/sensors/" + sensor + "/sightings"; }

  std::vector<Finding> findings() {
    return examination_.findings(transforms_, "platform_enu", InputLimits{});
  }

  /// Everything that is said, a line for each finding.
  std::string said() {
    std::string lines;
    for (const Finding& finding : findings()) lines += finding.subject + ": " + finding.words + "\n";
    return lines;
  }

  /// Two healthy sensors and one that is spoilt: whether one thing is said, of that sensor, with these words.
  testing::AssertionResult saysOfTheThird(const Change& change, const std::vector<std::string>& words) {
    look("a");
    look("b");
    look("bad", change);
    const auto found = findings();
    if (found.size() != 1) return testing::AssertionFailure() << found.size() << " findings:\n" << said();
    if (found[0].subject.find("bad") == std::string::npos) return testing::AssertionFailure() << said();
    for (const std::string& word : words) {
      if (found[0].words.find(word) == std::string::npos)
        return testing::AssertionFailure() << "no \"" << word << "\" in: " << said();
    }
    return testing::AssertionSuccess();
  }

  tf2::BufferCore transforms_;
  InputExamination examination_;
};

TEST_F(Examination, FindsNothingWrongWithHealthySensors) {
  look("a");
  look("b");
  look("c");
  EXPECT_EQ(said(), "");
}

TEST_F(Examination, FindsNothingWrongWithASlowSensorOrOneOfLongButAllowedLatency) {
  look("a");
  look("slow", [](int, SightingArray& scan, double&) {
    scan.header.stamp = ros::Time(kStart + 40.0 * (scan.header.stamp.toSec() - kStart));
    scan.sightings.clear();
    scan.sightings = scanOf("", 0.0, {{0.4, 0.2}}).sightings;
  });
  look("late", [](int, SightingArray&, double& latency) { latency = 0.3; });
  const std::string words = said();
  EXPECT_EQ(words.find("late on"), std::string::npos) << words;
  EXPECT_EQ(words.find("silent"), std::string::npos) << words;
}

TEST_F(Examination, StampsAheadOfTheClock) {
  EXPECT_TRUE(saysOfTheThird([](int, SightingArray&, double& latency) { latency = -0.73; },
                             {"0.73 s ahead of the clock (median of 300 scans)", "synchronise"}));
}

TEST_F(Examination, ClocksThatAreAnHourAheadAreGivenInFull) {
  EXPECT_TRUE(saysOfTheThird([](int, SightingArray&, double& latency) { latency = -3600.0; },
                             {"its stamps are 3600 s ahead of the clock"}));
}

TEST_F(Examination, StampsBehindTheClock) {
  EXPECT_TRUE(saysOfTheThird([](int, SightingArray&, double& latency) { latency = 2.5; },
                             {"2.5 s behind the clock", "max_lag"}));
}

TEST_F(Examination, StampsOfAnotherTime) {
  EXPECT_TRUE(saysOfTheThird([](int, SightingArray&, double& latency) { latency = 4e7; },
                             {"of another time", "--clock"}));
}

TEST_F(Examination, ScansThatAreHeldUpNowAndThen) {
  EXPECT_TRUE(
      saysOfTheThird([](int k, SightingArray&, double& latency) { latency = k % 10 == 0 ? 0.9 : 0.01; },
                     {"one in twenty", "holds them up"}));
}

TEST_F(Examination, StampsThatGoBack) {
  EXPECT_TRUE(saysOfTheThird(
      [](int k, SightingArray& scan, double&) {
        if (k == 150) scan.header.stamp -= ros::Duration(3.0);
      },
      {"1 of 300 scans are stamped before the one that came before them, by up to 2.97 s"}));
}

TEST_F(Examination, StampsThatAreRepeated) {
  EXPECT_TRUE(saysOfTheThird(
      [](int k, SightingArray& scan, double&) {
        if (k % 2 == 1) scan.header.stamp -= ros::Duration(kPeriod);
        if (k % 2 == 1) scan.sightings[0].covariance = {1e-4, 0.0, 0.0, 1e-4};
        if (k % 2 == 0) scan.sightings[0].covariance = {1e-4, 0.0, 0.0, 1e-4};
        scan.sightings.push_back(scan.sightings[0]);
      },
      {"150 of 300 scans repeat the stamp of the one before", "duplicates are dropped"}));
}

TEST_F(Examination, GapsWhereASensorIsSilent) {
  EXPECT_TRUE(saysOfTheThird(
      [](int k, SightingArray& scan, double& latency) {
        if (k < 150) return;
        scan.header.stamp += ros::Duration(1.5);
        latency += 1.5;
        scan.sightings.clear();
      },
      {"silent for up to 1.53 s", "empty scan"}));
}

TEST_F(Examination, NothingButEmptyScans) {
  EXPECT_TRUE(saysOfTheThird([](int, SightingArray& scan, double&) { scan.sightings.clear(); },
                             {"saw nothing in 300 scans", "cap"}));
  EXPECT_TRUE(findings().at(0).is_note) << "the sky may be empty";
}

TEST_F(Examination, CovarianceTooSmallAndTooLarge) {
  EXPECT_TRUE(saysOfTheThird(
      [](int, SightingArray& scan, double&) {
        scan.sightings[0].covariance = {4e-8, 0.0, 0.0, 4e-8};
      },
      {"covariance is too small", "states a sigma of 0.0002 rad", "rad^2"}));
  examination_ = InputExamination();
  EXPECT_TRUE(saysOfTheThird(
      [](int, SightingArray& scan, double&) {
        scan.sightings[0].covariance = {1e-3, 0.0, 0.0, 1e-3};
      },
      {"covariance is too large"}));
}

TEST_F(Examination, CovarianceTooSmallAmongSeveralTargetsIsFoundAlongTheTracks) {
  look("a");
  SeenTarget target(7);
  sightline::AssociationArray associations;
  associations.sensor = "bad";
  associations.associations.resize(1);
  associations.associations[0].decision = sightline::Association::ACCEPTED;
  associations.associations[0].distance_squared = 1.4;  // the tracker has learnt the noise
  associations.associations[0].track = 3;
  for (int k = 0; k < kScans; ++k) {
    const double time = kStart + kPeriod * k;
    SightingArray scan = scanOf("bad", time, {{-1.0 + 0.4 * (k % 5), 0.5}, target.at(time)}, 2e-4);
    examination_.take(scan, topicOf("bad"), "/driver", core::Time(core::durationOf(time + kLatency)));
    associations.header.stamp = scan.header.stamp;
    associations.associations[0].sighting = 1;
    examination_.take(associations, "/a/associations");
  }
  ASSERT_EQ(findings().size(), 1u) << said();
  EXPECT_NE(said().find("covariance is too small: it states a sigma of 0.0002 rad"), std::string::npos)
      << said();
}

TEST_F(Examination, APlatformThatSwingsIsNoScatter) {
  // 0.5 rad at 7 rad/s, 200 deg/s: far more than the sensor's noise from scan to scan.
  const auto yawAt = [](double time) { return 0.5 * std::sin(7.0 * time); };
  for (int k = -10; k < 2100; ++k) {
    geometry_msgs::TransformStamped transform;
    const double time = kStart + 0.005 * k;
    transform.header.stamp = ros::Time(time);
    transform.header.frame_id = "platform_enu";
    transform.child_frame_id = "swinging";
    transform.transform.rotation.z = std::sin(yawAt(time) / 2.0);
    transform.transform.rotation.w = std::cos(yawAt(time) / 2.0);
    transforms_.setTransform(transform, "test");
  }
  look("a");
  look("b", [&](int, SightingArray& scan, double&) {
    scan.header.frame_id = "swinging";
    scan.sightings[0].azimuth -= yawAt(scan.header.stamp.toSec());
  });
  EXPECT_EQ(said(), "");
}

TEST_F(Examination, CovarianceZeroOrNotPositiveDefinite) {
  EXPECT_TRUE(saysOfTheThird(
      [](int, SightingArray& scan, double&) {
        scan.sightings[0].covariance = {0.0, 0.0, 0.0, 0.0};
      },
      {"300 of 300 sightings cannot be used", "not positive definite", "must state its sigma"}));
}

TEST_F(Examination, InnovationsLargerThanATrackerExpects) {
  look("a");
  sightline::AssociationArray associations;
  associations.sensor = "a";
  associations.associations.resize(1);
  associations.associations[0].decision = sightline::Association::ACCEPTED;
  associations.associations[0].distance_squared = 1.4;
  for (int k = 0; k < 100; ++k) examination_.take(associations, "/a/associations");
  EXPECT_EQ(said(), "");
  associations.associations[0].distance_squared = 12.0;
  for (int k = 0; k < 300; ++k) examination_.take(associations, "/a/associations");
  EXPECT_NE(said().find("its innovations are 2.94 times what the tracker expects"), std::string::npos)
      << said();
}

TEST_F(Examination, TracksThatAreNeverConfirmedAreOfTheSensorThatStartsThem) {
  look("a");
  for (std::uint32_t id = 1; id <= 20; ++id) {
    sightline::AssociationArray associations;
    associations.header.stamp = ros::Time(kStart + id);
    associations.sensor = "a";
    associations.associations.resize(1);
    associations.associations[0].decision = sightline::Association::STARTED_TRACK;
    associations.associations[0].track = id;
    sightline::TrackArray tracks;
    tracks.header.stamp = associations.header.stamp;
    tracks.tracks.resize(1);
    tracks.tracks[0].id = id;
    tracks.tracks[0].hits = 1;
    tracks.tracks[0].azimuth = 0.01 * id;
    tracks.tracks[0].covariance[0] = tracks.tracks[0].covariance[5] = 1e-6;
    for (const char* tracker : {"/sensors/a", "/sensor_fusion"}) {
      examination_.take(associations, std::string(tracker) + "/associations");
      examination_.take(tracks, std::string(tracker) + "/tracks");
    }
  }
  ASSERT_EQ(findings().size(), 1u) << said();
  EXPECT_FALSE(findings()[0].is_note);
  EXPECT_EQ(said().find("a: 20 of 20 sightings started a track, none was confirmed"), 0u) << said();
}

TEST_F(Examination, NoFrame) {
  EXPECT_TRUE(saysOfTheThird([](int, SightingArray& scan, double&) { scan.header.frame_id = ""; },
                             {"header.frame_id is empty"}));
}

TEST_F(Examination, FrameWithoutTransform) {
  EXPECT_TRUE(saysOfTheThird([](int, SightingArray& scan, double&) { scan.header.frame_id = "mast"; },
                             {"\"mast\" has no transform to the tracking frame \"platform_enu\"", "/tf"}));
}

TEST_F(Examination, TransformsAtOtherTimesThanTheStamps) {
  for (const double time : {10.0, 20.0}) {
    geometry_msgs::TransformStamped transform;
    transform.header.stamp = ros::Time(time);
    transform.header.frame_id = "platform_enu";
    transform.child_frame_id = "mast";
    transform.transform.rotation.w = 1.0;
    transforms_.setTransform(transform, "test");
  }
  EXPECT_TRUE(saysOfTheThird([](int, SightingArray& scan, double&) { scan.header.frame_id = "mast"; },
                             {"at the stamps of 300 of 300 scans", "at other times"}));
}

TEST_F(Examination, DegreesOffTheSphere) {
  EXPECT_TRUE(saysOfTheThird(
      [](int, SightingArray& scan, double&) {
        scan.sightings[0].azimuth *= 57.3;
        scan.sightings[0].elevation *= 57.3;
      },
      {"are these degrees?"}));
}

TEST_F(Examination, DegreesThatPassForRadiansAreFoundBesideTheOthers) {
  // The target flies near the boresight: 30 to 60 mrad, which are 1.7 to 3.4 degrees.
  const auto scaled = [](double factor) {
    return [factor](int, SightingArray& scan, double&) {
      scan.sightings[0].azimuth *= factor;
      scan.sightings[0].elevation *= factor;
      const double variance = factor * factor * 1e-6;
      scan.sightings[0].covariance = {variance, 0.0, 0.0, variance};
    };
  };
  look("a", scaled(0.05));
  look("b", scaled(0.05));
  look("bad", scaled(0.05 * 57.3));
  ASSERT_EQ(findings().size(), 1u) << said();
  EXPECT_NE(said().find("bad on /sensors/bad/sightings: what it sees is"), std::string::npos) << said();
  EXPECT_NE(said().find("are these degrees?"), std::string::npos) << said();
}

TEST_F(Examination, AzimuthsThatCountClockwise) {
  EXPECT_TRUE(saysOfTheThird([](int, SightingArray& scan, double&) { scan.sightings[0].azimuth *= -1.0; },
                             {"from anything that the other sensors see", "other sign"}));
  EXPECT_FALSE(findings().at(0).is_note);
}

TEST_F(Examination, ASensorThatLooksElsewhere) {
  EXPECT_TRUE(saysOfTheThird([](int, SightingArray& scan, double&) { scan.sightings[0].azimuth += 2.5; },
                             {"from anything that the other sensors see", "look elsewhere"}));
  EXPECT_TRUE(findings().at(0).is_note) << "it may be meant to";
}

TEST_F(Examination, SensorsThatStandApartNeedNotLookTheSameWay) {
  EXPECT_TRUE(saysOfTheThird([](int, SightingArray& scan, double&) { scan.sightings[0].azimuth += 2.5; },
                             {"from anything that the other sensors see"}));
  InputLimits limits;
  limits.stand_apart = true;
  EXPECT_TRUE(examination_.findings(transforms_, "platform_enu", limits).empty());
}

TEST_F(Examination, OneNameOnTwoTopics) {
  look("a");
  look("b");
  examination_.take(scanOf("a", kStart, {}), "/other", "/driver", core::Time(core::durationOf(kStart)));
  ASSERT_EQ(findings().size(), 1u) << said();
  EXPECT_EQ(findings()[0].subject, "a");
  EXPECT_NE(said().find("two sensors have one name: it comes on /other, /sensors/a/sightings"),
            std::string::npos)
      << said();
}

TEST_F(Examination, TwoDriversOnOneTopic) {
  look("a", nothing, "/driver_1");
  examination_.take(scanOf("a", kStart + 10.0, {}), topicOf("a"), "/driver_2",
                    core::Time(core::durationOf(kStart + 10.0)));
  EXPECT_NE(said().find("/driver_1, /driver_2 publish as \"a\""), std::string::npos) << said();
}

TEST_F(Examination, ASilentTopicIsTold) {
  look("a");
  GraphView graph;
  graph.topics.push_back({topicOf("a"), "sightline/SightingArray", {"/driver"}, {}});
  graph.topics.push_back({"/quiet", "sightline/SightingArray", {"/quiet_driver"}, {}});
  graph.topics.push_back({"/dead", "sightline/SightingArray", {}, {"/tracker"}});
  const auto silent = examination_.silentTopics(graph, 10.0);
  ASSERT_EQ(silent.size(), 1u);
  EXPECT_EQ(silent[0].subject, "/quiet");
  EXPECT_NE(silent[0].words.find("/quiet_driver"), std::string::npos);
  EXPECT_NE(silent[0].words.find("no scan came within 10 s"), std::string::npos);
}

// ---- who listens to whom

std::string wordsOf(const GraphView& graph) {
  std::string words;
  for (const Finding& finding : sightline_ros::findingsOf(graph))
    words += finding.subject + ": " + finding.words + "\n";
  return words;
}

/// A sensor, its tracker, and a fusion of that with another one's.
GraphView healthyGraph() {
  GraphView graph;
  graph.topics = {
      {"/a/sightings", "sightline/SightingArray", {"/a_driver"}, {"/a_tracker", "/display"}},
      {"/b/sightings", "sightline/SightingArray", {"/b_driver"}, {"/b_tracker", "/display"}},
      {"/a/associations", "sightline/AssociationArray", {"/a_tracker"}, {}},
      {"/b/associations", "sightline/AssociationArray", {"/b_tracker"}, {}},
      {"/a/tracks", "sightline/TrackArray", {"/a_tracker"}, {"/fusion"}},
      {"/b/tracks", "sightline/TrackArray", {"/b_tracker"}, {"/fusion"}},
      {"/nobody/tracks", "sightline/TrackArray", {}, {"/display"}},
      {"/markers", "visualization_msgs/MarkerArray", {"/display"}, {}},
      {"/fusion/report", "sightline/FusionReport", {"/fusion"}, {}},
  };
  return graph;
}

TEST(Graph, AHealthyOneHasNothingWrongThoughADisplayListensInVain) {
  EXPECT_EQ(wordsOf(healthyGraph()), "");
}

TEST(Graph, ATrackerThatListensInVain) {
  GraphView graph = healthyGraph();
  graph.topics[0].name = "/a/sigthings";
  graph.topics[0].subscribers.clear();
  graph.topics.push_back({"/a/sightings", "sightline/SightingArray", {}, {"/a_tracker"}});
  const std::string words = wordsOf(graph);
  EXPECT_NE(words.find("/a/sightings: /a_tracker listens to it, and nobody publishes it"), std::string::npos)
      << words;
  EXPECT_NE(words.find("published are /a/sigthings, /b/sightings"), std::string::npos) << words;
  EXPECT_NE(words.find("/a/sigthings: no tracker listens to it"), std::string::npos) << words;
}

TEST(Graph, AFusionThatListensInVainAndTracksThatNobodyFuses) {
  GraphView graph = healthyGraph();
  graph.topics[5].subscribers.clear();
  graph.topics.push_back({"/c/tracks", "sightline/TrackArray", {}, {"/fusion"}});
  const std::string words = wordsOf(graph);
  EXPECT_NE(words.find("/c/tracks: /fusion listens to it, and nobody publishes it"), std::string::npos)
      << words;
  EXPECT_NE(words.find("/b/sightings: is tracked by /b_tracker alone, whose tracks are in no fusion"),
            std::string::npos)
      << words;
}

TEST(Graph, NoSensorsAtAll) {
  EXPECT_NE(wordsOf(GraphView{}).find("nobody publishes sightline/SightingArray"), std::string::npos);
}

}  // namespace
