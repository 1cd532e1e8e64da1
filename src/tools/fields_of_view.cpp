#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

#include "sightline/report/command_line.h"
#include "sightline/ros/params/param_reader.h"
#include "sightline/ros/params/scenario_params.h"

namespace {

const char* const kUsage =
    "Usage: fields_of_view [--positions] FILE.yaml...\n"
    "Prints the fields of view of a simulated scenario's sensors as a YAML list, for `fields_of_view` of a "
    "tracker. Several files are merged as roslaunch does.\n"
    "  --positions  for `fields_of_view` of a position tracker: each sensor has a local tracker of its "
    "name\n";

void list(const std::vector<std::string>& words) {
  using namespace sightline_ros;
  const sightline::report::CommandLine line(words, {}, 1, 10, {"--positions"});
  const bool is_for_positions = line.has("--positions");
  const auto scenario = loadScenario(ParamReader::fromYamlFiles(line.arguments()));
  std::string separator;
  std::cout << std::fixed << std::setprecision(15) << "[";  // an exponent would make a string of it
  for (const auto& sensor : scenario.sensors) {
    std::cout << separator << (is_for_positions ? "{tracker: " : "{sensor: ") << sensor.name
              << (is_for_positions ? ", frame: " + sensor.name : "")
              << ", azimuth_half_width: " << sensor.field_of_view.x()
              << ", elevation_half_width: " << sensor.field_of_view.y() << "}";
    separator = ", ";
  }
  std::cout << "]\n";
}

}  // namespace

int main(int argc, char** argv) {
  return sightline::report::runTool(argc, argv, kUsage, list);
}
