#include <iostream>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <ros/ros.h>

#include "sightline/report/command_line.h"
#include "sightline/ros/outputs/any_tracks.h"
#include "sightline/ros/outputs/track_json.h"

namespace {

using namespace sightline_ros;

const char* const kUsage =
    "Usage: track_stream [--all] [--count N] [TOPIC]...\n"
    "Prints the tracks of running trackers as lines of JSON, one for each message. Numbers that are not "
    "known "
    "(NaN) are null.\n"
    "  TOPIC      of sightline/TrackArray or PositionTrackArray (default /fusion/tracks)\n"
    "  --all      tentative tracks too\n"
    "  --count N  end after N lines (default 0: go on)\n";

constexpr std::uint32_t kStreamQueue = 1000;  // messages of a topic
constexpr double kPatience = 3.0;             // [s of the wall's clock], before silence is said

class TrackStream {
 public:
  TrackStream(const OutputChoice& choice, int count) : choice_(choice), count_(count) {}

  /// For who waits in vain.
  void sayWhenSilent(const std::vector<std::string>& topics) const {
    if (printed_ > 0 || !said_.empty()) return;
    for (const std::string& topic : topics)
      std::cerr << "track_stream: nothing yet on " << topic << std::endl;
  }

  void print(const topic_tools::ShapeShifter& any, const std::string& topic) {
    if (count_ > 0 && printed_ >= count_) return;
    const auto refusal = takeTracks(any, topic, [&](const auto& tracks) {
      std::cout << jsonOf(tracks, topic, choice_) << std::endl;  // at once, for who reads it
      ++printed_;
    });
    if (refusal && said_.insert(topic).second) std::cerr << "track_stream: " << refusal->detail << std::endl;
    if (!std::cout || (count_ > 0 && printed_ >= count_)) ros::shutdown();
  }

 private:
  OutputChoice choice_;
  int count_;
  int printed_ = 0;
  std::set<std::string> said_;
};

void stream(const std::vector<std::string>& words) {
  const sightline::report::CommandLine line(words, {"--count"}, 0, 100, {"--all"});
  if (!ros::master::check()) {
    throw std::runtime_error("there is no ROS master at " + ros::master::getURI() +
                             ": start the trackers, or set ROS_MASTER_URI");
  }
  OutputChoice choice;
  choice.tentative = line.has("--all");
  TrackStream tracks(choice, line.wholeNumber("--count", 0));
  std::vector<std::string> topics = line.arguments();
  if (topics.empty()) topics = {"/fusion/tracks"};
  ros::NodeHandle nh;
  std::vector<ros::Subscriber> subscribers;
  for (std::string& topic : topics) {
    topic = nh.resolveName(topic);
    const boost::function<void(const topic_tools::ShapeShifter::ConstPtr&)> print =
        [&tracks, topic](const topic_tools::ShapeShifter::ConstPtr& any) { tracks.print(*any, topic); };
    subscribers.push_back(nh.subscribe<topic_tools::ShapeShifter>(topic, kStreamQueue, print));
  }
  const ros::WallTimer silence = nh.createWallTimer(
      ros::WallDuration(kPatience), [&](const ros::WallTimerEvent&) { tracks.sayWhenSilent(topics); }, true);
  ros::spin();
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "track_stream", ros::init_options::AnonymousName);
  return sightline::report::runTool(argc, argv, kUsage, stream);
}
