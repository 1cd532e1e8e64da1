#include "fuzz/ros/random_messages.h"

namespace sightline_fuzz {

double randomNumber(RandomInput& input) {
  if (input.chance(0.05)) return input.absurd();
  return input.oneOf({0.0, 1.0, -1.0}) * input.logBetween(1e-4, 1e3) + input.normal();
}

std_msgs::Header randomHeader(RandomInput& input) {
  std_msgs::Header header;
  header.frame_id = input.oneOf<const char*>({"camera", "camera_optical", "", "/", "a/b"});
  header.stamp = input.chance(0.9) ? ros::Time(100, static_cast<std::uint32_t>(input.between(0, 999999999)))
                                   : input.oneOf({ros::Time(), ros::TIME_MAX, ros::Time(0, 1)});
  return header;
}

geometry_msgs::Pose randomPose(RandomInput& input) {
  geometry_msgs::Pose pose;
  pose.position.x = randomNumber(input);
  pose.position.y = randomNumber(input);
  pose.position.z = randomNumber(input);
  pose.orientation.w = randomNumber(input);
  return pose;
}

sightline::SightingArray randomScan(RandomInput& input, const std::string& sensor, double time) {
  sightline::SightingArray scan;
  scan.sensor = sensor;
  scan.header.frame_id = "platform_enu";
  scan.header.stamp.fromSec(time > 0.0 && time < 4e9 ? time : 100.0);
  if (input.chance(0.01)) scan.header = randomHeader(input);
  scan.ifov = input.chance(0.9) ? 1e-3 : input.absurd();
  scan.detection_probability = input.chance(0.9) ? 0.9 : input.absurd();
  scan.clutter_density = input.chance(0.9) ? 0.1 : input.absurd();
  for (int count = input.between(0, 4); count > 0; --count) {
    sightline::Sighting sighting;
    sighting.azimuth = 0.1 * time + 1e-3 * input.normal() + (count > 1 ? 0.3 * input.normal() : 0.0);
    sighting.elevation = 0.2 + 1e-3 * input.normal();
    sighting.covariance = {1e-6, 0.0, 0.0, 1e-6};
    if (input.chance(0.05)) {
      sighting.azimuth = randomNumber(input);
      sighting.elevation = randomNumber(input);
      for (double& variance : sighting.covariance) variance = randomNumber(input);
    }
    scan.sightings.push_back(sighting);
  }
  return scan;
}

void spoil(RandomInput& input, std::vector<std::uint8_t>& bytes) {
  for (int changes = input.between(0, 4); changes > 0 && !bytes.empty(); --changes) {
    const auto place = static_cast<std::size_t>(input.between(0, static_cast<int>(bytes.size()) - 1));
    bytes[place] = static_cast<std::uint8_t>(input.oneOf({0, 1, 127, 128, 255, input.between(0, 255)}));
  }
  if (input.chance(0.3) && !bytes.empty())
    bytes.resize(static_cast<std::size_t>(input.between(0, static_cast<int>(bytes.size()))));
}

}  // namespace sightline_fuzz
