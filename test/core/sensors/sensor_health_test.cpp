#include "sightline/core/sensors/sensor_health.h"

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "support/golden.h"
#include "support/times.h"

namespace sightline::core {
namespace {

using test::at;

constexpr double kPredicted = 0.0004, kStated = 0.0064;  // variances [rad^2], as in golden.json
constexpr double kInterval = 0.03;                       // [s]

Innovation innovationOf(double azimuth, double elevation) {
  Innovation innovation;
  innovation.nu.resize(2);
  innovation.nu << azimuth, elevation;
  innovation.predicted = PerChannel::Constant(2, kPredicted);
  innovation.stated = PerChannel::Constant(2, kStated);
  return innovation;
}

/// A sensor whose noise has `scale` times the stated variance, and a bias in azimuth [sigma].
struct Watched {
  explicit Watched(unsigned seed, SensorHealthParams params = {}) : random(seed), health(params, at(0.0)) {}

  std::optional<HealthChange> look(double scale, double bias) {
    const double sigma = std::sqrt(kPredicted + scale * kStated);
    const double azimuth = sigma * normal(random) + bias * std::sqrt(kStated);
    const double elevation = sigma * normal(random);
    t += kInterval;
    return health.add(at(t), innovationOf(azimuth, elevation));
  }

  /// Looks until the verdict changes; nothing when it does not within `limit` seconds.
  std::optional<HealthChange> lookUntilChange(double scale, double bias, double limit) {
    for (const double end = t + limit; t < end;) {
      if (auto change = look(scale, bias)) return change;
    }
    return std::nullopt;
  }

  std::mt19937_64 random;
  std::normal_distribution<double> normal{};
  SensorHealth health;
  double t = 0.0;
};

TEST(SensorHealth, MatchesTheReferenceVectors) {
  SIGHTLINE_REQUIRE_SHARED();
  const YAML::Node vectors = test::golden("health");
  const Eigen::ArrayXd nu = test::array(vectors["nu"]);
  const Eigen::MatrixXd expected = test::matrix(vectors["log"]);
  Eigen::MatrixXd log(nu.size(), 6);
  SensorHealthParams params;
  params.form = HealthForm::specified;
  params.noise_threshold = params.bias_threshold = 12.0;
  SensorHealth health(params, at(0.0), 1);
  const double first = vectors["t0"].as<double>(), interval = vectors["dt"].as<double>();
  for (Eigen::Index k = 0; k < nu.size(); ++k) {
    Innovation innovation;
    innovation.nu = PerChannel::Constant(1, nu(k));
    innovation.predicted = PerChannel::Constant(1, vectors["P"].as<double>());
    innovation.stated = PerChannel::Constant(1, vectors["R"].as<double>());
    health.add(at(first + interval * static_cast<double>(k)), innovation);
    log.row(k) << health.noiseSum().value, health.biasAboveSum(0).value, health.biasBelowSum(0).value,
        health.scale(), health.bias()(0), static_cast<double>(health.verdict());
  }
  test::expectGolden(log, expected);
}

TEST(SensorHealth, AHealthySensorIsUsedAsItStands) {
  Watched sensor(1);
  for (int k = 0; k < 1000; ++k) {
    ASSERT_FALSE(sensor.look(1.0, 0.0));
    ASSERT_TRUE(sensor.health.use().isAsStated());
  }
  EXPECT_FALSE(sensor.health.lastChange());
}

TEST(SensorHealth, GrownNoiseIsSeenSizedAndForgivenWhenItIsGone) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    Watched sensor(seed);
    while (sensor.t < 5.0) ASSERT_FALSE(sensor.look(1.0, 0.0));
    const auto alarm = sensor.lookUntilChange(16.0, 0.0, 1.0);
    ASSERT_TRUE(alarm);
    EXPECT_NE(alarm->verdict, SensorVerdict::healthy);  // two sightings may look like a bias at first
    EXPECT_GE(alarm->began, at(4.7));
    EXPECT_LE(alarm->began, alarm->time);
    EXPECT_GE(alarm->scale, 4.0);
    while (sensor.t < 8.0) sensor.look(16.0, 0.0);
    EXPECT_EQ(sensor.health.verdict(), SensorVerdict::noisy);
    EXPECT_FALSE(sensor.health.use().is_excluded);
    EXPECT_GT(sensor.health.use().noise_scale, 4.0);
    const auto recovery = sensor.lookUntilChange(1.0, 0.0, 5.0);
    ASSERT_TRUE(recovery);
    EXPECT_EQ(recovery->verdict, SensorVerdict::healthy);
    EXPECT_TRUE(sensor.health.use().isAsStated());
  }
}

