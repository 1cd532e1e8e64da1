#include "sightline/ros/recordings/simulated_recording.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include <ros/package.h>
#include <tf2_msgs/TFMessage.h>

#include "sightline/core/simulation/sensor_simulator.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/messages/scenario_messages.h"
#include "sightline/ros/params/param_reader.h"
#include "sightline/ros/recordings/bags.h"

namespace sightline_ros {

namespace core = sightline::core;
namespace fs = std::filesystem;

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kLead = 0.1;  // that the first transform comes before time zero [s]

tf2_msgs::TFMessage messageOf(std::vector<geometry_msgs::TransformStamped> transforms) {
  tf2_msgs::TFMessage message;
  message.transforms = std::move(transforms);
  return message;
}

/// One recording under way.
class Simulation {
 public:
  Simulation(const core::Scenario& scenario, const SimulatedRecordingParams& params, rosbag::Bag& bag);

  SimulatedRecordingSummary run();

 private:
  /// A sensor and its next scan; nullopt when it is done.
  struct Sensor {
    core::SensorSimulator simulator;
    std::string name;
    std::optional<core::SimulatedScan> upcoming;
  };

  Sensor* nextSensor();
  core::Time timeOf(long beat) const;
  void writeStaticTransforms();
  void writeBeat(long beat);
  void writeScan(Sensor& sensor);

  const core::Scenario& scenario_;
  SimulatedRecordingParams params_;
  rosbag::Bag& bag_;
  std::vector<Sensor> sensors_;
  SimulatedRecordingSummary summary_;
};

Simulation::Simulation(const core::Scenario& scenario, const SimulatedRecordingParams& params,
                       rosbag::Bag& bag)
    : scenario_(scenario), params_(params), bag_(bag) {
  for (const core::SimulatedSensor& sensor : scenario.sensors) {
    sensors_.push_back({core::SensorSimulator(scenario, sensor.name, params.start), sensor.name, {}});
    sensors_.back().upcoming = sensors_.back().simulator.next();
  }
}

/// Beats (truth and moving transforms) and scans, whichever comes first. The transforms begin before the
/// scans and end after the last exposure, so that none of them lacks its own.
SimulatedRecordingSummary Simulation::run() {
  writeStaticTransforms();
  const long last = std::lround(std::ceil(scenario_.duration * params_.rate));
  long beat = -std::lround(kLead * params_.rate);
  while (true) {
    Sensor* sensor = nextSensor();
    if (beat <= last && (sensor == nullptr || sensor->upcoming->publish_time >= timeOf(beat))) {
      writeBeat(beat++);
    } else if (sensor != nullptr) {
      writeScan(*sensor);
    } else {
      return summary_;
    }
  }
}

/// The one that publishes first; null when all are done.
Simulation::Sensor* Simulation::nextSensor() {
  Sensor* next = nullptr;
  for (Sensor& sensor : sensors_) {
    if (!sensor.upcoming) continue;
    if (next == nullptr || sensor.upcoming->publish_time < next->upcoming->publish_time) next = &sensor;
  }
  return next;
}

core::Time Simulation::timeOf(long beat) const {
  return params_.start + core::durationOf(static_cast<double>(beat) / params_.rate);
}

void Simulation::writeStaticTransforms() {
  const ros::Time time = toRos(params_.start - core::durationOf(kLead));
  std::vector<geometry_msgs::TransformStamped> transforms = fixedTransforms(scenario_, time);
  for (const core::SimulatedSensor& sensor : scenario_.sensors)
    transforms.push_back(mountTransform(sensor, time));
  // Latched, as a broadcaster's: a tracker that starts after the player must hear of them.
  bag_.write("/tf_static", time, messageOf(std::move(transforms)), latchedHeader<tf2_msgs::TFMessage>());
}

void Simulation::writeBeat(long beat) {
  const ros::Time stamp = toRos(timeOf(beat));
  const double time = static_cast<double>(beat) / params_.rate;
  auto transforms = movingTransforms(scenario_, time, stamp);
  if (!transforms.empty()) bag_.write("/tf", stamp, messageOf(std::move(transforms)));
  if (beat < 0) return;
  bag_.write("/truth", stamp, truthMessage(scenario_, time, stamp));
  if (!scenario_.stations.empty())
    bag_.write(kPositionTruthTopic, stamp, positionTruthMessage(scenario_, time, stamp));
  ++summary_.truths;
}

void Simulation::writeScan(Sensor& sensor) {
  core::Scan& scan = sensor.upcoming->scan;
  if (!params_.is_stated) scan.detection_probability = scan.clutter_density = kUnknown;
  bag_.write(sensorTopic(sensor.name, "sightings"), toRos(sensor.upcoming->publish_time),
             toMessage(scan, sensor.name));
  ++summary_.scans;
  summary_.sightings += scan.sightings.size();
  sensor.upcoming = sensor.simulator.next();
}

}  // namespace

SimulatedRecordingSummary recordSimulation(const core::Scenario& scenario,
                                           const SimulatedRecordingParams& params, rosbag::Bag& bag) {
  if (!std::isfinite(scenario.duration))
    throw std::invalid_argument("the scenario has no end: give a duration, --duration 60 for instance");
  return Simulation(scenario, params, bag).run();
}

std::string scenarioFile(const std::string& name) {
  const fs::path folder = fs::path(ros::package::getPath("sightline")) / "config/scenarios";
  const bool is_path = name.find('/') != std::string::npos ||
                       (fs::path(name).extension() == ".yaml" && fs::is_regular_file(name));
  fs::path file = is_path ? fs::path(name) : folder / name;
  if (file.extension() != ".yaml") file += ".yaml";
  if (fs::exists(file)) return file;
  std::vector<std::string> known;
  for (const auto& entry : fs::directory_iterator(folder)) known.push_back(entry.path().stem());
  std::sort(known.begin(), known.end());
  std::string all;
  for (const std::string& other : known) all += (all.empty() ? "" : ", ") + other;
  throw std::runtime_error("there is no scenario " + file.string() + "; the package has " + all);
}

std::vector<std::string> scenarioFiles(const std::string& name, const std::string& sensors) {
  const std::string file = scenarioFile(name);
  if (!sensors.empty()) return {sensors, file};
  if (ParamReader::fromYaml(file).has("stations")) return {file};
  return {fs::path(ros::package::getPath("sightline")) / "config/sensors/six_sensors.yaml", file};
}

}  // namespace sightline_ros
