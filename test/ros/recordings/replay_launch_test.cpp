// A recording replayed live: the trackers see what was recorded, in the recording's time.
#include <cmath>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include <ros/ros.h>
#include <sightline/TrackArray.h>

#include "sightline/ros/recordings/csv_recordings.h"

#include "support/launch.h"
#include "support/scratch_folder.h"

namespace {

/// Two sensors that see a target go from azimuth 0.1 to 0.6 rad within 10 s, from time 100 s on.
std::string recordingOfTwoSensors(const ScratchFolder& folder) {
  std::ostringstream csv;
  csv << "time,sensor,azimuth,elevation,sigma_azimuth,sigma_elevation\n";
  for (int i = 0; i < 500; ++i) {
    const double t = 0.02 * i;
    csv << 100.0 + t << (i % 2 == 0 ? ",left," : ",right,") << 0.1 + 0.05 * t << ",0.2,0.001,0.001\n";
  }
  const std::string bag = folder.file("recording.bag");
  sightline_ros::convertCsvToBag(folder.write("recording.csv", csv.str()), bag, "platform_enu", 0.0);
  return bag;
}

/// The newest message of a topic of tracks.
class Newest {
 public:
  Newest(ros::NodeHandle& nh, const std::string& topic)
      : subscriber_(nh.subscribe(topic, 1000, &Newest::take, this)) {}

  /// Whether it holds a confirmed track where the target was at its stamp.
  bool isOnTarget() const {
    for (const auto& track : message_.tracks) {
      const double azimuth = 0.1 + 0.05 * (message_.header.stamp.toSec() - 100.0);
      if (track.status == sightline::Track::CONFIRMED && std::abs(track.azimuth - azimuth) < 3e-3)
        return true;
    }
    return false;
  }

  double stamp() const { return message_.header.stamp.toSec(); }

 private:
  void take(const sightline::TrackArray::ConstPtr& message) { message_ = *message; }

  sightline::TrackArray message_;
  ros::Subscriber subscriber_;
};

TEST(ReplayLaunch, RecordingIsTrackedBySensorOverAllAndFused) {
  const ScratchFolder folder;
  ros::NodeHandle nh;
  const Newest left(nh, "/sensors/left/tracks"), all(nh, "/sensor_fusion/tracks"),
      fused(nh, "/fusion/tracks");
  Launch launch("replay.launch",
                {"bag:=" + recordingOfTwoSensors(folder), "sensors:=left right", "rviz:=false", "rate:=2"});
  ASSERT_TRUE(launch.endsWithin(kPatience)) << "the launch did not end with the recording";
  for (const Newest* newest : {&left, &all, &fused}) {
    EXPECT_GT(newest->stamp(), 109.0);
    EXPECT_TRUE(newest->isOnTarget());
  }
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "replay_launch_test");
  ros::NodeHandle keeps_ros_running;
  return RUN_ALL_TESTS();
}
