#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>

#include "sightline/ros/recordings/replay.h"

#include "support/bytes.h"
#include "support/scratch_folder.h"

namespace {

using sightline::test::bytesOf;
using sightline_ros::replay;
using sightline_ros::ReplaySettings;

constexpr double kBegin = 50.0;  // [s]
constexpr double kNoise = 1e-3;  // [rad]

double azimuthAt(double stamp) {
  return 0.3 * std::sin(stamp - kBegin);
}

/// Ten seconds of two sensors in the tracking frame, with a second in which neither sees the target.
void recordSinusoid(const std::string& file) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, kNoise);
  rosbag::Bag bag(file, rosbag::bagmode::Write);
  for (int i = 0; i < 300; ++i) {
    for (const char* sensor : {"left", "right"}) {
      const double stamp = kBegin + 0.0333 * i + (sensor[0] == 'l' ? 0.0 : 0.0111);
      sightline::SightingArray scan;
      scan.header.stamp = ros::Time(stamp);
      scan.header.frame_id = "platform_enu";
      scan.sensor = sensor;
      scan.ifov = scan.detection_probability = scan.clutter_density =
          std::numeric_limits<double>::quiet_NaN();
      if (i < 150 || i >= 180) {
        sightline::Sighting sighting;
        sighting.azimuth = azimuthAt(scan.header.stamp.toSec()) + noise(random);
        sighting.elevation = noise(random);
        sighting.covariance = {kNoise * kNoise, 0.0, 0.0, kNoise * kNoise};
        sighting.snr = std::numeric_limits<double>::quiet_NaN();
        scan.sightings.push_back(sighting);
      }
      bag.write("/" + scan.sensor, scan.header.stamp, scan);
    }
  }
}

std::vector<sightline::TrackArray> messagesOf(const std::string& file, const std::string& topic) {
  rosbag::Bag bag(file);
  std::vector<sightline::TrackArray> messages;
  rosbag::View view(bag, rosbag::TopicQuery(topic));
  for (const rosbag::MessageInstance& message : view)
    messages.push_back(*message.instantiate<sightline::TrackArray>());
  return messages;
}

/// Root mean square error of the azimuth from two seconds on [rad], and the mean of its square over the
/// variance.
std::pair<double, double> errorOf(const std::vector<sightline::TrackArray>& messages) {
  double square = 0.0, nees = 0.0;
  int count = 0;
  for (const sightline::TrackArray& message : messages) {
    const double stamp = message.header.stamp.toSec();
    if (stamp < kBegin + 2.0) continue;
    for (const sightline::Track& track : message.tracks) {
      const double error = track.azimuth - azimuthAt(stamp);
      square += error * error;
      nees += error * error / track.covariance[0];
      ++count;
    }
  }
  return {std::sqrt(square / count), nees / count};
}

class SmoothedReplay : public testing::Test {
 protected:
  std::string file(const std::string& name) const { return folder_.file(name); }
  ScratchFolder folder_;
};

