#include "sightline/ros/recordings/replay.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <ros/serialization.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sightline/FusionReport.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>
#include <std_msgs/String.h>
#include <tf2_msgs/TFMessage.h>

#include "sightline/ros/params/param_reader.h"
#include "sightline/ros/recordings/bags.h"
#include "sightline/ros/recordings/replay_parameters.h"

#include "support/bytes.h"
#include "support/scratch_folder.h"

namespace {

using sightline::test::bytesOf;
using sightline_ros::kReplayParameters;
using sightline_ros::ParamError;
using sightline_ros::parametersText;
using sightline_ros::replay;
using sightline_ros::ReplaySettings;
using sightline_ros::ReplaySummary;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kStart = 100.0;  // [s]

sightline::SightingArray scanOf(const std::string& sensor, double stamp, double azimuth) {
  sightline::SightingArray scan;
  scan.header.stamp = ros::Time(stamp);
  scan.header.frame_id = sensor;
  scan.sensor = sensor;
  scan.ifov = scan.detection_probability = scan.clutter_density = kNaN;
  sightline::Sighting sighting;
  sighting.azimuth = azimuth;
  sighting.covariance = {1e-6, 0.0, 0.0, 1e-6};
  sighting.snr = kNaN;
  scan.sightings.push_back(sighting);
  return scan;
}

/// Scans of two sensors that look at one target and some clutter.
std::vector<sightline::SightingArray> twoSensors() {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 1e-3);
  std::uniform_real_distribution<double> clutter(-1.0, 1.0);
  std::vector<sightline::SightingArray> scans;
  for (int i = 0; i < 200; ++i) {
    const double t = 0.03 * i;
    for (const char* sensor : {"left", "right"}) {
      // In some scans both look at the same instant.
      const double stamp = kStart + t + (sensor[0] == 'l' && i % 3 != 0 ? 0.011 : 0.0);
      const double seen_at = stamp - kStart;
      auto scan = scanOf(sensor, stamp, 0.3 * std::sin(seen_at) - 0.02 * seen_at + noise(random));
      if (i % 5 == 0) scan.sightings.push_back(scanOf(sensor, stamp, clutter(random)).sightings[0]);
      scans.push_back(scan);
    }
  }
  return scans;
}

/// The sensors' frames, on a platform that turns.
std::vector<tf2_msgs::TFMessage> turningFrames() {
  std::vector<tf2_msgs::TFMessage> messages;
  for (int i = -10; i < 350; ++i) {
    tf2_msgs::TFMessage message;
    for (const char* sensor : {"left", "right"}) {
      geometry_msgs::TransformStamped transform;
      transform.header.stamp = ros::Time(kStart + 0.02 * i);
      transform.header.frame_id = "platform_enu";
      transform.child_frame_id = sensor;
      const double yaw = 0.02 * (0.02 * i);
      transform.transform.rotation.z = std::sin(yaw / 2.0);
      transform.transform.rotation.w = std::cos(yaw / 2.0);
      message.transforms.push_back(transform);
    }
    messages.push_back(message);
  }
  return messages;
}

/// A recording in which every message came with a latency drawn anew up to `most` seconds.
void record(const std::string& file, double most, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> latency(0.0, most);
  rosbag::Bag bag(file, rosbag::bagmode::Write);
  for (const auto& scan : twoSensors()) {
    bag.write("/" + scan.sensor, scan.header.stamp + ros::Duration(latency(random)), scan);
  }
  for (const auto& message : turningFrames()) {
    bag.write("/tf", message.transforms[0].header.stamp + ros::Duration(latency(random)), message);
  }
}

/// Topic and bytes of every track message, in the order of the bag.
std::vector<std::pair<std::string, std::string>> tracksIn(const std::string& file) {
  rosbag::Bag bag(file);
  std::vector<std::pair<std::string, std::string>> tracks;
  rosbag::View view(bag, rosbag::TypeQuery("sightline/TrackArray"));
  for (const rosbag::MessageInstance& message : view) {
    tracks.emplace_back(message.getTopic(), bytesOf(*message.instantiate<sightline::TrackArray>()));
  }
  return tracks;
}

std::size_t countOf(const std::string& file, const std::string& topic) {
  rosbag::Bag bag(file);
  return rosbag::View(bag, rosbag::TopicQuery(topic)).size();
}

/// Every message is written.
ReplaySettings everything() {
  ReplaySettings settings;
  settings.all = true;
  return settings;
}

