#include "sightline/ros/recordings/message_ring.h"

#include <algorithm>

#include <rosbag/bag.h>

namespace sightline_ros {
namespace {

constexpr std::size_t kOverhead = 300;  // of a message in memory: pointers, names, its header [bytes]

std::string fieldOf(const RecordedMessage& message, const std::string& key) {
  if (!message.header) return "";
  const auto found = message.header->find(key);
  return found == message.header->end() ? "" : found->second;
}

}  // namespace

bool RecordedMessage::isLatched() const {
  return fieldOf(*this, "latching") == "1";
}

std::string RecordedMessage::publisher() const {
  return fieldOf(*this, "callerid");
}

std::size_t RecordedMessage::bytes() const {
  return message->size() + topic.size() + kOverhead;
}

void write(rosbag::Bag& bag, const std::vector<RecordedMessage>& messages) {
  for (const RecordedMessage& message : messages)
    bag.write(message.topic, std::max(message.received, ros::TIME_MIN), *message.message, message.header);
}

MessageRing::MessageRing(double seconds, std::size_t max_bytes) : seconds_(seconds), max_bytes_(max_bytes) {}

void MessageRing::add(RecordedMessage message) {
  while (!recent_.empty() && recent_.back().received > message.received) {
    bytes_ -= recent_.back().bytes();
    recent_.pop_back();
  }
  const std::size_t needed = message.bytes();
  if (needed + latched_bytes_ > max_bytes_) {
    ++crowded_out_;
    return;
  }
  while (!recent_.empty() && (message.received - recent_.front().received).toSec() > seconds_) forgetFirst();
  while (!recent_.empty() && bytes() + needed > max_bytes_) {
    ++crowded_out_;
    forgetFirst();
  }
  bytes_ += needed;
  recent_.push_back(std::move(message));
}

void MessageRing::forgetFirst() {
  const RecordedMessage first = std::move(recent_.front());
  recent_.pop_front();
  bytes_ -= first.bytes();
  if (first.isLatched()) keepLatched(first);
}

void MessageRing::keepLatched(const RecordedMessage& message) {
  const auto [place, is_new] = latched_.try_emplace({message.topic, message.publisher()}, message);
  if (!is_new) latched_bytes_ -= place->second.bytes();
  place->second = message;
  latched_bytes_ += message.bytes();
  // Publishers that come and go must not fill the memory: the oldest give way before half of it is theirs.
  while (latched_bytes_ > max_bytes_ / 2) {
    const auto oldest = std::min_element(latched_.begin(), latched_.end(), [](const auto& a, const auto& b) {
      return a.second.received < b.second.received;
    });
    latched_bytes_ -= oldest->second.bytes();
    latched_.erase(oldest);
    ++crowded_out_;
  }
}

std::vector<RecordedMessage> MessageRing::messages() const {
  std::vector<RecordedMessage> all;
  all.reserve(latched_.size() + recent_.size());
  for (const auto& [source, message] : latched_) {
    all.push_back(message);
    if (!recent_.empty())
      all.back().received = recent_.front().received - ros::Duration(0, 1);  // bags are sorted
  }
  all.insert(all.end(), recent_.begin(), recent_.end());
  return all;
}

double MessageRing::span() const {
  return recent_.empty() ? 0.0 : (recent_.back().received - recent_.front().received).toSec();
}

}  // namespace sightline_ros
