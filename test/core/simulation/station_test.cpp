#include "sightline/core/simulation/station.h"

#include <chrono>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

using std::chrono::seconds;

TEST(Station, ClockThatIsBehindShowsEarlierTimesAndDriftAddsUp) {
  Station station;
  station.clock_behind = 0.05;
  EXPECT_EQ(clockAt(station, seconds(10)), seconds(10) - std::chrono::milliseconds(50));
  station.clock_drift = 1e-3;
  EXPECT_EQ(clockAt(station, seconds(10)), seconds(10) - std::chrono::milliseconds(60));
  EXPECT_EQ(clockAt(Station{}, seconds(10)), seconds(10));
}

TEST(Station, FaultsAreNamed) {
  Station station;
  EXPECT_NE(textOf(refusalOf(station).value()).find("name"), std::string::npos);
  station.name = "shore";
  EXPECT_FALSE(refusalOf(station));
  station.clock_drift = 0.5;
  EXPECT_NE(textOf(refusalOf(station).value()).find("clock_drift"), std::string::npos);
  station = {"shore", FixedPlatform{}, {5.0, 0.0, 0.0}};
  EXPECT_NE(textOf(refusalOf(station).value()).find("degrees"), std::string::npos);
  station = {"shore", OrbitPlatform{}};
  std::get<OrbitPlatform>(station.motion).radius = -1.0;
  EXPECT_NE(textOf(refusalOf(station).value()).find("radius"), std::string::npos);
}

TEST(Obstacle, HidesWhatIsBehindItAndNothingElse) {
  const Obstacle wall{{10.0, -5.0, 0.0}, {11.0, 5.0, 8.0}};
  const Eigen::Vector3d eye(0.0, 0.0, 2.0);
  EXPECT_TRUE(standsBetween(wall, eye, {20.0, 0.0, 2.0}));
  EXPECT_TRUE(standsBetween(wall, {20.0, 0.0, 2.0}, eye));
  EXPECT_FALSE(standsBetween(wall, eye, {9.0, 0.0, 2.0})) << "in front of it";
  EXPECT_FALSE(standsBetween(wall, eye, {-20.0, 0.0, 2.0})) << "the other way";
  EXPECT_FALSE(standsBetween(wall, eye, {20.0, 0.0, 20.0})) << "above it";
  EXPECT_FALSE(standsBetween(wall, eye, {20.0, 15.0, 2.0})) << "beside it";
  EXPECT_TRUE(standsBetween(wall, eye, {10.5, 0.0, 2.0})) << "in it";
  EXPECT_FALSE(standsBetween(wall, {10.5, 0.0, 20.0}, {10.5, 6.0, 20.0})) << "along its side";
}

TEST(Obstacle, WithoutExtentIsRefused) {
  EXPECT_FALSE(refusalOf(Obstacle{{0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}}));
  EXPECT_TRUE(refusalOf(Obstacle{{0.0, 0.0, 0.0}, {1.0, 0.0, 1.0}}));
}

}  // namespace
}  // namespace sightline::core
