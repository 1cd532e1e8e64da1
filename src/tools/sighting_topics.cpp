#include <iostream>
#include <set>
#include <stdexcept>

#include <rosbag/view.h>
#include <sightline/SightingArray.h>

#include "sightline/report/command_line.h"
#include "sightline/ros/recordings/bags.h"

namespace {

const char* const kUsage =
    "Usage: sighting_topics IN.bag\n"
    "Prints the topics of sightline/SightingArray in a bag as a YAML list, for `sighting_topics` of a "
    "tracker.\n";

void list(const std::vector<std::string>& words) {
  using namespace sightline_ros;
  const sightline::report::CommandLine line(words, {}, 1, 1);
  const auto bag = openBag(line.arguments()[0]);
  rosbag::View view(*bag, rosbag::TypeQuery(ros::message_traits::datatype<sightline::SightingArray>()));
  std::set<std::string> topics;
  for (const rosbag::ConnectionInfo* connection : view.getConnections()) topics.insert(connection->topic);
  if (topics.empty())
    throw std::runtime_error(line.arguments()[0] + ": there is no sightline/SightingArray message in it");
  std::string all;
  for (const std::string& topic : topics) all += (all.empty() ? "" : ", ") + topic;
  std::cout << "[" << all << "]\n";
}

}  // namespace

int main(int argc, char** argv) {
  return sightline::report::runTool(argc, argv, kUsage, list);
}
