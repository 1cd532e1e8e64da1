#include <cmath>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

#include "sightline/report/command_line.h"
#include "sightline/ros/params/param_reader.h"
#include "sightline/ros/params/scenario_params.h"
#include "sightline/ros/recordings/bags.h"
#include "sightline/ros/recordings/simulated_recording.h"

namespace {

const char* const kUsage =
    "Usage: simulate [--seed N] [--duration SECONDS] [--sensors FILE.yaml] [--stated yes|no] SCENARIO "
    "OUT.bag\n"
    "Records a simulated scenario as fast as the machine allows: sightings, truth and transforms, for replay "
    "and evaluate.\n"
    "  SCENARIO    a file of config/scenarios (crowd, for instance), or the path of another one\n"
    "  --seed      of everything random (default: the scenario's)\n"
    "  --duration  [s] (default: the scenario's; needed where that has no end)\n"
    "  --sensors   loaded before the scenario (default: config/sensors/six_sensors.yaml)\n"
    "  --stated    whether scans state their probability of detection and density of clutter (default yes)\n";

double numberOf(const std::string& option, const std::string& text) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(number) || number < 0.0)
    throw sightline_ros::UsageError(option + ": expected a number of at least 0, got \"" + text + "\"");
  return number;
}

bool isStated(const std::string& text) {
  if (text != "yes" && text != "no")
    throw sightline_ros::UsageError("--stated: expected yes or no, got \"" + text + "\"");
  return text == "yes";
}

void simulate(const std::vector<std::string>& words) {
  using namespace sightline_ros;
  const CommandLine line(words, {"--seed", "--duration", "--sensors", "--stated"}, 2, 2);
  SimulatedRecordingParams params;
  params.is_stated = isStated(line.option("--stated", "yes"));
  ParamReader reader = ParamReader::fromYamlFiles(
      {line.option("--sensors", sixSensorsFile()), scenarioFile(line.arguments()[0])});
  if (line.has("--seed"))
    reader = reader.with("seed", static_cast<int>(numberOf("--seed", line.option("--seed", ""))));
  if (line.has("--duration"))
    reader = reader.with("duration", numberOf("--duration", line.option("--duration", "")));

  BagWriter bag(line.arguments()[1]);
  const SimulatedRecordingSummary summary = recordSimulation(loadScenario(reader), params, *bag);
  bag.finish();
  std::cout << summary.scans << " scans with " << summary.sightings << " sightings written, and "
            << summary.truths << " samples of the truth\n";
}

}  // namespace

int main(int argc, char** argv) {
  return sightline_ros::runTool(argc, argv, kUsage, simulate);
}
