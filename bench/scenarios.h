#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/estimators/estimator.h"
#include "sightline/core/simulation/random_stream.h"

/// Targets and their sightings for the Monte-Carlo tables: the eight scenarios of section 7.1, six of our
/// own, one sensor or six. Ten seconds each, in ticks of 10 ms, amplitude 1 rad on a flat chart unless
/// scaled.
namespace sightline::bench {

constexpr int kTicks = 1001;  // of 10 ms: 0 to 10 s

/// (azimuth, elevation, rates) [rad, rad/s] at every tick of one run.
using Trajectory = std::vector<Eigen::Vector4d>;

/// One kind of target and what happens to its sightings.
struct Scenario {
  std::string name;
  /// The motion of one run; deterministic ones take nothing from the stream.
  std::function<Trajectory(core::RandomStream&)> motion;
  bool random = false;        ///< whether the motion differs from run to run
  double dropout_from = 0.0;  ///< no sightings in [dropout_from, dropout_to) [s]
  double dropout_to = 0.0;
  double outlier_share = 0.0;  ///< of sightings, not the first three, with an error uniform within +-2 rad
  double white_acceleration = 0.0;  ///< density of the truth, where it is of that kind [rad^2/s^3]
};

/// The eight of section 7.1, in the order of reference_results E3.
const std::vector<Scenario>& namedScenarios();
/// The one of that name, of either list. Throws std::invalid_argument for a name it does not know.
const Scenario& scenarioOf(const std::string& name);

/// Six that estimators.md does not name. They were fixed before any estimator had run on them and are not to
/// be tuned on.
const std::vector<Scenario>& unseenScenarios();

/// What a sensor set saw of one run, in order of time.
struct Instant {
  int tick = 0;
  int sensor = 0;
  Eigen::Vector4d truth = Eigen::Vector4d::Zero();
  core::Measurement measurement;  ///< its covariance is the sensor's also where nothing was seen
  bool seen = true;               ///< false: the sensor looked, there was nothing
  bool outlier = false;
};
using Stream = std::vector<Instant>;

struct Sensors {
  std::vector<double> sigmas;  ///< of both channels, for amplitude 1 [rad]; one for each sensor
  double scale = 1.0;          ///< factor on every angle
  bool synchronous = false;    ///< all sight at the same times; otherwise each at its own
};

/// Three acquisition and three tracking sensors, each with its own sighting sequence.
Sensors sixSensors();

/// Run number `run` of a scenario. The same (scenario, run) gives the same truth with every sensor set.
Stream simulate(const Scenario& scenario, const Sensors& sensors, int run);

/// Time of a tick.
core::Time timeOfTick(int tick);

}  // namespace sightline::bench
