#include "sightline/core/simulation/trajectory.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

PlatformState restingPlatform() {
  return {{100.0, -50.0, 20.0}, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity()};
}

Boost twoStages() {
  Boost boost;
  boost.stages = {{35.0, 8.0, 3.0, 1.5, 1.2}, {50.0, 12.0, 1.0, 1.2, 0.4}};
  return boost;
}

struct Named {
  const char* name;
  Trajectory trajectory;
};

/// One of each kind, at its most awkward: across the wrap, over the pole, through stages.
std::vector<Named> everyKind() {
  WhiteAcceleration white;
  white.seed = 5;
  white.rates = {0.3, -0.2};
  AngularRoute angular_route;
  angular_route.points = {{0.0, {3.0, 0.0}}, {3.0, {-3.0, 0.4}}, {9.0, {-2.0, -0.2}}};
  SpatialRoute spatial_route;
  spatial_route.points = {
      {0.0, {900.0, 0.0, 100.0}}, {5.0, {500.0, 700.0, 300.0}}, {9.0, {-900.0, 200.0, 50.0}}};
  return {{"sinusoid", Sinusoid{}},         {"line", AngularLine{{2.0, 1.0}, {0.3, 0.2}}},
          {"weave", benchmarkWeave(1.0)},   {"white acceleration", white},
          {"angular route", angular_route}, {"straight flight", StraightFlight{}},
          {"zenith pass", ZenithPass{}},    {"boost", twoStages()},
          {"spatial route", spatial_route}};
}

Eigen::Vector2d anglesAt(const Trajectory& trajectory, double time) {
  return stateSeenFrom(restingPlatform(), trajectory, time)->angles();
}

/// Integral of `acceleration` from rest at zero by Simpson's rule in velocity and position.
double integrated(const std::function<double(double)>& acceleration, double angle, double rate, double time) {
  const int steps = 40000;
  const double h = time / steps;
  for (int i = 0; i < steps; ++i) {
    const double t = i * h;
    const double a0 = acceleration(t + 1e-12), a1 = acceleration(t + 0.5 * h),
                 a2 = acceleration(t + h - 1e-12);
    angle += h * rate + h * h / 6.0 * (a0 + 2.0 * a1);
    rate += h / 6.0 * (a0 + 4.0 * a1 + a2);
  }
  return angle;
}

TEST(Trajectory, RatesAreTheDerivativeOfTheAnglesForEveryKind) {
  const double h = 1e-6;
  for (const Named& kind : everyKind()) {
    for (double time = 0.0531; time < 40.0; time += 0.31) {
      const AngularState state = *stateSeenFrom(restingPlatform(), kind.trajectory, time);
      const Eigen::Vector2d slope =
          angleDifference(anglesAt(kind.trajectory, time + h), anglesAt(kind.trajectory, time - h)) /
          (2.0 * h);
      EXPECT_LT((state.rates() - slope).norm(), 1e-4 * (1.0 + state.rates().norm()))
          << kind.name << " at " << time;
    }
  }
}

TEST(Trajectory, AnglesAreInTheirRangesForEver) {
  for (const Named& kind : everyKind()) {
    for (const double time : {0.0, 1.0, 100.0, 1e4, 1e6}) {
      const AngularState state = *stateSeenFrom(restingPlatform(), kind.trajectory, time);
      EXPECT_TRUE(state.mean.allFinite()) << kind.name << " at " << time;
      EXPECT_LE(std::abs(state.mean(0)), kPi) << kind.name;
      EXPECT_LE(std::abs(state.mean(1)), kPi / 2.0) << kind.name;
      EXPECT_EQ(state.covariance.norm(), 0.0) << kind.name;
    }
  }
}

TEST(Trajectory, DirectionFromThePlatformIsThatOfTheAngles) {
  for (const Named& kind : everyKind()) {
    for (double time = 0.0; time < 30.0; time += 1.7) {
      const auto direction = directionSeenFrom(restingPlatform().position, kind.trajectory, time);
      EXPECT_LT(angleBetween(*direction, directionOf(anglesAt(kind.trajectory, time))), 1e-12) << kind.name;
    }
  }
}

TEST(Trajectory, EveryDefaultIsWithoutFault) {
  for (const Named& kind : everyKind()) EXPECT_FALSE(faultOf(kind.trajectory)) << kind.name;
  EXPECT_FALSE(faultOf(Trajectory(Boost{})));
}