TEST_F(SmoothedReplay, WritesTheTracksOnceMoreNearerToTheTargetsAndAllElseAsWithout) {
  recordSinusoid(file("in.bag"));
  replay(file("in.bag"), file("plain.bag"), {});
  ReplaySettings settings;
  settings.smooth = true;
  replay(file("in.bag"), file("out.bag"), settings);
  for (const char* topic : {"/sensors/left/tracks", "/sensor_fusion/tracks"}) {
    const auto tracks = messagesOf(file("out.bag"), topic);
    const auto smoothed = messagesOf(file("out.bag"), std::string(topic) + "_smoothed");
    EXPECT_TRUE(messagesOf(file("plain.bag"), std::string(topic) + "_smoothed").empty());
    const auto plain = messagesOf(file("plain.bag"), topic);
    ASSERT_EQ(tracks.size(), plain.size()) << topic;
    ASSERT_EQ(tracks.size(), smoothed.size()) << topic;
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      EXPECT_EQ(bytesOf(tracks[i]), bytesOf(plain[i])) << topic << " " << i;
      EXPECT_EQ(tracks[i].header.stamp, smoothed[i].header.stamp);
      EXPECT_EQ(tracks[i].header.frame_id, smoothed[i].header.frame_id);
      ASSERT_EQ(tracks[i].tracks.size(), smoothed[i].tracks.size());
      for (std::size_t k = 0; k < tracks[i].tracks.size(); ++k) {
        EXPECT_EQ(tracks[i].tracks[k].id, smoothed[i].tracks[k].id);
        EXPECT_EQ(tracks[i].tracks[k].status, smoothed[i].tracks[k].status);
      }
    }
    const auto of_filter = errorOf(tracks), of_smoother = errorOf(smoothed);
    EXPECT_LT(of_smoother.first, 0.72 * of_filter.first) << topic;
    EXPECT_LT(of_smoother.second, 2.0) << topic;
    EXPECT_GT(of_smoother.second, 0.3) << topic;
  }
}

TEST_F(SmoothedReplay, TwoRunsGiveTheSameBytes) {
  recordSinusoid(file("in.bag"));
  ReplaySettings settings;
  settings.smooth = settings.all = true;
  replay(file("in.bag"), file("one.bag"), settings);
  replay(file("in.bag"), file("two.bag"), settings);
  const auto one = messagesOf(file("one.bag"), "/sensor_fusion/tracks_smoothed");
  const auto two = messagesOf(file("two.bag"), "/sensor_fusion/tracks_smoothed");
  ASSERT_EQ(one.size(), 600u);
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(bytesOf(one[i]), bytesOf(two[i])) << i;
}

TEST_F(SmoothedReplay, ALagIsBetweenTheFilterAndAllSightings) {
  recordSinusoid(file("in.bag"));
  ReplaySettings settings;
  settings.smooth = true;
  std::map<double, double> errors;
  for (const double lag : {0.0, 0.5, 100.0}) {
    settings.lag = lag;
    replay(file("in.bag"), file("out.bag"), settings);
    errors[lag] = errorOf(messagesOf(file("out.bag"), "/sensors/left/tracks_smoothed")).first;
  }
  EXPECT_LT(errors[0.5], 0.8 * errors[0.0]);
  EXPECT_LE(errors[100.0], errors[0.5]);
  const double of_filter = errorOf(messagesOf(file("out.bag"), "/sensors/left/tracks")).first;
  EXPECT_NEAR(errors[0.0], of_filter, 0.02 * of_filter);
}

TEST_F(SmoothedReplay, RecordedSmoothedTracksAreNotKeptWhereTheTracksAreReplaced) {
  recordSinusoid(file("in.bag"));
  ReplaySettings settings;
  settings.smooth = true;
  replay(file("in.bag"), file("smoothed.bag"), settings);
  replay(file("smoothed.bag"), file("again.bag"), {});
  EXPECT_FALSE(messagesOf(file("again.bag"), "/sensor_fusion/tracks").empty());
  EXPECT_TRUE(messagesOf(file("again.bag"), "/sensor_fusion/tracks_smoothed").empty());
}

TEST_F(SmoothedReplay, AnEstimatorWithoutAModelOfTheMotionIsRefusedInOneLineWithTheRemedy) {
  recordSinusoid(file("in.bag"));
  ReplaySettings settings;
  settings.smooth = true;
  settings.config = folder_.write("paper.yaml", "local_tracker:\n  noga: {form: paper}\n");
  try {
    replay(file("in.bag"), file("out.bag"), settings);
    FAIL() << "smoothed without a model";
  } catch (const std::exception& error) {
    const std::string words = error.what();
    EXPECT_NE(words.find("noga of form paper"), std::string::npos) << words;
    EXPECT_NE(words.find("consistent"), std::string::npos) << words;
    EXPECT_EQ(words.find('\n'), std::string::npos) << words;
  }
}

}  // namespace