class Replay : public testing::Test {
 protected:
  std::string file(const std::string& name) const { return folder_.file(name); }
  ScratchFolder folder_;
};

TEST_F(Replay, EveryScanGivesTracksOfItsSensorAndOfAllSensors) {
  record(file("in.bag"), 0.0, 1);
  const ReplaySummary summary = replay(file("in.bag"), file("out.bag"), everything());
  EXPECT_EQ(summary.scans, 400u);
  EXPECT_EQ(summary.sightings, 480u);
  EXPECT_TRUE(summary.drops.empty());
  EXPECT_NEAR(summary.recorded, 199 * 0.03 + 0.011, 1e-6);
  EXPECT_EQ(countOf(file("out.bag"), "/sensors/left/tracks"), 200u);
  EXPECT_EQ(countOf(file("out.bag"), "/sensors/right/tracks"), 200u);
  EXPECT_EQ(countOf(file("out.bag"), "/sensors/right/associations"), 200u);
  EXPECT_EQ(countOf(file("out.bag"), "/sensor_fusion/tracks"), 400u);
  const std::size_t fusions = countOf(file("out.bag"), "/fusion/tracks");
  EXPECT_GE(fusions, 200u);
  EXPECT_LE(fusions, 210u) << "one a round of both, and one a report until their pace is known";
  EXPECT_EQ(countOf(file("out.bag"), "/fusion/report"), fusions);
}

TEST_F(Replay, UnlessAllIsWantedWhatNobodyGoesOnWithIsWrittenSeldom) {
  record(file("in.bag"), 0.0, 1);
  const ReplaySummary all = replay(file("in.bag"), file("all.bag"), everything());
  const ReplaySummary summary = replay(file("in.bag"), file("out.bag"), {});
  const auto count = [&](const std::string& topic) { return countOf(file("out.bag"), topic); };
  for (const char* topic : {"/fusion/tracks", "/sensors/left/tracks", "/sensors/left/associations", "/left"})
    EXPECT_EQ(count(topic), countOf(file("all.bag"), topic)) << topic;
  const std::size_t seldom = count("/sensor_fusion/tracks");
  EXPECT_GE(seldom, 45u);
  EXPECT_LE(seldom, 60u) << "ten a second";
  EXPECT_EQ(count("/sensor_fusion/associations"), seldom) << "those of the tracks that are written";
  EXPECT_GE(count("/fusion/report"), 6u) << "one a second";
  EXPECT_LT(count("/fusion/report"), countOf(file("all.bag"), "/fusion/report") / 4);
  EXPECT_EQ(count("/sensor_fusion/tracklets") + count("/sensors/left/tracklets"), 0u);
  EXPECT_GT(summary.left_out_messages, 1000u);
  EXPECT_EQ(all.left_out_messages, 0u);
  rosbag::Bag one(file("all.bag")), other(file("out.bag"));
  EXPECT_EQ(rosbag::View(one).size() - rosbag::View(other).size(), summary.left_out_messages);
}

TEST_F(Replay, AReportWithNewsIsWrittenAtOnce) {
  record(file("in.bag"), 0.0, 1);
  replay(file("in.bag"), file("all.bag"), everything());
  replay(file("in.bag"), file("out.bag"), {});
  const auto supported = [](const std::string& name) {  // since when there is a track of both sensors [s]
    rosbag::Bag bag(name);
    rosbag::View view(bag, rosbag::TopicQuery("/fusion/report"));
    for (const rosbag::MessageInstance& message : view) {
      const auto report = message.instantiate<sightline::FusionReport>();
      for (const auto& track : report->tracks)
        if (track.sources.size() == 2) return report->header.stamp.toSec();
    }
    return 0.0;
  };
  EXPECT_GT(supported(file("all.bag")), 0.0);
  EXPECT_EQ(supported(file("out.bag")), supported(file("all.bag")));
}

