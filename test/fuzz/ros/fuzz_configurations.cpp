#include <functional>
#include <string>
#include <vector>

#include <tf2/buffer_core.h>

#include "sightline/ros/adapters/adapter_params.h"
#include "sightline/ros/adapters/spot_detector_params.h"
#include "sightline/ros/components/local_tracker_component.h"
#include "sightline/ros/components/position_tracker_component.h"
#include "sightline/ros/components/track_fusion_component.h"
#include "sightline/ros/nodes/track_evaluator_node.h"
#include "sightline/ros/outputs/track_outputs_params.h"
#include "sightline/ros/params/param_reader.h"
#include "sightline/ros/params/scenario_params.h"

#include "fuzz/ros/ros_targets.h"
#include "fuzz/text_mutations.h"
#include "support/paths.h"
#include "support/scratch_folder.h"

namespace sightline_fuzz {

using sightline_ros::ParamReader;

namespace {

/// A file of parameters of the package, and who reads it.
struct Configuration {
  std::string text;
  std::function<void(const ParamReader&)> load;
};

const std::vector<Configuration>& configurations() {
  static const tf2::BufferCore transforms;
  static const std::vector<Configuration> all = [] {
    const auto of = [](const std::string& name) {
      return textOfFile(sightline::test::sourceDirectory() + "/config/" + name);
    };
    const auto scenario = [](const ParamReader& reader) { sightline_ros::loadScenario(reader); };
    return std::vector<Configuration>{
        {of("local_tracker.yaml"),
         [](const ParamReader& reader) {
           sightline_ros::LocalTrackerComponent(reader, "tracker", transforms);
         }},
        {of("track_fusion.yaml"),
         [](const ParamReader& reader) {
           sightline_ros::TrackFusionComponent(reader, "fusion", &transforms);
         }},
        {of("position_tracker.yaml"),
         [](const ParamReader& reader) {
           sightline_ros::PositionTrackerComponent(reader, "positions", transforms);
         }},
        {of("sighting_adapter.yaml"),
         [](const ParamReader& reader) { sightline_ros::loadAdapterTopics(reader); }},
        {of("spot_detector.yaml"),
         [](const ParamReader& reader) { sightline_ros::loadSpotDetectorParams(reader); }},
        {of("track_evaluator.yaml"),
         [](const ParamReader& reader) { sightline_ros::loadTrackEvaluatorParams(reader); }},
        {of("track_outputs.yaml"),
         [](const ParamReader& reader) { sightline_ros::loadTrackOutputsParams(reader); }},
        {of("scenarios/six_sensors_paper.yaml") + of("sensors/six_sensors.yaml"), scenario},
        {of("scenarios/stations_field.yaml"), scenario},
    };
  }();
  return all;
}

}  // namespace

void fuzzConfigurations(RandomInput& input, Trial& trial) {
  static const ScratchFolder folder;
  for (int n = 6; n > 0; --n) {
    const auto last = static_cast<int>(configurations().size()) - 1;
    const Configuration& chosen = configurations()[static_cast<std::size_t>(input.between(0, last))];
    const std::string file = folder.write("changed.yaml", mutated(input, chosen.text));
    trial.callThatRefuses<sightline_ros::ParamError>("load", [&] {
      const ParamReader reader = ParamReader::fromYaml(file);
      chosen.load(reader);
      reader.finish();
    });
  }
}

}  // namespace sightline_fuzz
