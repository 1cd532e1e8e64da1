#include "sightline/core/simulation/angular_trajectory.h"

#include <cmath>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

#include "support/integrated.h"

namespace sightline::core {
namespace {

using test::integrated;

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
  EXPECT_NE(textOf(refusalOf(weave).value()).find("elevation"), std::string::npos);
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

}  // namespace
}  // namespace sightline::core