TEST_F(Replay, OnlyWantedTopicsAreWrittenAndOneThatIsNoneIsSaid) {
  record(file("in.bag"), 0.0, 1);
  ReplaySettings settings;
  settings.topics = {"/fusion/tracks", "/sensors/left*", "/fusion/trakcs"};
  const ReplaySummary summary = replay(file("in.bag"), file("out.bag"), settings);
  EXPECT_GE(countOf(file("out.bag"), "/fusion/tracks"), 200u);
  EXPECT_EQ(countOf(file("out.bag"), "/sensors/left/tracks"), 200u);
  EXPECT_EQ(countOf(file("out.bag"), "/sensors/left/associations"), 200u);
  for (const char* topic : {"/fusion/report", "/sensors/right/tracks", "/sensors/right/associations",
                            "/sensor_fusion/tracks", "/sensor_fusion/tracklets"})
    EXPECT_EQ(countOf(file("out.bag"), topic), 0u) << topic;
  EXPECT_EQ(countOf(file("out.bag"), "/left"), 200u) << "messages of the recording are copied";
  ASSERT_EQ(summary.notices.size(), 1u);
  EXPECT_NE(summary.notices[0].find("\"/fusion/trakcs\""), std::string::npos) << summary.notices[0];
}

TEST_F(Replay, TargetIsTrackedInTheTrackingFrameOfTheTurningPlatform) {
  record(file("in.bag"), 0.0, 1);
  replay(file("in.bag"), file("out.bag"), {});
  rosbag::Bag bag(file("out.bag"));
  sightline::TrackArray::ConstPtr last;
  rosbag::View view(bag, rosbag::TopicQuery("/sensor_fusion/tracks"));
  for (const rosbag::MessageInstance& message : view) last = message.instantiate<sightline::TrackArray>();
  ASSERT_TRUE(last);
  const double t = (last->header.stamp - ros::Time(kStart)).toSec();
  const double seen_in_sensor = 0.3 * std::sin(t) - 0.02 * t;
  const auto near = [&](const sightline::Track& track) {
    return track.status == sightline::Track::CONFIRMED &&
           std::abs(track.azimuth - (seen_in_sensor + 0.02 * t)) < 0.02;  // the platform has turned by 0.12
  };
  EXPECT_EQ(std::count_if(last->tracks.begin(), last->tracks.end(), near), 1);
}

TEST_F(Replay, TwoRunsGiveTheSameBytes) {
  record(file("in.bag"), 0.2, 1);
  replay(file("in.bag"), file("one.bag"), everything());
  replay(file("in.bag"), file("two.bag"), everything());
  const auto tracks = tracksIn(file("one.bag"));
  EXPECT_EQ(tracks.size(), 800u + countOf(file("one.bag"), "/fusion/tracks"));
  EXPECT_TRUE(tracks == tracksIn(file("two.bag")));
}

TEST_F(Replay, OrderOfArrivalWithinTheLagDoesNotChangeABit) {
  record(file("in.bag"), 0.0, 1);
  replay(file("in.bag"), file("out.bag"), everything());
  const auto tracks = tracksIn(file("out.bag"));
  for (unsigned seed = 2; seed < 6; ++seed) {
    record(file("shuffled.bag"), 0.45, seed);
    const auto summary = replay(file("shuffled.bag"), file("shuffled_out.bag"), everything());
    EXPECT_TRUE(summary.drops.empty());
    EXPECT_TRUE(tracks == tracksIn(file("shuffled_out.bag"))) << "seed " << seed;
  }
}

TEST_F(Replay, NothingIsLateUnlessItIsToBeAsLive) {
  // One sensor is recorded 0.7 s after its stamps, and the platform's attitude comes once a second.
  {
    rosbag::Bag bag(file("in.bag"), rosbag::bagmode::Write);
    for (const auto& scan : twoSensors())
      bag.write("/" + scan.sensor, scan.header.stamp + ros::Duration(scan.sensor == "left" ? 0.7 : 0.0),
                scan);
    for (int i = 5; i < 360; i += 50)
      bag.write("/tf", ros::Time(kStart + 0.02 * i), turningFrames().at(static_cast<std::size_t>(i)));
  }
  const ReplaySummary summary = replay(file("in.bag"), file("out.bag"), {});
  EXPECT_TRUE(summary.drops.empty()) << summary.drops.begin()->first;
  EXPECT_TRUE(summary.notices.empty());
  for (const char* sensor : {"left", "right"})
    EXPECT_EQ(countOf(file("out.bag"), std::string("/sensors/") + sensor + "/tracks"), 200u);

  ReplaySettings live;
  live.live = true;
  const ReplaySummary as_live = replay(file("in.bag"), file("live.bag"), live);
  EXPECT_GT(as_live.drops.at("recording: scan dropped, later than max_lag"), 150u);
  EXPECT_GT(as_live.drops.at("right: scan dropped, no transform"), 70u);
  EXPECT_NE(as_live.examples.at("right: scan dropped, no transform")
                .find("in frame \"right\": no transform from right"),
            std::string::npos)
      << as_live.examples.at("right: scan dropped, no transform");
}

