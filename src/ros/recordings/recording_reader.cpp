#include "sightline/ros/recordings/recording_reader.h"

#include <rosbag/view.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>

#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/messages/evaluation_messages.h"
#include "sightline/ros/recordings/recorded_transforms.h"
#include "sightline/ros/recordings/replay.h"

namespace sightline_ros {

namespace core = sightline::core;
using sightline::AssociationArray;
using sightline::SightingArray;
using sightline::TrackArray;

namespace {

/// The scan in the tracking frame, with all transforms of the recording that it could have waited for.
FramedScan framed(const SightingArray::ConstPtr& message, const FrameChangeParams& params,
                  RecordedTransforms& transforms) {
  const core::Time stamp = toCore(message->header.stamp);
  const core::Time end_of_wait = stamp + core::durationOf(params.tf_timeout);
  transforms.advanceTo(end_of_wait);
  FrameChange frames(params, transforms.buffer());
  frames.add(message, stamp);
  auto result = frames.release(end_of_wait);
  if (result.empty()) result = frames.release(end_of_wait + core::Duration(1));
  return std::move(result.at(0));
}

}  // namespace

RecordingReader::RecordingReader(const rosbag::Bag& bag, const std::string& tracking_frame) : bag_(bag) {
  frames_.tracking_frame = tracking_frame;
}

void RecordingReader::read(const RecordingVisitor& visitor) {
  left_out_.clear();
  examples_.clear();
  RecordedTransforms transforms(bag_);
  rosbag::View view(bag_);
  for (const rosbag::MessageInstance& instance : view) {
    const std::string topic = instance.getTopic();
    if (visitor.scan && instance.isType<SightingArray>()) {
      const auto message = messageOf<SightingArray>(instance);
      FramedScan scan = framed(message, frames_, transforms);
      if (!scan.refusal) {
        visitor.scan(topic, std::move(scan.scan));
      } else {
        const std::string reason = topic + ": " + scan.refusal->kind;
        ++left_out_[reason];
        examples_.try_emplace(reason, exampleOf(*message, scan.refusal->detail));
      }
    } else if (visitor.tracks && instance.isType<TrackArray>()) {
      const auto tracks = messageOf<TrackArray>(instance);
      if (tracks->header.frame_id == frames_.tracking_frame) {
        visitor.tracks(topic, reportOf(*tracks));
      } else {
        ++left_out_[topic + ": in frame " + tracks->header.frame_id + " instead of " +
                    frames_.tracking_frame];
      }
    } else if (visitor.associations && instance.isType<AssociationArray>()) {
      visitor.associations(topic, *messageOf<AssociationArray>(instance));
    }
  }
}

std::string trackingFrameOf(const rosbag::Bag& bag) {
  rosbag::View view(bag, rosbag::TypeQuery(ros::message_traits::datatype<TrackArray>()));
  for (const rosbag::MessageInstance& instance : view)
    return messageOf<TrackArray>(instance)->header.frame_id;
  return FrameChangeParams().tracking_frame;
}

}  // namespace sightline_ros
