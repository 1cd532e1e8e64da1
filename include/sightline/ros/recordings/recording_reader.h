#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>

#include <rosbag/bag.h>
#include <rosbag/message_instance.h>
#include <sightline/AssociationArray.h>

#include "sightline/core/evaluation/track_report.h"
#include "sightline/ros/messages/frames.h"
#include "sightline/ros/recordings/bags.h"

namespace sightline_ros {

/// Functions that are called with the messages of a recording; each may be empty.
struct RecordingVisitor {
  std::function<void(const std::string& topic, sightline::core::Scan scan_tracking)> scan;
  std::function<void(const std::string& topic, sightline::core::TrackReport report)> tracks;
  std::function<void(const std::string& topic, const sightline::AssociationArray& associations)> associations;
};

/// Reads the scans (rotated into the tracking frame), tracks and associations of a recording in the order in
/// which they were recorded.
class RecordingReader {
 public:
  /// `bag` must outlive this.
  RecordingReader(const rosbag::Bag& bag, const std::string& tracking_frame);

  void read(const RecordingVisitor& visitor);

  /// Messages that the last `read` left out, by topic and reason.
  const std::map<std::string, std::size_t>& leftOut() const { return left_out_; }

  /// Likewise, the first one with its values and the remedy.
  const std::map<std::string, std::string>& examples() const { return examples_; }

 private:
  const rosbag::Bag& bag_;
  FrameChangeParams frames_;
  std::map<std::string, std::size_t> left_out_;
  std::map<std::string, std::string> examples_;
};

/// The message. Throws std::runtime_error when it was recorded with another definition of its type.
template <typename Message>
typename Message::ConstPtr messageOf(const rosbag::MessageInstance& instance) {
  typename Message::ConstPtr message = messageIn<Message>(instance);
  if (!message) {
    throw std::runtime_error(instance.getTopic() + " was recorded with another definition of " +
                             instance.getDataType());
  }
  return message;
}

/// Frame of the first TrackArray of the bag; that of FrameChangeParams when there is none.
std::string trackingFrameOf(const rosbag::Bag& bag);

}  // namespace sightline_ros
