#include <filesystem>
#include <std_srvs/Trigger.h>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <ros/ros.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>
#include <std_msgs/String.h>
#include <tf2_msgs/TFMessage.h>

#include "sightline/ros/nodes/flight_recorder_node.h"

#include "support/launch.h"
#include "support/paths.h"
#include "support/scratch_folder.h"

namespace {

namespace files = std::filesystem;
using sightline::Track;

constexpr int kScans = 20;

/// The recorder, as a node or in the manager "nodelets", in a folder of its own.
class FlightRecorder : public testing::TestWithParam<std::string> {
 protected:
  FlightRecorder()
      : recorder_("flight_recorder.launch",
                  {"folder:=" + folder_.file("bags"), "seconds:=30.0", "manager:=" + GetParam(),
                   "config:=" + folder_.write("flight_recorder.yaml", "{after: 0.2, min_interval: 0.0}")}) {
    transforms_ = nh_.advertise<tf2_msgs::TFMessage>("/tf_static", 1, true);
    sightings_ = nh_.advertise<sightline::SightingArray>("/sensors/left/sightings", 100);
    tracks_ = nh_.advertise<sightline::TrackArray>("/fusion/tracks", 100);
    other_ = nh_.advertise<std_msgs::String>("/other", 100);
    tf2_msgs::TFMessage fixed;
    fixed.transforms.resize(1);
    fixed.transforms[0].header.frame_id = "platform_enu";
    fixed.transforms[0].child_frame_id = "left";
    fixed.transforms[0].transform.rotation.w = 1.0;
    transforms_.publish(fixed);
  }

  bool connect() {
    // Twice on the tracks: to keep them, and to watch them.
    return eventually([this] {
      return sightings_.getNumSubscribers() > 0 && tracks_.getNumSubscribers() > 0 &&
             transforms_.getNumSubscribers() > 0 && ros::service::exists("/flight_recorder/save", false);
    });
  }

  void publishTracks(const std::vector<std::uint32_t>& ids) {
    sightline::TrackArray tracks;
    tracks.header.stamp = ros::Time::now();
    for (const std::uint32_t id : ids) {
      tracks.tracks.emplace_back();
      tracks.tracks.back().id = id;
      tracks.tracks.back().status = Track::CONFIRMED;
    }
    tracks_.publish(tracks);
  }

  void publishScan() {
    sightline::SightingArray scan;
    scan.header.stamp = ros::Time::now();
    scan.sensor = "left";
    sightings_.publish(scan);
    other_.publish(std_msgs::String());
  }

  static std_srvs::Trigger::Response save() {
    std_srvs::Trigger call;
    EXPECT_TRUE(ros::service::call("/flight_recorder/save", call));
    return call.response;
  }

  /// Of a bag, messages of a topic.
  static int count(const std::string& file, const std::string& topic) {
    rosbag::Bag bag(file);
    rosbag::View view(bag, rosbag::TopicQuery(topic));
    return static_cast<int>(view.size());
  }

  std::vector<std::string> bagsOf(const std::string& kind) const {
    std::vector<std::string> bags;
    if (!files::exists(folder_.file("bags"))) return bags;
    for (const auto& entry : files::directory_iterator(folder_.file("bags"))) {
      const bool is_bag = entry.path().extension() == ".bag";
      if (is_bag && entry.path().filename().string().rfind(kind, 0) == 0)
        bags.push_back(entry.path().string());
    }
    return bags;
  }