TEST_F(Replay, ScanLaterThanTheLagIsDroppedAsLiveAndUsedOtherwise) {
  {
    rosbag::Bag bag(file("in.bag"), rosbag::bagmode::Write);
    auto late = scanOf("eye", 10.0, 0.1);
    late.header.frame_id = "platform_enu";
    auto newer = scanOf("eye", 10.6, 0.1);
    newer.header.frame_id = "platform_enu";
    bag.write("/eye", ros::Time(10.6), newer);
    bag.write("/eye", ros::Time(10.7), late);
  }
  ReplaySettings live;
  live.live = true;
  const auto summary = replay(file("in.bag"), file("out.bag"), live);
  EXPECT_EQ(summary.drops.at("recording: scan dropped, later than max_lag"), 1u);
  EXPECT_EQ(countOf(file("out.bag"), "/sensor_fusion/tracks"), 1u);
  EXPECT_TRUE(replay(file("in.bag"), file("out.bag"), {}).drops.empty());
  EXPECT_EQ(countOf(file("out.bag"), "/sensor_fusion/tracks"), 2u);
}

TEST_F(Replay, ScanThatNoTrackerCouldUseDoesNotDisturbTheOthers) {
  {
    rosbag::Bag bag(file("in.bag"), rosbag::bagmode::Write);
    for (int i = 0; i < 10; ++i) {
      auto scan = scanOf("eye", 10.0 + 0.1 * i, 0.1);
      scan.header.frame_id = i == 3 ? "nowhere" : "platform_enu";
      if (i == 4) scan.header.stamp = ros::Time(1e9);
      if (i == 5) scan.header.stamp = ros::Time(0.0);
      bag.write("/eye", ros::Time(10.0 + 0.1 * i), scan);
    }
  }
  const auto summary = replay(file("in.bag"), file("out.bag"), {});
  EXPECT_EQ(summary.drops.at("eye: scan dropped, no transform"), 1u);
  EXPECT_NE(summary.examples.at("eye: scan dropped, no transform").find("from nowhere to platform_enu"),
            std::string::npos);
  EXPECT_NE(summary.examples.at("eye: scan dropped, no transform").find("publish it on /tf"),
            std::string::npos);
  EXPECT_EQ(summary.drops.at("recording: scan dropped, no stamp"), 1u);
  EXPECT_EQ(summary.drops.at("recording: scan dropped, stamped more than max_future after it was received"),
            1u);
  EXPECT_EQ(countOf(file("out.bag"), "/sensors/eye/tracks"), 7u);
}

TEST_F(Replay, ARecordingOfALoopIsTrackedAgainFromItsStart) {
  {
    rosbag::Bag bag(file("in.bag"), rosbag::bagmode::Write);
    for (const double later : {1.0, 11.0}) {  // received so long after the stamps: played twice
      for (const auto& scan : twoSensors())
        bag.write("/" + scan.sensor, scan.header.stamp + ros::Duration(later), scan);
      for (const auto& message : turningFrames())
        bag.write("/tf", message.transforms[0].header.stamp + ros::Duration(later), message);
    }
  }
  const ReplaySummary summary = replay(file("in.bag"), file("out.bag"), everything());
  ASSERT_EQ(summary.notices.size(), 1u);
  EXPECT_NE(summary.notices[0].find("stamps went back by"), std::string::npos) << summary.notices[0];
  EXPECT_GT(countOf(file("out.bag"), "/sensor_fusion/tracks"), 780u)
      << "of 800 scans; the first ones are late";
  rosbag::Bag bag(file("out.bag"));
  rosbag::View view(bag, rosbag::TopicQuery("/fusion/tracks"));
  int of_the_end = 0;  // fused tracks of the last second, of both rounds
  for (const rosbag::MessageInstance& message : view) {
    const auto tracks = message.instantiate<sightline::TrackArray>();
    of_the_end += tracks->header.stamp > ros::Time(kStart + 5.0) && tracks->tracks.size() == 1 ? 1 : 0;
  }
  EXPECT_GT(of_the_end, 50);
}