TEST(Sinusoid, DefaultIsThePapersTarget) {
  for (const double time : {0.0, 0.7, 3.0, 12.0}) {
    const AngularMotion motion = motionAt(Sinusoid{}, time);
    EXPECT_NEAR(motion.angles.x(), std::sin(time), 1e-15);
    EXPECT_NEAR(motion.angles.y(), std::cos(time), 1e-15);
    EXPECT_NEAR(motion.rates.x(), std::cos(time), 1e-15);
    EXPECT_NEAR(motion.rates.y(), -std::sin(time), 1e-15);
  }
}

TEST(Sinusoid, ChannelsHaveAmplitudeFrequencyPhaseAndOffsetOfTheirOwn) {
  const Sinusoid sinusoid{{0.5, 2e-5}, {2.0, 3.0}, {0.1, 0.2}, {2.0, -0.3}};
  const AngularMotion motion = motionAt(sinusoid, 1.5);
  EXPECT_NEAR(motion.angles.x(), 2.0 + 0.5 * std::sin(3.1), 1e-15);
  EXPECT_NEAR(motion.angles.y(), -0.3 + 2e-5 * std::sin(4.7), 1e-15);
  EXPECT_NEAR(motion.rates.y(), 6e-5 * std::cos(4.7), 1e-18);
}

TEST(AngularLine, LeadsOverTheZenithOntoTheOtherSide) {
  const AngularLine line{{0.5, 1.5}, {0.0, 0.1}};
  const AngularState state = onSphere(motionAt(line, 1.0));  // elevation 1.6 > pi/2
  EXPECT_NEAR(state.mean(0), 0.5 - kPi, 1e-12);
  EXPECT_NEAR(state.mean(1), kPi - 1.6, 1e-12);
  EXPECT_NEAR(state.mean(3), -0.1, 1e-12);
}

TEST(Weave, OfTheBenchmarkIntegratesItsAccelerations) {
  const auto azimuth = [](double t) {
    if (t >= 3.0 && t < 6.0) return 2.0 * std::sin(2.5 * (t - 3.0));
    return t >= 6.5 && t < 8.5 ? 1.5 : 0.0;
  };
  const auto elevation = [](double t) {
    if (t >= 2.0 && t < 4.0) return 1.2;
    return t >= 5.0 && t < 8.0 ? -2.5 * std::sin(4.0 * (t - 5.0)) : 0.0;
  };
  for (const double time : {1.0, 2.5, 4.0, 5.0, 6.0, 7.3, 8.0, 10.0}) {
    const AngularMotion motion = motionAt(benchmarkWeave(1.0), time);
    // Simpson's rule is off by up to half a step at each jump of the acceleration.
    EXPECT_NEAR(motion.angles.x(), integrated(azimuth, 0.0, 0.3, time), 1e-3) << time;
    EXPECT_NEAR(motion.angles.y(), integrated(elevation, 0.0, -0.2, time), 1e-3) << time;
  }
}

TEST(Weave, KeepsItsRatesAfterTheLastPiece) {
  const AngularMotion end = motionAt(benchmarkWeave(), 9.0), later = motionAt(benchmarkWeave(), 1009.0);
  EXPECT_LT((later.rates - end.rates).norm(), 1e-12);
  EXPECT_LT((later.angles - end.angles - 1000.0 * end.rates).norm(), 1e-9);
}

TEST(Weave, OverlappingPiecesAddUp) {
  Weave weave;
  weave.rates.setZero();
  weave.azimuth = {{0.0, 2.0, 0.5, 0.0, 0.0, 0.0}, {1.0, 2.0, 0.25, 0.0, 0.0, 0.0}};
  EXPECT_NEAR(motionAt(weave, 2.0).angles.x(), 0.5 * 0.5 * 4.0 + 0.5 * 0.25, 1e-15);
}

TEST(Weave, PieceThatEndsBeforeItStartsIsRefused) {
  Weave weave;
  weave.elevation = {{3.0, 2.0, 1.0, 0.0, 0.0, 0.0}};
  EXPECT_NE(faultOf(weave).value().find("elevation"), std::string::npos);
}

/// Second moments of the increments of `paths` white-acceleration paths over h seconds from `start`.
Eigen::Matrix2d incrementMoments(double density, double start, double h, int paths) {
  Eigen::Matrix2d moments = Eigen::Matrix2d::Zero();
  for (int i = 0; i < paths; ++i) {
    WhiteAcceleration path;
    path.seed = static_cast<std::uint64_t>(i);
    path.density = density;
    const AngularMotion from = motionAt(path, start), to = motionAt(path, start + h);
    const Eigen::Vector2d turn = to.rates - from.rates, shift = to.angles - from.angles - h * from.rates;
    for (int channel = 0; channel < 2; ++channel) {
      const Eigen::Vector2d increment(shift(channel), turn(channel));
      moments += increment * increment.transpose() / (2.0 * paths);
    }
  }
  return moments;
}

