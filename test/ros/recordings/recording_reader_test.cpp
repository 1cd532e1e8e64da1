#include "sightline/ros/recordings/recording_reader.h"

#include <gtest/gtest.h>

#include <sightline/TrackArray.h>

#include "support/scans.h"
#include "support/scratch_folder.h"

using namespace sightline_ros;
namespace core = sightline::core;

namespace {

sightline::TrackArray tracks(const std::string& frame, double stamp) {
  sightline::TrackArray message;
  message.header.stamp = ros::Time(stamp);
  message.header.frame_id = frame;
  message.tracker = "tracker";
  message.estimator = "twbls";
  message.tracks.resize(2);
  return message;
}

class RecordingReaderTest : public testing::Test {
 protected:
  RecordingReaderTest() {
    {
      rosbag::Bag bag(folder_.file("in.bag"), rosbag::bagmode::Write);
      bag.write("/scans", ros::Time(10.0), scanOf("eye", 10.0, {{0.1, 0.2}}));
      bag.write("/tracks", ros::Time(10.1), tracks("platform_enu", 10.1));
      bag.write("/elsewhere", ros::Time(10.2), tracks("world", 10.2));
      auto unknown = scanOf("lost", 10.3, {{0.1, 0.2}});
      unknown.header.frame_id = "nowhere";
      bag.write("/scans", ros::Time(10.3), unknown);
      bag.write("/associations", ros::Time(10.4), sightline::AssociationArray());
    }
    bag_.open(folder_.file("in.bag"), rosbag::bagmode::Read);
  }

  ScratchFolder folder_;
  rosbag::Bag bag_;
};

TEST_F(RecordingReaderTest, MessagesOfTheFrameComeInTheOrderOfTheRecording) {
  std::vector<std::string> read;
  RecordingReader reader(bag_, "platform_enu");
  RecordingVisitor visitor;
  visitor.scan = [&](const std::string& topic, core::Scan scan) {
    read.push_back(topic + " " + scan.sensor);
    EXPECT_EQ(scan.sightings.size(), 1u);
  };
  visitor.tracks = [&](const std::string& topic, core::TrackReport report) {
    read.push_back(topic + " " + report.tracker);
    EXPECT_EQ(report.tracks.size(), 2u);
    EXPECT_FALSE(report.fused);
  };
  visitor.associations = [&](const std::string& topic, const sightline::AssociationArray&) {
    read.push_back(topic);
  };
  reader.read(visitor);
  EXPECT_EQ(read, (std::vector<std::string>{"/scans eye", "/tracks tracker", "/associations"}));
}

TEST_F(RecordingReaderTest, MessagesLeftOutAreCountedByTopicAndReason) {
  RecordingReader reader(bag_, "platform_enu");
  RecordingVisitor visitor;
  visitor.scan = [](const std::string&, const core::Scan&) {};
  visitor.tracks = [](const std::string&, const core::TrackReport&) {};
  for (int pass = 0; pass < 2; ++pass) {
    reader.read(visitor);
    ASSERT_EQ(reader.leftOut().size(), 2u);
    EXPECT_EQ(reader.leftOut().at("/elsewhere: in frame world instead of platform_enu"), 1u);
    EXPECT_EQ(reader.leftOut().rbegin()->first.find("/scans: "), 0u) << reader.leftOut().rbegin()->first;
  }
}

TEST_F(RecordingReaderTest, WithoutAVisitorNothingIsReadOrLeftOut) {
  RecordingReader reader(bag_, "platform_enu");
  reader.read({});
  EXPECT_TRUE(reader.leftOut().empty());
}

TEST_F(RecordingReaderTest, TheTrackingFrameIsThatOfTheFirstTracks) {
  EXPECT_EQ(trackingFrameOf(bag_), "platform_enu");
  {
    rosbag::Bag bag(folder_.file("other.bag"), rosbag::bagmode::Write);
    bag.write("/tracks", ros::Time(10.0), tracks("deck", 10.0));
  }
  const rosbag::Bag other(folder_.file("other.bag"), rosbag::bagmode::Read);
  EXPECT_EQ(trackingFrameOf(other), "deck");
}

}  // namespace