TEST_F(Replay, ASensorAnHourAheadDoesNotDisturbTheOthers) {
  // Recorded at another time than the stamps', so that no clock tells who is right.
  const auto write = [&](const std::string& name, bool with_third) {
    rosbag::Bag bag(file(name), rosbag::bagmode::Write);
    const ros::Duration later(1e6);
    for (const auto& scan : twoSensors()) {
      bag.write("/" + scan.sensor, scan.header.stamp + later, scan);
      if (!with_third || scan.sensor == "right") continue;
      auto ahead = scanOf("third", scan.header.stamp.toSec() + 3600.0, 0.1);
      ahead.header.frame_id = "platform_enu";
      bag.write("/third", scan.header.stamp + later + ros::Duration(0.001), ahead);
    }
    for (const auto& message : turningFrames())
      bag.write("/tf", message.transforms[0].header.stamp + later, message);
  };
  write("two.bag", false);
  write("three.bag", true);
  replay(file("two.bag"), file("out_two.bag"), {});
  const ReplaySummary summary = replay(file("three.bag"), file("out_three.bag"), {});
  ASSERT_EQ(summary.notices.size(), 1u);
  EXPECT_NE(summary.notices[0].find("stamps of third are 3600 s ahead"), std::string::npos)
      << summary.notices[0];
  EXPECT_EQ(summary.drops.at("recording: scan dropped, its stamp is ahead of the other sensors'"), 200u);
  EXPECT_EQ(tracksIn(file("out_three.bag")), tracksIn(file("out_two.bag")));
}

TEST_F(Replay, EveryMessageThatIsNotReplacedIsCopied) {
  record(file("in.bag"), 0.0, 1);
  {
    rosbag::Bag bag(file("in.bag"), rosbag::bagmode::Append);
    std_msgs::String note;
    note.data = "keep me";
    bag.write("/note", ros::Time(kStart + 1.0), note);
    sightline::TrackArray old;
    old.tracker = "of the live run";
    bag.write("/sensor_fusion/tracks", ros::Time(kStart + 1.0), old);
    bag.write("/truth", ros::Time(kStart + 1.0), old);
  }
  const auto summary = replay(file("in.bag"), file("out.bag"), everything());
  EXPECT_EQ(summary.copied_messages, 400u + turningFrames().size() + 2u);
  EXPECT_EQ(countOf(file("out.bag"), "/left"), 200u);
  EXPECT_EQ(countOf(file("out.bag"), "/tf"), turningFrames().size());
  EXPECT_EQ(countOf(file("out.bag"), "/truth"), 1u);
  EXPECT_EQ(countOf(file("out.bag"), "/sensor_fusion/tracks"), 400u) << "the live run's are replaced";
  rosbag::Bag bag(file("out.bag"));
  rosbag::View notes(bag, rosbag::TopicQuery("/note"));
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes.begin()->instantiate<std_msgs::String>()->data, "keep me");
  EXPECT_EQ(notes.begin()->getTime(), ros::Time(kStart + 1.0));
}

TEST_F(Replay, FusedTrackIsMadeOfBothSensorsTracks) {
  record(file("in.bag"), 0.0, 1);
  replay(file("in.bag"), file("out.bag"), {});
  rosbag::Bag bag(file("out.bag"));
  rosbag::View view(bag, rosbag::TopicQuery("/fusion/tracks"));
  const auto is_of_both = [](const sightline::Track& track) {
    return track.sources == std::vector<std::string>{"left", "right"};
  };
  std::size_t with_both = 0;
  for (const rosbag::MessageInstance& message : view) {
    const auto fused = message.instantiate<sightline::TrackArray>();
    EXPECT_EQ(fused->tracker, "fusion");
    if (std::any_of(fused->tracks.begin(), fused->tracks.end(), is_of_both)) ++with_both;
  }
  EXPECT_GE(with_both, 150u);
}

