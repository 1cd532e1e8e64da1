#include "scenarios.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include <Eigen/Cholesky>

namespace sightline::bench {
namespace {

using core::RandomStream;
using Acceleration = std::function<Eigen::Vector2d(double)>;  // of t [s], [rad/s^2]

constexpr double kTick = 0.01;  // [s]

Trajectory sampled(const std::function<Eigen::Vector4d(double)>& motion) {
  Trajectory trajectory;
  for (int tick = 0; tick < kTicks; ++tick) trajectory.push_back(motion(kTick * tick));
  return trajectory;
}

/// Integrates an acceleration whose jumps lie on ticks, by Gauss' rule of two points: the position of a
/// tick's end by int (h - u) a du.
Trajectory integrated(Eigen::Vector4d state, const Acceleration& acceleration) {
  Trajectory trajectory;
  const double offset = 0.5 / std::sqrt(3.0);
  for (int tick = 0; tick < kTicks; ++tick) {
    trajectory.push_back(state);
    Eigen::Vector2d step = Eigen::Vector2d::Zero(), jolt = Eigen::Vector2d::Zero();
    for (const double u : {0.5 - offset, 0.5 + offset}) {
      const Eigen::Vector2d a = acceleration(kTick * (tick + u));
      jolt += 0.5 * kTick * a;
      step += 0.5 * kTick * kTick * (1.0 - u) * a;
    }
    state.head<2>() += kTick * state.tail<2>() + step;
    state.tail<2>() += jolt;
  }
  return trajectory;
}

std::function<Trajectory(RandomStream&)> always(Trajectory trajectory) {
  return [trajectory = std::move(trajectory)](RandomStream&) { return trajectory; };
}

/// Within [from, to).
bool during(double t, double from, double to) {
  return t >= from && t < to;
}

Eigen::Vector2d weaveAcceleration(double t) {
  Eigen::Vector2d a = Eigen::Vector2d::Zero();
  if (during(t, 3.0, 6.0)) a(0) = 2.0 * std::sin(2.5 * (t - 3.0));
  if (during(t, 6.5, 8.5)) a(0) = 1.5;
  if (during(t, 2.0, 4.0)) a(1) = 1.2;
  if (during(t, 5.0, 8.0)) a(1) = -2.5 * std::sin(4.0 * (t - 5.0));
  return a;
}

Trajectory sinusoidAbout(double azimuth, double elevation) {
  return sampled([=](double t) {
    return Eigen::Vector4d(azimuth + std::sin(t), elevation + std::cos(t), std::cos(t), -std::sin(t));
  });
}

/// White acceleration of density q, first rates N(0, 0.5^2).
Trajectory whiteAcceleration(double q, RandomStream& random) {
  const double h = kTick;
  Eigen::Matrix2d Q;
  Q << h * h * h / 3.0, h * h / 2.0, h * h / 2.0, h;
  const Eigen::Matrix2d root = Eigen::LLT<Eigen::Matrix2d>(q * Q).matrixL();
  Eigen::Vector4d state = Eigen::Vector4d::Zero();
  state.tail<2>() = 0.5 * random.normalPair();
  Trajectory trajectory;
  for (int tick = 0; tick < kTicks; ++tick) {
    trajectory.push_back(state);
    for (int channel = 0; channel < 2; ++channel) {
      const Eigen::Vector2d jolt = root * random.normalPair();
      state(channel) += h * state(channel + 2) + jolt(0);
      state(channel + 2) += jolt(1);
    }
  }
  return trajectory;
}

/// Acceleration that wanders about zero (Ornstein-Uhlenbeck): sigma 0.7 rad/s^2, correlated over 1 s.
Trajectory wanderingAcceleration(RandomStream& random) {
  constexpr double kSigma = 0.7, kTime = 1.0;
  const double keep = std::exp(-kTick / kTime), fresh = kSigma * std::sqrt(1.0 - keep * keep);
  std::vector<Eigen::Vector2d> accelerations;
  Eigen::Vector2d a = kSigma * random.normalPair();
  for (int tick = 0; tick < kTicks; ++tick) {
    accelerations.push_back(a);
    a = keep * a + fresh * random.normalPair();
  }
  Eigen::Vector4d state = Eigen::Vector4d::Zero();
  state.tail<2>() = 0.3 * random.normalPair();
  return integrated(state,
                    [&](double t) { return accelerations[static_cast<std::size_t>(std::floor(t / kTick))]; });
}

/// Circular frequency from 0.5 to 2.5 rad/s in ten seconds.
Trajectory chirp() {
  return sampled([](double t) {
    const double phase = 0.5 * t + 0.1 * t * t, rate = 0.5 + 0.2 * t;
    return Eigen::Vector4d(std::sin(phase), std::cos(phase), rate * std::cos(phase), -rate * std::sin(phase));
  });
}

/// Straight legs with hard turns of 0.3 s between them.
Trajectory jinks() {
  Eigen::Vector4d start(-0.5, 0.3, 0.4, 0.1);
  return integrated(start, [](double t) {
    if (during(t, 1.8, 2.1)) return Eigen::Vector2d(-3.0, 1.0);
    if (during(t, 3.7, 4.0)) return Eigen::Vector2d(3.5, -2.5);
    if (during(t, 5.2, 5.5)) return Eigen::Vector2d(-2.0, 3.0);
    if (during(t, 7.9, 8.2)) return Eigen::Vector2d(1.0, -4.0);
    return Eigen::Vector2d(0.0, 0.0);
  });
}

Trajectory dampedWeave() {
  const auto channel = [](double t, double amplitude, double decay, double frequency) {
    const double fade = amplitude * std::exp(-decay * t);
    return Eigen::Vector2d(fade * std::sin(frequency * t),
                           fade * (frequency * std::cos(frequency * t) - decay * std::sin(frequency * t)));
  };
  return sampled([&](double t) {
    const Eigen::Vector2d azimuth = channel(t, 1.0, 0.2, 3.0), elevation = channel(t, 0.6, 0.15, 2.0);
    return Eigen::Vector4d(azimuth(0), elevation(0) + 0.1 * t, azimuth(1), elevation(1) + 0.1);
  });
}

/// Rests, sets off within half a second, goes on, brakes.
Trajectory stopAndGo() {
  return integrated(Eigen::Vector4d(0.2, -0.2, 0.0, 0.0), [](double t) {
    if (during(t, 1.5, 2.0)) return Eigen::Vector2d(1.4, 0.6);
    if (during(t, 3.5, 4.0)) return Eigen::Vector2d(-1.4, -0.6);
    if (during(t, 5.5, 6.0)) return Eigen::Vector2d(-0.8, 1.6);
    if (during(t, 8.0, 8.5)) return Eigen::Vector2d(0.8, -1.6);
    return Eigen::Vector2d(0.0, 0.0);
  });
}

/// Turns of constant rate at 0.6 rad/s, straight between them.
Trajectory sTurns() {
  const auto turnRate = [](double t) {
    if (during(t, 1.5, 4.0)) return 1.5;
    if (during(t, 5.0, 8.0)) return -1.2;
    return 0.0;
  };
  constexpr double kSpeed = 0.6;
  constexpr int kSteps = 100;  // of a tick: the heading is exact, the path by the midpoint rule
  Trajectory trajectory;
  double heading = 0.4;
  Eigen::Vector2d position(-1.0, 0.0);
  for (int tick = 0; tick < kTicks; ++tick) {
    Eigen::Vector4d state;
    state << position, kSpeed * std::cos(heading), kSpeed * std::sin(heading);
    trajectory.push_back(state);
    const double turn = turnRate(kTick * (tick + 0.5)) * kTick / kSteps;
    for (int step = 0; step < kSteps; ++step) {
      const double middle = heading + 0.5 * turn;
      position += kSpeed * kTick / kSteps * Eigen::Vector2d(std::cos(middle), std::sin(middle));
      heading += turn;
    }
  }
  return trajectory;
}

Scenario deterministic(const char* name, Trajectory trajectory) {
  Scenario scenario;
  scenario.name = name;
  scenario.motion = always(std::move(trajectory));
  return scenario;
}

Scenario whiteAccelerationScenario(const char* name, double q) {
  Scenario scenario;
  scenario.name = name;
  scenario.motion = [q](RandomStream& random) { return whiteAcceleration(q, random); };
  scenario.random = true;
  scenario.white_acceleration = q;
  return scenario;
}

std::vector<Scenario> makeNamed() {
  std::vector<Scenario> all;
  all.push_back(deterministic("sin", sinusoidAbout(0.0, 0.0)));
  all.push_back(deterministic("sinoff", sinusoidAbout(2.0, -3.0)));
  all.push_back(deterministic("weave", integrated(Eigen::Vector4d(0.0, 0.0, 0.3, -0.2), weaveAcceleration)));
  all.push_back(deterministic(
      "line", sampled([](double t) { return Eigen::Vector4d(-1.0 + 0.3 * t, 0.5 - 0.1 * t, 0.3, -0.1); })));
  all.push_back(deterministic("dropout", sinusoidAbout(0.0, 0.0)));
  all.back().dropout_from = 4.0;
  all.back().dropout_to = 5.0;
  all.push_back(deterministic("outlier", sinusoidAbout(0.0, 0.0)));
  all.back().outlier_share = 0.05;
  all.push_back(whiteAccelerationScenario("ncv0.3", 0.3));
  all.push_back(whiteAccelerationScenario("ncv0.03", 0.03));
  return all;
}

std::vector<Scenario> makeUnseen() {
  std::vector<Scenario> all;
  all.push_back(deterministic("chirp", chirp()));
  all.push_back(deterministic("jinks", jinks()));
  all.push_back(deterministic("damped", dampedWeave()));
  all.push_back(deterministic("stop+go", stopAndGo()));
  all.push_back(deterministic("s-turns", sTurns()));
  Scenario wandering;
  wandering.name = "wander";
  wandering.motion = wanderingAcceleration;
  wandering.random = true;
  all.push_back(wandering);
  return all;
}

/// Ticks of one sensor's sightings (S-1): dmin = 10 ms, dmax = 50 ms.
std::vector<int> sightingTicks(RandomStream& random) {
  std::vector<int> ticks;
  for (int tick = 0; tick < kTicks; tick += 1 + static_cast<int>(random.uniform() * 5.0))
    ticks.push_back(tick);
  return ticks;
}

Instant sighted(const Scenario& scenario, const Eigen::Vector4d& truth, int tick, double sigma, double scale,
                bool may_be_outlier, RandomStream& random) {
  Instant instant;
  instant.tick = tick;
  instant.truth = scale * truth;
  Eigen::Vector2d error = sigma * random.normalPair();
  if (scenario.outlier_share > 0.0) {
    const double lot = random.uniform();
    const Eigen::Vector2d wild(4.0 * random.uniform() - 2.0, 4.0 * random.uniform() - 2.0);
    instant.outlier = may_be_outlier && lot < scenario.outlier_share;
    if (instant.outlier) error = wild;
  }
  instant.seen = !during(kTick * tick, scenario.dropout_from - 1e-6, scenario.dropout_to - 1e-6);
  instant.measurement.time = timeOfTick(tick);
  instant.measurement.position = scale * (truth.head<2>() + error);
  instant.measurement.covariance = Eigen::Matrix2d::Identity() * (scale * scale * sigma * sigma);
  return instant;
}

}  // namespace

const std::vector<Scenario>& namedScenarios() {
  static const std::vector<Scenario> all = makeNamed();
  return all;
}

const std::vector<Scenario>& unseenScenarios() {
  static const std::vector<Scenario> all = makeUnseen();
  return all;
}

const Scenario& scenarioOf(const std::string& name) {
  for (const auto* list : {&namedScenarios(), &unseenScenarios()}) {
    for (const Scenario& scenario : *list)
      if (scenario.name == name) return scenario;
  }
  throw std::invalid_argument("no scenario is called \"" + name + "\"");
}

Sensors sixSensors() {
  return {{0.08, 0.08, 0.08, 0.15, 0.15, 0.15}, 1.0};
}

Stream simulate(const Scenario& scenario, const Sensors& sensors, int run) {
  const std::uint64_t seed = core::seedOf(static_cast<std::uint64_t>(run), scenario.name);
  RandomStream motion(core::seedOf(seed, "motion"));
  const Trajectory trajectory = scenario.motion(motion);
  Stream stream;
  std::vector<int> ticks;
  for (std::size_t sensor = 0; sensor < sensors.sigmas.size(); ++sensor) {
    RandomStream random(core::seedOf(seed, "sensor " + std::to_string(sensor)));
    if (sensor == 0 || !sensors.synchronous) ticks = sightingTicks(random);
    int number = 0;
    for (const int tick : ticks) {
      stream.push_back(sighted(scenario, trajectory[static_cast<std::size_t>(tick)], tick,
                               sensors.sigmas[sensor], sensors.scale, number++ >= 3, random));
      stream.back().sensor = static_cast<int>(sensor);
    }
  }
  std::stable_sort(stream.begin(), stream.end(),
                   [](const Instant& a, const Instant& b) { return a.tick < b.tick; });
  return stream;
}

core::Time timeOfTick(int tick) {
  return core::Time(std::chrono::milliseconds(10 * static_cast<std::int64_t>(tick)));
}

}  // namespace sightline::bench