TEST(SensorHealth, ABiasedSensorIsLeftOutAndComesBackWhenItsBiasIsGone) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    Watched sensor(seed);
    while (sensor.t < 5.0) ASSERT_FALSE(sensor.look(1.0, 0.0));
    const auto alarm = sensor.lookUntilChange(1.0, 1.5, 5.0);
    ASSERT_TRUE(alarm);
    EXPECT_EQ(alarm->verdict, SensorVerdict::biased);
    EXPECT_GT(alarm->bias(0), 0.3);
    EXPECT_TRUE(sensor.health.use().is_excluded);
    const double left_out = sensor.t;
    while (sensor.t < left_out + 2.0) sensor.look(1.0, 1.5);
    EXPECT_EQ(sensor.health.verdict(), SensorVerdict::biased);
    // What comes while the bias goes may look like noise for a moment.
    for (int changes = 0; changes < 3 && sensor.health.verdict() != SensorVerdict::healthy; ++changes)
      EXPECT_TRUE(sensor.lookUntilChange(1.0, 0.0, 20.0));
    EXPECT_TRUE(sensor.health.use().isAsStated());
    EXPECT_GE(sensor.t - left_out, SensorHealthParams{}.least_exclusion);
  }
}

TEST(SensorHealth, TheSideAndTheChannelOfABiasDoNotMatter) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  SensorHealth up(SensorHealthParams{}, at(0.0)), down(SensorHealthParams{}, at(0.0)),
      other(SensorHealthParams{}, at(0.0));
  for (int k = 1; k <= 40; ++k) {
    const double a = 0.08 * (normal(random) + 1.0), b = 0.08 * normal(random);
    const auto first = up.add(at(kInterval * k), innovationOf(a, b));
    const auto second = down.add(at(kInterval * k), innovationOf(-a, b));
    const auto third = other.add(at(kInterval * k), innovationOf(b, a));
    EXPECT_EQ(first.has_value(), second.has_value());
    EXPECT_EQ(first.has_value(), third.has_value());
  }
  EXPECT_EQ(up.verdict(), down.verdict());
  EXPECT_EQ(up.bias()(0), -down.bias()(0));
  EXPECT_EQ(up.bias()(0), other.bias()(1));
}

TEST(SensorHealth, ACopyIsIndependentAndGoesOnToTheSameBits) {
  Watched sensor(7);
  for (int k = 0; k < 100; ++k) sensor.look(2.0, 0.3);
  Watched copy = sensor;
  for (int k = 0; k < 100; ++k) {
    sensor.look(9.0, 0.0);
    copy.look(9.0, 0.0);
    ASSERT_EQ(sensor.health.use().is_excluded, copy.health.use().is_excluded);
    ASSERT_EQ(sensor.health.use().noise_scale, copy.health.use().noise_scale);
    ASSERT_EQ(sensor.health.scale(), copy.health.scale());
  }
}

TEST(SensorHealth, OneWildSightingIsNoAlarm) {
  SensorHealth health(SensorHealthParams{}, at(0.0));
  EXPECT_FALSE(health.add(at(kInterval), innovationOf(10.0, 10.0)));
  EXPECT_EQ(health.verdict(), SensorVerdict::healthy);
}

TEST(SensorHealth, RefusesParametersThatCannotWork) {
  SensorHealthParams params;
  params.noise_ratio = 1.0;
  EXPECT_THROW(SensorHealth(params, at(0.0)), std::invalid_argument);
  params = {};
  params.memory = 0.0;
  EXPECT_THROW(SensorHealth(params, at(0.0)), std::invalid_argument);
  EXPECT_THROW(SensorHealth(SensorHealthParams{}, at(0.0), 3), std::invalid_argument);
}

}  // namespace
}  // namespace sightline::core