TEST_F(Replay, FusedTrackKnowsWhatTheTrackerOverAllSensorsKnows) {
  record(file("in.bag"), 0.0, 1);
  // Trackers of their own sightings learn the sensors' noise a little differently.
  const std::string stated = "{noise_calibration: {enabled: false}}";
  const std::string config =
      folder_.write("config.yaml", "local_tracker: " + stated + "\nsensor_fusion: " + stated + "\n");
  ReplaySettings settings = everything();
  settings.config = config;
  settings.estimator = "kalman";
  replay(file("in.bag"), file("out.bag"), settings);
  EXPECT_EQ(countOf(file("out.bag"), "/sensors/left/tracklets"), 200u);
  EXPECT_EQ(countOf(file("out.bag"), "/sensor_fusion/tracklets"), 400u);
  rosbag::Bag bag(file("out.bag"));
  std::map<ros::Time, sightline::Track> fused, central;
  std::size_t by_tracklets = 0;
  rosbag::View view(bag);
  for (const rosbag::MessageInstance& message : view) {
    const bool is_central = message.getTopic() == "/sensor_fusion/tracks";
    if (is_central || message.getTopic() == "/fusion/tracks") {
      const auto array = message.instantiate<sightline::TrackArray>();
      for (const sightline::Track& track : array->tracks)
        if (track.status == sightline::Track::CONFIRMED && track.hits > 50)
          (is_central ? central : fused)[array->header.stamp] = track;
    } else if (message.getTopic() == "/fusion/report") {
      const auto report = message.instantiate<sightline::FusionReport>();
      for (const auto& track : report->tracks) by_tracklets += track.rule == "tracklets" ? 1 : 0;
    }
  }
  EXPECT_GT(by_tracklets, 150u);
  // Where all trackers took the same sightings the two are equal; now and then clutter goes to one of them.
  std::size_t compared = 0, equal = 0;
  for (const auto& [stamp, track] : fused) {
    const auto other = central.find(stamp);
    if (other == central.end()) continue;
    ++compared;
    if (std::abs(track.azimuth - other->second.azimuth) < 0.01 * std::sqrt(track.covariance[0])) ++equal;
  }
  EXPECT_GT(compared, 100u);
  EXPECT_GT(equal, compared * 8 / 10);
}

TEST_F(Replay, ConfigurationAndEstimatorAreObeyed) {
  record(file("in.bag"), 0.0, 1);
  const std::string config =
      folder_.write("config.yaml",
                    "local_tracker: {estimator: kalman, lifecycle: {confirm_hits: 2}}\n"
                    "sensor_fusion: {tracker_name: everything}\n"
                    "track_fusion: {rule: weighted_covariance}\n");
  const auto newest = [&](const std::string& topic) {
    rosbag::Bag bag(file("out.bag"));
    rosbag::View view(bag, rosbag::TopicQuery(topic));
    sightline::TrackArray::ConstPtr message;
    for (const rosbag::MessageInstance& instance : view)
      message = instance.instantiate<sightline::TrackArray>();
    return *message;
  };
  replay(file("in.bag"), file("out.bag"), {config, "", "", false});
  EXPECT_EQ(newest("/sensors/left/tracks").estimator, "kalman");
  EXPECT_EQ(newest("/sensors/left/tracks").tracker, "left");
  EXPECT_EQ(newest("/sensor_fusion/tracks").tracker, "everything");
  EXPECT_EQ(newest("/fusion/tracks").estimator, "weighted_covariance");
  replay(file("in.bag"), file("out.bag"), {config, "imm", "covariance_intersection", false});
  EXPECT_EQ(newest("/sensors/left/tracks").estimator, "imm");
  EXPECT_EQ(newest("/sensor_fusion/tracks").estimator, "imm");
  EXPECT_EQ(newest("/fusion/tracks").estimator, "covariance_intersection");
}

TEST_F(Replay, SaysWhatItWasToldOnce) {
  record(file("in.bag"), 0.0, 1);
  const std::string config = folder_.write("config.yaml",
                                           "local_tracker: {estimator: kalman, max_lag: 0.5}\n"
                                           "position_tracker: {frames: [a, b]}\n");
  EXPECT_EQ(
      parametersText({config, "imm", "", true, false}),
      "--config: " + config +
          "\nlocal_tracker/estimator: kalman\nlocal_tracker/max_lag: 0.5\n"
          "position_tracker/frames: [a, b]\n--estimator: imm\n--positions: no\n--all: no\n--live: yes\n");
  replay(file("in.bag"), file("out.bag"), {"", "imm", "", false});
  replay(file("out.bag"), file("again.bag"), {"", "kalman", "", false});
  rosbag::Bag bag(file("again.bag"));
  rosbag::View view(bag, rosbag::TopicQuery(kReplayParameters));
  ASSERT_EQ(view.size(), 1u) << "those of the replay before are replaced";
  EXPECT_EQ(view.begin()->instantiate<std_msgs::String>()->data,
            "--config: none\n--estimator: kalman\n--all: no\n");
}

