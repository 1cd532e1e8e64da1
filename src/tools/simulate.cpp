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
    "  --seed      seed of all random numbers (default: that of the scenario)\n"
    "  --duration  length [s] (default: that of the scenario; needed when the scenario has no end)\n"
    "  --sensors   loaded before the scenario (default: config/sensors/six_sensors.yaml; none before a "
    "scenario with stations)\n"
    "  --stated    whether scans state their probability of detection and density of clutter (default yes)\n";

void simulate(const std::vector<std::string>& words) {
  using namespace sightline_ros;
  using sightline::report::NumberRange;
  const sightline::report::CommandLine line(words, {"--seed", "--duration", "--sensors", "--stated"}, 2, 2);
  SimulatedRecordingParams params;
  params.is_stated = line.yesOrNo("--stated", params.is_stated);
  const std::vector<std::string> files = scenarioFiles(line.arguments()[0], line.option("--sensors", ""));
  ParamReader reader = ParamReader::fromYamlFiles(files);
  if (line.has("--seed")) reader = reader.with("seed", line.wholeNumber("--seed", 0));
  if (line.has("--duration"))
    reader = reader.with("duration", line.number("--duration", 0.0, NumberRange::at_least_zero));

  SimulatedRecordingSummary summary;
  writeBag(line.arguments()[1], files,
           [&](rosbag::Bag& bag) { summary = recordSimulation(loadScenario(reader), params, bag); });
  std::cout << summary.scans << " scans with " << summary.sightings << " sightings written, and "
            << summary.truths << " samples of the truth\n";
}

}  // namespace

int main(int argc, char** argv) {
  return sightline::report::runTool(argc, argv, kUsage, simulate);
}
