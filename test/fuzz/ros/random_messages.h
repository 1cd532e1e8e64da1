#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <geometry_msgs/Pose.h>
#include <ros/serialization.h>
#include <sightline/SightingArray.h>
#include <std_msgs/Header.h>

#include "fuzz/random_input.h"

namespace sightline_fuzz {

/// A number as drivers write it, or one that none should.
double randomNumber(RandomInput& input);

std_msgs::Header randomHeader(RandomInput& input);
geometry_msgs::Pose randomPose(RandomInput& input);

/// A scan near that time [s]; its sightings are sound but for a few.
sightline::SightingArray randomScan(RandomInput& input, const std::string& sensor, double time);

template <typename Message>
std::vector<std::uint8_t> bytesOfMessage(const Message& message) {
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  return bytes;
}

/// Some bytes changed, or the end cut off.
void spoil(RandomInput& input, std::vector<std::uint8_t>& bytes);

}  // namespace sightline_fuzz
