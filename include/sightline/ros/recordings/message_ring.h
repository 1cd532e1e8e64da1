#pragma once

#include <boost/shared_ptr.hpp>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <topic_tools/shape_shifter.h>
#include <utility>
#include <vector>

#include <ros/message_event.h>
#include <ros/time.h>

namespace rosbag {
class Bag;
}

namespace sightline_ros {

/// A message of any type as it came in.
struct RecordedMessage {
  std::string topic;
  ros::Time received;
  topic_tools::ShapeShifter::ConstPtr message;
  boost::shared_ptr<ros::M_string> header;  ///< of the connection: publisher, latching

  bool isLatched() const;
  std::string publisher() const;
  std::size_t bytes() const;  ///< of memory, about
};

/// Writes messages into a bag in the order given, as `rosbag record` would have written them.
void write(rosbag::Bag& bag, const std::vector<RecordedMessage>& messages);

/// The last seconds of messages, in bounded memory, for a bag that tells how something came about. Latched
/// messages (fixed transforms) are kept as long as they are valid, for without them a recording that begins
/// in the middle cannot be replayed.
class MessageRing {
 public:
  /// `seconds` of time [s], and `max_bytes` of memory at most.
  MessageRing(double seconds, std::size_t max_bytes);

  /// Messages come in order of receipt; a time that goes back (simulated, of a bag in a loop) forgets what
  /// was received after it. A message that alone is larger than the memory is not taken.
  void add(RecordedMessage message);

  /// Those latched messages that were received before the ring's first message come first, a nanosecond
  /// earlier than it.
  std::vector<RecordedMessage> messages() const;

  std::size_t size() const { return recent_.size(); }
  std::size_t bytes() const { return bytes_ + latched_bytes_; }
  double span() const;                                       ///< from the oldest to the newest message [s]
  std::uint64_t crowdedOut() const { return crowded_out_; }  ///< messages that were dropped for want of room

 private:
  using Source = std::pair<std::string, std::string>;  // topic, publisher

  void forgetFirst();
  void keepLatched(const RecordedMessage& message);

  double seconds_;
  std::size_t max_bytes_;
  std::deque<RecordedMessage> recent_;
  std::map<Source, RecordedMessage> latched_;  // the last of each source that is no longer in recent_
  std::size_t bytes_ = 0, latched_bytes_ = 0;
  std::uint64_t crowded_out_ = 0;
};

}  // namespace sightline_ros
