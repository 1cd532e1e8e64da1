#pragma once

#include <string>

#include <ros/serialization.h>

namespace sightline::test {

/// A message as it is sent.
template <typename Message>
std::string bytesOf(const Message& message) {
  const ros::SerializedMessage serialized = ros::serialization::serializeMessage(message);
  return {reinterpret_cast<const char*>(serialized.buf.get()), serialized.num_bytes};
}

}  // namespace sightline::test