TEST(WhiteAcceleration, IncrementsHaveTheirCovarianceOnEveryScale) {
  const double density = 0.3;
  const int paths = 3000;
  struct Span {
    double start, h;
  };
  // across dyadic and interval borders, within one interval, over many
  for (const Span span :
       {Span{0.7, 0.6}, Span{0.25, 0.0625}, Span{1.3, 5.0}, Span{4.0, 0.015625}, Span{0.0, 37.0}}) {
    const double h = span.h;
    Eigen::Matrix2d expected;
    expected << h * h * h / 3.0, h * h / 2.0, h * h / 2.0, h;
    expected *= density;
    const Eigen::Matrix2d moments = incrementMoments(density, span.start, h, paths);
    const double band = 5.0 * std::sqrt(2.0 / (2.0 * paths));  // relative, of a variance from 2 n samples
    EXPECT_NEAR(moments(0, 0) / expected(0, 0), 1.0, band) << span.start << " + " << h;
    EXPECT_NEAR(moments(1, 1) / expected(1, 1), 1.0, band) << span.start << " + " << h;
    EXPECT_NEAR(moments(0, 1) / expected(0, 1), 1.0, 1.6 * band) << span.start << " + " << h;
  }
}

TEST(WhiteAcceleration, NeighbouringIncrementsAreUncorrelated) {
  const int paths = 5000;
  double sum = 0.0;
  for (int i = 0; i < paths; ++i) {
    WhiteAcceleration path;
    path.seed = static_cast<std::uint64_t>(i);
    path.density = 1.0;
    const Eigen::Vector2d a = motionAt(path, 0.5).rates, b = motionAt(path, 0.75).rates,
                          c = motionAt(path, 1.0).rates;
    sum += (b - a).dot(c - b) / 0.25;
  }
  EXPECT_LT(std::abs(sum), 5.0 * std::sqrt(2.0 * paths));
}

TEST(WhiteAcceleration, IsOneSmoothPathWhateverOrderItIsAskedIn) {
  WhiteAcceleration path;
  path.seed = 11;
  const AngularMotion later = motionAt(path, 777.7);
  motionAt(path, 3.0);
  EXPECT_EQ((motionAt(path, 777.7).angles - later.angles).norm(), 0.0);
  for (const double border : {1.0, 2.0, 64.0, 0.5, 3.0 + 5.0 / 1024.0}) {
    const AngularMotion before = motionAt(path, border - 1e-10), after = motionAt(path, border + 1e-10);
    EXPECT_LT((before.angles - after.angles).norm(), 1e-8);
    EXPECT_LT((before.rates - after.rates).norm(), 1e-5);
  }
}

TEST(StraightFlight, IsSeenWithParallax) {
  const StraightFlight flight{{1000.0, 0.0, 0.0}, {0.0, 100.0, 0.0}};
  PlatformState platform;
  platform.velocity = {0.0, 100.0, 0.0};
  const AngularState alongside = *stateSeenFrom(platform, flight, 0.0);
  EXPECT_LT(alongside.mean.norm(), 1e-15);
  platform.velocity.setZero();
  EXPECT_NEAR(stateSeenFrom(platform, flight, 0.0)->mean(2), 0.1, 1e-15);
  platform.position = {0.0, -1000.0, 0.0};
  EXPECT_NEAR(stateSeenFrom(platform, flight, 0.0)->mean(0), kPi / 4.0, 1e-15);
}

