#include <cstdint>
#include <string>
#include <topic_tools/shape_shifter.h>
#include <vector>

#include <ros/message_traits.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>
#include <tf2_msgs/TFMessage.h>

#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/recordings/bags.h"
#include "sightline/ros/recordings/recording_examination.h"
#include "sightline/ros/recordings/replay.h"

#include "fuzz/ros/random_messages.h"
#include "fuzz/ros/ros_targets.h"
#include "support/scratch_folder.h"

namespace sightline_fuzz {
namespace {

template <typename Message>
topic_tools::ShapeShifter cut(const Message& message, RandomInput& input) {
  std::vector<std::uint8_t> bytes = bytesOfMessage(message);
  bytes.resize(static_cast<std::size_t>(input.between(0, static_cast<int>(bytes.size()) - 1)));
  topic_tools::ShapeShifter shape;
  shape.morph(ros::message_traits::md5sum<Message>(), ros::message_traits::datatype<Message>(),
              ros::message_traits::definition<Message>(), "");
  ros::serialization::IStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  shape.read(stream);
  return shape;
}

tf2_msgs::TFMessage transformAt(RandomInput& input, double time) {
  tf2_msgs::TFMessage message;
  message.transforms.resize(1);
  geometry_msgs::TransformStamped& transform = message.transforms.front();
  transform.header.frame_id = "platform_enu";
  transform.header.stamp.fromSec(time);
  transform.child_frame_id = input.oneOf<const char*>({"west", "east", "platform_enu", "", "/"});
  transform.transform.rotation.w = input.chance(0.9) ? 1.0 : input.absurd();
  transform.transform.translation.x = input.chance(0.9) ? 0.0 : input.absurd();
  return message;
}

/// Two sensors' scans of a few seconds, most of them sound, and transforms.
void writeRandomBag(RandomInput& input, const std::string& file) {
  rosbag::Bag bag(file, rosbag::bagmode::Write);
  const int scans = input.between(1, 60);
  for (int k = 0; k < scans; ++k) {
    const double time = 100.0 + 0.03 * k + (input.chance(0.02) ? randomNumber(input) : 0.0);
    const ros::Time stamp(100 + k / 30, static_cast<std::uint32_t>(k % 30) * 33000000U);
    for (const char* sensor : {"west", "east"}) {
      const std::string topic = std::string("/sensors/") + sensor + "/sightings";
      const auto scan = randomScan(input, input.chance(0.98) ? sensor : "", time);
      if (input.chance(0.02))
        bag.write(topic, stamp, cut(scan, input));
      else
        bag.write(topic, stamp, scan);
    }
    const auto transform = transformAt(input, 100.0 + 0.03 * k);
    if (input.chance(0.02))
      bag.write("/tf", stamp, cut(transform, input));
    else if (input.chance(0.3))
      bag.write(input.chance(0.9) ? "/tf" : "/tf_static", stamp, transform);
  }
}

void requireSoundTracks(const std::string& file) {
  const auto bag = sightline_ros::openBag(file);
  for (const rosbag::MessageInstance& instance : rosbag::View(*bag)) {
    const auto tracks = instance.instantiate<sightline::TrackArray>();
    if (!tracks) continue;
    for (const sightline::Track& track : tracks->tracks) requireSound(sightline_ros::toCore(track));
  }
}

}  // namespace

void fuzzRecordings(RandomInput& input, Trial& trial) {
  static const ScratchFolder folder;
  const std::string in = folder.file("in.bag"), out = folder.file("out.bag");
  writeRandomBag(input, in);
  sightline_ros::ReplaySettings settings;
  settings.live = input.chance(0.3);
  settings.smooth = input.chance(0.2);
  if (input.chance(0.3)) settings.positions = input.chance(0.5);
  settings.estimator = input.oneOf<const char*>({"", "noga", "kalman", "twbls", "imm"});
  // Refused as a whole: a recording without a scan, or without the place of a station.
  trial.callThatRefuses<std::runtime_error>("replay", [&] {
    sightline_ros::replay(in, out, settings);
    requireSoundTracks(out);
  });
  trial.callThatRefuses<std::runtime_error>(
      "doctor", [&] { sightline_ros::examineRecording(*sightline_ros::openBag(in)); });
}

}  // namespace sightline_fuzz
