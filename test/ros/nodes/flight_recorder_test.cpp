#include <algorithm>
#include <cmath>
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

#include "support/command.h"
#include "support/launch.h"
#include "support/paths.h"
#include "support/scratch_folder.h"

namespace {

namespace files = std::filesystem;
using sightline::Track;

constexpr int kScans = 20;

std_srvs::Trigger::Response save() {
  std_srvs::Trigger call;
  EXPECT_TRUE(ros::service::call("/flight_recorder/save", call));
  return call.response;
}

/// Of a bag, messages of a topic.
int count(const std::string& file, const std::string& topic) {
  rosbag::Bag bag(file);
  rosbag::View view(bag, rosbag::TopicQuery(topic));
  return static_cast<int>(view.size());
}

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

const char* const kTrackerParameters = "/sensors/left/local_tracker/parameters";

/// Messages with confirmed tracks of the tracker.
int confirmedIn(const std::string& file) {
  rosbag::Bag bag(file);
  rosbag::View view(bag, rosbag::TopicQuery("/sensors/left/tracks"));
  return static_cast<int>(std::count_if(view.begin(), view.end(), [](const auto& instance) {
    const auto message = instance.template instantiate<sightline::TrackArray>();
    return !message->tracks.empty() && message->tracks[0].status == Track::CONFIRMED;
  }));
}

/// The parameters that a tracker with this configuration has said on its latched topic before the recorder
/// started, and a bag of the recorder with them and with confirmed tracks.
struct RecordedRun {
  std::string said, bag;
};
RecordedRun recordTracker(const ScratchFolder& folder, const std::string& name, const std::string& config) {
  RecordedRun run;
  const Launch tracker("local_tracker.launch",
                       {"space:=sensors/left", "sighting_topics:=[/sensors/left/sightings]",
                        "config:=" + folder.write(name + ".yaml", config)});
  const auto said =
      ros::topic::waitForMessage<std_msgs::String>(kTrackerParameters, ros::Duration(kPatience));
  if (!said) return run;
  run.said = said->data;
  const Launch recorder("flight_recorder.launch", {"folder:=" + folder.file(name)});
  ros::NodeHandle nh;
  ros::Publisher sightings = nh.advertise<sightline::SightingArray>("/sensors/left/sightings", 100);
  sightline::SightingArray scan;
  scan.header.frame_id = "platform_enu";
  scan.sensor = "left";
  scan.ifov = scan.detection_probability = scan.clutter_density = std::nan("");
  scan.sightings.resize(1);
  scan.sightings[0].covariance = {1e-6, 0.0, 0.0, 1e-6};
  const auto publish = [&] {
    scan.header.stamp = ros::Time::now();
    sightings.publish(scan);
  };
  const auto isWhole = [&] {
    if (!ros::service::exists("/flight_recorder/save", false)) return false;
    const auto saved = save();
    run.bag = saved.message;
    return saved.success && count(run.bag, kTrackerParameters) > 0 && confirmedIn(run.bag) >= kScans;
  };
  EXPECT_TRUE(eventually(isWhole, publish, ros::WallDuration(0.05)));
  return run;
}

std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

TEST(RecordedParameters, TheReportOfTwoLiveRecordingsTellsTheOneThatDiffers) {
  const ScratchFolder folder;
  const RecordedRun three = recordTracker(folder, "three", "lifecycle: {confirm_hits: 3}\n");
  const RecordedRun four = recordTracker(folder, "four", "lifecycle: {confirm_hits: 4}\n");
  for (const RecordedRun& run : {three, four}) {
    ASSERT_NE(run.said, "");
    rosbag::Bag bag(run.bag);
    rosbag::View view(bag, rosbag::TopicQuery(kTrackerParameters));
    ASSERT_EQ(view.size(), 1u);
    EXPECT_TRUE((*view.begin()).isLatching());
    EXPECT_EQ((*view.begin()).instantiate<std_msgs::String>()->data, run.said);
  }
  EXPECT_NE(three.said.find("lifecycle/confirm_hits: 3\n"), std::string::npos) << three.said;
  EXPECT_NE(four.said.find("lifecycle/confirm_hits: 4\n"), std::string::npos) << four.said;

  if (!hasPlotly()) GTEST_SKIP() << "no plotly: install python3-plotly";
  const std::string page = folder.file("report.html");
  const auto [code, printed] =
      outcomeOf("rosrun sightline evaluate --html " + page + " " + three.bag + " --against " + four.bag);
  ASSERT_EQ(code, 0) << printed;
  const std::string text = textOfFile(page);
  const std::string row = std::string("<td>") + kTrackerParameters + "</td>";
  EXPECT_NE(text.find("<tr class=\"differs\">" + row + "<td>lifecycle/confirm_hits</td><td>3</td><td>4</td>"),
            std::string::npos);
  EXPECT_EQ(occurrences(text, "<tr class=\"differs\">" + row), 1u);
  EXPECT_GT(occurrences(text, "<tr>" + row), 10u) << "those that are the same";
}

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