TEST(StraightFlight, HasNoDirectionAtThePlatformItself) {
  const StraightFlight flight{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
  EXPECT_FALSE(stateSeenFrom(PlatformState{}, flight, 0.0));
  EXPECT_TRUE(stateSeenFrom(PlatformState{}, flight, 1.0));
}

TEST(ZenithPass, ComesAsNearToTheZenithAsAskedAndNoNearer) {
  for (const double distance : {0.3, 0.02, 1e-4, -0.02}) {
    ZenithPass pass;
    pass.zenith_distance = distance;
    double nearest = kPi;
    for (double time = 0.0; time < 2.0 * pass.closest_time; time += 0.01) {
      const double elevation = stateSeenFrom(PlatformState{}, pass, time)->mean(1);
      nearest = std::min(nearest, kPi / 2.0 - elevation);
    }
    EXPECT_NEAR(nearest, std::abs(distance), 1e-9);
    const AngularState closest = *stateSeenFrom(PlatformState{}, pass, pass.closest_time);
    EXPECT_NEAR(kPi / 2.0 - closest.mean(1), std::abs(distance), 1e-9);
    EXPECT_NEAR(closest.mean(3), 0.0, 1e-9);
    const double side = wrapAngle(closest.mean(0) - pass.course);
    EXPECT_NEAR(side, std::copysign(kPi / 2.0, distance), 1e-6);  // to the left when positive
  }
}

TEST(Boost, IntegratesThrustAndGravityThroughItsStages) {
  const Boost boost = twoStages();
  const auto thrust = [&](double t) -> Eigen::Vector2d {
    for (const BoostStage& stage : boost.stages) {
      if (t < stage.burn) {
        const double elevation =
            stage.elevation_start + (stage.elevation_end - stage.elevation_start) * t / stage.burn;
        return stage.acceleration * Eigen::Vector2d(std::cos(elevation), std::sin(elevation));
      }
      t -= stage.burn + stage.coast;
      if (t < 0.0) return Eigen::Vector2d::Zero();
    }
    return Eigen::Vector2d::Zero();
  };
  for (const double time : {0.5, 8.0, 9.5, 11.0, 20.0, 23.0, 60.0}) {
    const SpatialMotion motion = motionAt(boost, time);
    const Eigen::Vector3d flown = motion.position - boost.site;
    const double downrange = integrated([&](double t) { return thrust(t).x(); }, 0.0, 0.0, time);
    const double height = integrated([&](double t) { return thrust(t).y() - kGravity; }, 0.0, 0.0, time);
    EXPECT_NEAR(flown.head<2>().norm(), downrange, 0.5) << time;  // Simpson's rule stumbles at each staging
    EXPECT_NEAR(flown.z(), height, 0.5) << time;
    EXPECT_NEAR(std::atan2(flown.y(), flown.x()), boost.course, 1e-9);
  }
}

TEST(Boost, SpeedIsContinuousThroughStaging) {
  const Boost boost = twoStages();
  for (const double border : {8.0, 11.0, 23.0, 24.0}) {
    const SpatialMotion before = motionAt(boost, border - 1e-9), after = motionAt(boost, border + 1e-9);
    EXPECT_LT((before.velocity - after.velocity).norm(), 1e-6);
    EXPECT_LT((before.position - after.position).norm(), 1e-5);
  }
}

TEST(Boost, StandsOnTheGroundAtLaunchAndRestsThereAfterTheFall) {
  const Boost boost = twoStages();
  EXPECT_EQ((motionAt(boost, 0.0).position - boost.site).norm(), 0.0);
  EXPECT_EQ(motionAt(boost, 0.0).velocity.norm(), 0.0);
  const SpatialMotion rest = motionAt(boost, 1e5);
  EXPECT_EQ(rest.position.z(), boost.site.z());
  EXPECT_EQ(rest.velocity.norm(), 0.0);
  EXPECT_EQ((motionAt(boost, 2e5).position - rest.position).norm(), 0.0);
  for (double time = 0.0; time < 400.0; time += 0.5)
    EXPECT_GE(motionAt(boost, time).position.z(), boost.site.z());
}

TEST(Boost, FlyingIntoTheGroundUnderThrustEndsThere) {
  Boost dive;
  dive.stages = {{20.0, 5.0, 0.0, 1.2, 1.0}, {20.0, 60.0, 0.0, -1.0, -1.2}};
  EXPECT_EQ(motionAt(dive, 64.0).position.z(), dive.site.z());
  EXPECT_EQ(motionAt(dive, 64.0).velocity.norm(), 0.0);
}

TEST(Boost, ThatCannotLiftOffIsRefused) {
  Boost boost;
  boost.stages = {{9.0, 10.0, 0.0, 1.5, 1.5}};
  EXPECT_NE(faultOf(boost).value().find("does not lift off"), std::string::npos);
  boost.stages = {{40.0, 0.0, 0.0, 1.5, 1.5}};
  EXPECT_NE(faultOf(boost).value().find("burn > 0 s"), std::string::npos);
  boost.stages.clear();
  EXPECT_TRUE(faultOf(boost));
}

TEST(ZenithPass, FaultsAreNamed) {
  ZenithPass pass;
  pass.zenith_distance = 2.0;
  EXPECT_NE(faultOf(pass).value().find("degrees"), std::string::npos);
  pass = ZenithPass{};
  pass.altitude = -1.0;
  EXPECT_NE(faultOf(pass).value().find("altitude"), std::string::npos);
}

}  // namespace
}  // namespace sightline::core