TEST_F(Replay, WrongSettingsAreRefusedAndLeaveNothingBehind) {
  record(file("in.bag"), 0.0, 1);
  const auto refusal = [&](const std::string& in, const std::string& out, const ReplaySettings& settings) {
    try {
      replay(in, out, settings);
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string config = folder_.write("config.yaml", "local_traker: {estimator: kalman}\n");
  EXPECT_NE(refusal(file("in.bag"), file("out.bag"), {config, "", "", false}).find("did you mean"),
            std::string::npos);
  EXPECT_NE(refusal(file("in.bag"), file("out.bag"), {"", "kallman", "", false}).find("expected one of"),
            std::string::npos);
  EXPECT_NE(refusal(file("in.bag"), file("out.bag"), {"", "", "magic", false}).find("expected one of"),
            std::string::npos);
  EXPECT_NE(refusal(file("in.bag"), file("in.bag"), {}).find("read and written at once"), std::string::npos);
  EXPECT_NE(refusal(file("absent.bag"), file("out.bag"), {}).find("no such file"), std::string::npos);
  EXPECT_NE(refusal(folder_.write("text.bag", "hello"), file("out.bag"), {}).find("no readable bag"),
            std::string::npos);
  {
    rosbag::Bag bag(file("empty.bag"), rosbag::bagmode::Write);
    bag.write("/note", ros::Time(1.0), std_msgs::String());
  }
  EXPECT_NE(refusal(file("empty.bag"), file("out.bag"), {}).find("no sightline/SightingArray"),
            std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(file("out.bag")));
  EXPECT_FALSE(std::filesystem::exists(file("out.bag.unfinished")));
}

TEST_F(Replay, LatchedTopicsStayLatched) {
  record(file("in.bag"), 0.0, 1);
  {
    rosbag::Bag bag(file("in.bag"), rosbag::bagmode::Append);
    bag.write("/tf_static", ros::Time(kStart), turningFrames()[0],
              sightline_ros::latchedHeader<tf2_msgs::TFMessage>());
  }
  replay(file("in.bag"), file("out.bag"), {});
  rosbag::Bag bag(file("out.bag"));
  rosbag::View view(bag, rosbag::TopicQuery("/tf_static"));
  ASSERT_EQ(view.size(), 1u);
  EXPECT_TRUE(view.begin()->isLatching());
}

TEST_F(Replay, WhatHasNoRoomIsCountedWithTheParametersName) {
  {
    rosbag::Bag bag(file("in.bag"), rosbag::bagmode::Write);
    for (int k = 0; k < 40; ++k) {
      auto scan = scanOf("eye", 10.0 + 0.05 * k, -1.0);
      scan.header.frame_id = "platform_enu";
      for (int i = 1; i < 6; ++i) scan.sightings.push_back(scanOf("eye", 0.0, -1.0 + 0.3 * i).sightings[0]);
      bag.write("/eye", scan.header.stamp, scan);
    }
  }
  const std::string config = folder_.write("config.yaml",
                                           "track_fusion: {max_tracks: 4}\n"
                                           "sensor_fusion: {max_tracks: 5}\n");
  const ReplaySummary summary = replay(file("in.bag"), file("out.bag"), {config, "", "", false});
  EXPECT_NE(summary.examples.at("fusion: local tracks left out, limit").find("max_tracks"),
            std::string::npos);
  EXPECT_NE(summary.examples.at("sensor_fusion: sightings rejected").find("max_tracks 5"), std::string::npos);
}

TEST_F(Replay, SensorWhoseNameIsNoTopicIsGivenOne) {
  {
    rosbag::Bag bag(file("in.bag"), rosbag::bagmode::Write);
    for (const char* sensor : {"cam-1", "cam_1"}) {
      auto scan = scanOf(sensor, 10.0, 0.1);
      scan.header.frame_id = "platform_enu";
      bag.write("/eye", ros::Time(10.0), scan);
    }
  }
  const auto summary = replay(file("in.bag"), file("out.bag"), {});
  EXPECT_EQ(summary.topics.size(), 1u);
  EXPECT_EQ(countOf(file("out.bag"), "/sensors/cam_1/tracks"), 1u);
  EXPECT_EQ(countOf(file("out.bag"), "/sensors/cam_1_/tracks"), 1u);
}

}  // namespace