  ScratchFolder folder_;
  Launch recorder_;
  ros::NodeHandle nh_;
  ros::Publisher transforms_, sightings_, tracks_, other_;
};

TEST_P(FlightRecorder, SavesWhatWasReceivedWhenAsked) {
  ASSERT_TRUE(connect());
  int published = 0;
  std::string bag;
  ASSERT_TRUE(eventually([&] { return published >= kScans; }, [&] { publishScan(), ++published; }));
  // The last of them may still be under way.
  ASSERT_TRUE(eventually(
      [&] {
        const auto saved = save();
        EXPECT_TRUE(saved.success) << saved.message;
        bag = saved.message;
        return count(bag, "/sensors/left/sightings") == published;
      },
      [] {}, ros::WallDuration(0.2)));
  EXPECT_EQ(files::path(bag).parent_path(), folder_.file("bags"));
  EXPECT_EQ(count(bag, "/other"), 0) << "neither of sightline nor tf nor /diagnostics";
  rosbag::Bag opened(bag);
  rosbag::View fixed(opened, rosbag::TopicQuery("/tf_static"));
  ASSERT_GE(fixed.size(), 1u);
  EXPECT_TRUE((*fixed.begin()).isLatching());
}

TEST_P(FlightRecorder, SavesWhenABelievedTrackEnds) {
  ASSERT_TRUE(connect());
  // Until both subscriptions of the recorder are there: an incident that it has not seen is none.
  bool with_track = false;
  ASSERT_TRUE(eventually([&] { return !bagsOf("incident").empty(); },
                         [&] {
                           with_track = !with_track;
                           publishScan();
                           publishTracks(with_track ? std::vector<std::uint32_t>{7}
                                                    : std::vector<std::uint32_t>{});
                         },
                         ros::WallDuration(0.05)));
  rosbag::Bag bag(bagsOf("incident").front());
  rosbag::View view(bag, rosbag::TopicQuery("/flight_recorder/reason"));
  ASSERT_EQ(view.size(), 1u);
  EXPECT_EQ((*view.begin()).instantiate<std_msgs::String>()->data, "track 7 of /fusion/tracks ended");
}

TEST_P(FlightRecorder, SaysWhyNothingIsSaved) {
  ASSERT_TRUE(connect());
  ASSERT_TRUE(eventually([&] { return save().success != 0; }, [&] { publishScan(); }));
  files::remove_all(folder_.file("bags"));
  folder_.write("bags", "a file where the folder was");
  const auto refused = save();
  EXPECT_FALSE(refused.success);
  EXPECT_NE(refused.message.find(folder_.file("bags")), std::string::npos) << refused.message;
}

INSTANTIATE_TEST_SUITE_P(NodeAndNodelet, FlightRecorder, testing::Values("", "nodelets"),
                         [](const auto& info) { return info.param.empty() ? "node" : "nodelet"; });

TEST(FlightRecorderParams, ShippedFileHoldsTheDefaults) {
  const auto reader = sightline_ros::ParamReader::fromYaml(sightline::test::sourceDirectory() +
                                                           "/config/flight_recorder.yaml");
  sightline_ros::loadFlightRecorderParams(reader);
  EXPECT_NO_THROW(reader.finish());
  EXPECT_EQ(reader.differences(), std::vector<std::string>());
}

TEST(FlightRecorderParams, AnIncidentMustNotBeForgottenBeforeItIsSaved) {
  XmlRpc::XmlRpcValue tree;
  tree["seconds"] = 5.0;
  tree["after"] = 5.0;
  EXPECT_THROW(sightline_ros::loadFlightRecorderParams({tree, "/flight_recorder"}),
               sightline_ros::ParamError);
}

TEST(FlightRecorderParams, TopicsOfTracking) {
  using sightline_ros::isOfTracking;
  EXPECT_TRUE(isOfTracking({"/a", "sightline/TrackArray"}));
  EXPECT_TRUE(isOfTracking({"/tf", "tf2_msgs/TFMessage"}));
  EXPECT_TRUE(isOfTracking({"/diagnostics", "diagnostic_msgs/DiagnosticArray"}));
  EXPECT_TRUE(isOfTracking({"/local_tracker/parameter_updates", "dynamic_reconfigure/Config"}));
  EXPECT_FALSE(isOfTracking({"/display/selection", "sightline/TrackSelection"}));
  EXPECT_FALSE(isOfTracking({"/display/all", "visualization_msgs/MarkerArray"}));
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "flight_recorder_test");
  ros::NodeHandle keeps_ros_running;
  return RUN_ALL_TESTS();
}
