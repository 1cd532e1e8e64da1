#include "sightline/core/simulation/route.h"

#include <cmath>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

Route<3> openRoute() {
  Route<3> route;
  route.points = {{1.0, {0.0, 0.0, 100.0}},
                  {2.0, {50.0, 10.0, 110.0}},
                  {5.0, {60.0, -40.0, 90.0}},
                  {6.0, {0.0, 5.0, 95.0}}};
  return route;
}

Route<2> loopRoundTheHorizon() {
  Route<2> route;
  route.loop = true;
  route.points = {
      {0.0, {3.0, 0.1}}, {2.0, {-2.9, 0.2}}, {5.0, {-1.0, 0.3}}, {8.0, {1.0, 0.2}}, {10.0, {3.0, 0.1}}};
  return route;
}

TEST(Route, PassesEachWaypointAtItsTime) {
  const Route<3> route = openRoute();
  for (const auto& point : route.points) {
    EXPECT_LT((passageAt(route, point.time).place - point.place).norm(), 1e-12);
  }
}

TEST(Route, PlaceAndRateAreContinuousAtWaypoints) {
  const Route<3> route = openRoute();
  for (const auto& point : route.points) {
    const Passage<3> before = passageAt(route, point.time - 1e-9),
                     after = passageAt(route, point.time + 1e-9);
    EXPECT_LT((before.place - after.place).norm(), 1e-6);
    EXPECT_LT((before.rate - after.rate).norm(), 1e-5);
  }
}

TEST(Route, RateIsTheDerivativeOfThePlace) {
  const Route<3> route = openRoute();
  const double h = 1e-5;
  for (double time = 0.05; time < 8.0; time += 0.1) {
    const Eigen::Vector3d slope =
        (passageAt(route, time + h).place - passageAt(route, time - h).place) / (2.0 * h);
    EXPECT_LT((passageAt(route, time).rate - slope).norm(), 1e-6) << "at " << time;
  }
}

TEST(Route, ThroughWaypointsOfAStraightMotionIsThatMotion) {
  Route<3> route;
  const Eigen::Vector3d start(1.0, 2.0, 3.0), velocity(-3.0, 0.5, 7.0);
  for (const double time : {0.0, 0.3, 4.0, 4.5}) route.points.push_back({time, start + time * velocity});
  for (double time = 0.0; time < 100.0; time += 0.37) {
    EXPECT_LT((passageAt(route, time).place - start - time * velocity).norm(), 1e-10);
  }
}

TEST(Route, GoesStraightOnBeyondItsEnds) {
  const Route<3> route = openRoute();
  const Eigen::Vector3d last_rate = route.points[3].place - route.points[2].place;  // over 1 s
  EXPECT_LT((passageAt(route, 106.0).place - (route.points[3].place + 100.0 * last_rate)).norm(), 1e-9);
  const Eigen::Vector3d first_rate = route.points[1].place - route.points[0].place;  // over 1 s
  EXPECT_LT((passageAt(route, 0.0).place - (route.points[0].place - first_rate)).norm(), 1e-9);
}

TEST(Route, AzimuthGoesTheShortWayRound) {
  const Route<2> route = loopRoundTheHorizon();
  const double middle = passageAt(route, 1.0).place.x();  // between 3.0 and -2.9, across pi
  EXPECT_GT(std::abs(std::remainder(middle, 2.0 * kPi)), 2.9);
  EXPECT_GT(passageAt(route, 1.0).rate.x(), 0.0);
}

TEST(Route, LoopRepeatsSmoothlyForEver) {
  const Route<2> route = loopRoundTheHorizon();
  for (double time = 0.0; time < 10.0; time += 0.7) {
    const Passage<2> once = passageAt(route, time), later = passageAt(route, time + 1e4);
    EXPECT_LT(std::abs(std::remainder(once.place.x() - later.place.x(), 2.0 * kPi)), 1e-9);
    EXPECT_LT(std::abs(once.place.y() - later.place.y()), 1e-9);
    EXPECT_LT((once.rate - later.rate).norm(), 1e-9);
  }
  EXPECT_LT((passageAt(route, 10.0 - 1e-9).rate - passageAt(route, 10.0 + 1e-9).rate).norm(), 1e-7);
}

TEST(Route, FaultsAreNamed) {
  EXPECT_FALSE(refusalOf(openRoute()));
  EXPECT_FALSE(refusalOf(loopRoundTheHorizon()));

  Route<3> backwards = openRoute();
  backwards.points[2].time = 2.0;
  EXPECT_NE(textOf(refusalOf(backwards).value()).find("waypoint 3 at 2 s follows 2 s"), std::string::npos);

  Route<3> open = openRoute();
  open.loop = true;
  EXPECT_NE(textOf(refusalOf(open).value()).find("loop"), std::string::npos);

  EXPECT_NE(textOf(refusalOf(Route<2>{}).value()).find("at least 2 waypoints, got 0"), std::string::npos);
}

}  // namespace
}  // namespace sightline::core
