#include "sightline/core/simulation/simulated_sensor.h"

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

SimulatedSensor sensor() {
  SimulatedSensor sensor;
  sensor.name = "eye";
  sensor.field_of_view = {0.3, 0.2};
  sensor.sigma = {3e-3, 1e-3};
  return sensor;
}

/// The detail of the refusal of a changed sensor; "none" when it is not refused.
std::string refusalAfter(const std::function<void(SimulatedSensor&)>& change) {
  SimulatedSensor changed = sensor();
  change(changed);
  const auto refusal = refusalOf(changed);
  return refusal ? refusal->detail : "none";
}

TEST(SimulatedSensor, StatedVarianceIsTheFloorAndTheRelativePartOfEachChannel) {
  SimulatedSensor relative = sensor();
  relative.relative_sigma = 0.02;
  const Eigen::Vector2d sigma = statedSigma(relative, {0.2, -0.1});
  EXPECT_NEAR(sigma.x(), std::hypot(3e-3, 0.02 * 0.2), 1e-15);
  EXPECT_NEAR(sigma.y(), std::hypot(1e-3, 0.02 * 0.1), 1e-15);
  EXPECT_EQ(statedSigma(sensor(), {0.2, -0.1}), sensor().sigma);
}

TEST(SimulatedSensor, TheRimBelongsToTheFieldOfView) {
  EXPECT_TRUE(inView(sensor(), directionOf({0.3 - 1e-12, 0.2 - 1e-12})));
  EXPECT_FALSE(inView(sensor(), directionOf({0.3 + 1e-9, 0.0})));
  EXPECT_FALSE(inView(sensor(), directionOf({0.0, -0.2 - 1e-9})));
  EXPECT_FALSE(inView(sensor(), -Eigen::Vector3d::UnitX()));
}

TEST(SimulatedSensor, SolidAngleIsThatOfTheFieldOfView) {
  EXPECT_NEAR(solidAngle(sensor()), 2.0 * 0.3 * 2.0 * std::sin(0.2), 1e-12);
  SimulatedSensor whole = sensor();
  whole.field_of_view = {kPi, kPi / 2.0};
  EXPECT_NEAR(solidAngle(whole), 4.0 * kPi, 1e-12);
}

TEST(SimulatedSensor, PositivePitchLooksDown) {
  SimulatedSensor pitched = sensor();
  pitched.mount_attitude = {0.0, 0.1, 0.0};
  const Eigen::Vector3d boresight = R_platform_sensor(pitched) * Eigen::Vector3d::UnitX();
  EXPECT_NEAR(anglesOf(boresight).y(), -0.1, 1e-12);
}

TEST(SimulatedSensor, AnIntervalHoldsItsBeginAndNotItsEnd) {
  const Interval interval{1.0, 2.0};
  EXPECT_TRUE(interval.holds(1.0));
  EXPECT_FALSE(interval.holds(2.0));
  EXPECT_FALSE(refusalOf(interval, "an outage"));
  EXPECT_EQ(refusalOf(Interval{2.0, 2.0}, "an outage").value().detail.find("an outage must start"), 0U);
}

TEST(SimulatedSensor, WhatCannotBeSimulatedIsRefusedByName) {
  EXPECT_EQ(refusalAfter([](SimulatedSensor&) {}), "none");
  const auto expect = [](const std::string& words, const std::function<void(SimulatedSensor&)>& change) {
    EXPECT_NE(refusalAfter(change).find(words), std::string::npos) << refusalAfter(change);
  };
  expect("needs a name", [](SimulatedSensor& s) { s.name = ""; });
  expect("are these degrees?", [](SimulatedSensor& s) { s.field_of_view.x() = 30.0; });
  expect("ifov must be in (0, pi]", [](SimulatedSensor& s) { s.ifov = 0.0; });
  expect("mount's position", [](SimulatedSensor& s) { s.mount_position.x() = std::nan(""); });
  expect("needs a floor", [](SimulatedSensor& s) { s.sigma.y() = 0.0; });
  expect("relative_sigma", [](SimulatedSensor& s) { s.relative_sigma = 1.5; });
  expect("the bias", [](SimulatedSensor& s) { s.bias.x() = 4.0; });
  expect("detection_probability", [](SimulatedSensor& s) { s.detection_probability = 0.0; });
  expect("false sightings a scan", [](SimulatedSensor& s) { s.clutter_density = 1e6; });
  expect("latency", [](SimulatedSensor& s) { s.latency_jitter = -0.1; });
  expect("a degradation needs", [](SimulatedSensor& s) { s.degradations.push_back({{}, -1.0, {0.0, 0.0}}); });
}

}  // namespace
}  // namespace sightline::core
