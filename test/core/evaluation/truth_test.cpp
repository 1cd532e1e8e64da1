#include "sightline/core/evaluation/truth.h"

#include <cmath>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

using namespace sightline::core;

namespace {

Time at(double seconds_since_start) {
  return timeOf(1'000'000'000'000) + durationOf(seconds_since_start);
}

TruthSample sample(double time, double azimuth, double elevation, double azimuth_rate,
                   double elevation_rate) {
  return {at(time), {azimuth, elevation, azimuth_rate, elevation_rate}};
}

/// A great circle through the zenith's neighbourhood: passes at `miss` [rad] from it at time 0, at 1 rad/s.
TruthSample pass(double time, double miss) {
  const Eigen::Vector3d highest(0.0, std::sin(miss), std::cos(miss)), along(1.0, 0.0, 0.0);
  const Eigen::Vector3d direction = std::cos(time) * highest + std::sin(time) * along;
  const Eigen::Vector3d velocity = -std::sin(time) * highest + std::cos(time) * along;
  TruthSample result{at(time), {}};
  result.motion << anglesOf(direction), anglesJacobian(direction) * velocity;
  return result;
}

TEST(Interpolate, IsExactOnCubicsInPositionAndRates) {
  const auto cubic = [](double t) {
    return sample(t, 0.1 + 0.2 * t - 0.3 * t * t + 0.4 * t * t * t, -0.2 + 0.5 * t * t * t,
                  0.2 - 0.6 * t + 1.2 * t * t, 1.5 * t * t);
  };
  for (const double t : {0.2, 0.31, 0.4, 0.5}) {
    const auto motion = interpolate(cubic(0.2), cubic(0.5), at(t));
    ASSERT_TRUE(motion);
    EXPECT_LT((*motion - cubic(t).motion).norm(), 1e-9) << t;
  }
}

TEST(Interpolate, ErrorOnASinusoidFallsWithTheFourthPowerOfTheInterval) {
  const auto errorWith = [](double h) {
    const auto motion =
        interpolate(sample(1.0 - h / 2, std::sin(1.0 - h / 2), 0.0, std::cos(1.0 - h / 2), 0.0),
                    sample(1.0 + h / 2, std::sin(1.0 + h / 2), 0.0, std::cos(1.0 + h / 2), 0.0), at(1.0));
    return std::abs((*motion)(0) - std::sin(1.0));
  };
  EXPECT_NEAR(errorWith(0.1), std::pow(0.1, 4) / 384.0 * std::sin(1.0), 1e-8);  // h^4 |f''''| / 384
  EXPECT_NEAR(errorWith(0.2) / errorWith(0.1), 16.0, 0.1);
}

TEST(Interpolate, CrossesTheWrapWithoutAJump) {
  const auto motion =
      interpolate(sample(0.0, kPi - 0.01, 0.1, 0.2, 0.0), sample(0.2, -kPi + 0.03, 0.1, 0.2, 0.0), at(0.1));
  ASSERT_TRUE(motion);
  EXPECT_NEAR(wrapAngle((*motion)(0) - (kPi + 0.01)), 0.0, 1e-9);
  EXPECT_NEAR((*motion)(2), 0.2, 1e-9);
  EXPECT_LE((*motion)(0), kPi);
}

TEST(Interpolate, FollowsAPassBesideTheZenith) {
  // 1 rad/s, samples 60 ms apart: the angles of an upright chart bend most where it ends, some degrees from
  // the zenith.
  for (const double miss : {0.0, 1e-6, 0.01, 0.3}) {
    for (const double t : {-0.013, 0.004, 0.02}) {
      const auto motion = interpolate(pass(-0.03, miss), pass(0.03, miss), at(t));
      ASSERT_TRUE(motion);
      const TruthSample truth = pass(t, miss);
      EXPECT_LT(angleBetween(directionOf(motion->head<2>()), directionOf(truth.motion.head<2>())), 1e-5)
          << miss << " " << t;
      // rates as arcs: near the zenith the azimuth's own is huge
      const Eigen::Vector2d arc_rates(motion->coeff(2) * std::cos((*motion)(1)), motion->coeff(3));
      EXPECT_NEAR(arc_rates.norm(), 1.0, 1e-3) << miss << " " << t;
    }
  }
}

TEST(Interpolate, RefusesTimesOutsideAndEqualTimes) {
  const TruthSample a = sample(0.0, 0, 0, 0, 0), b = sample(1.0, 0, 0, 0, 0);
  EXPECT_FALSE(interpolate(a, b, at(-0.1)));
  EXPECT_FALSE(interpolate(a, b, at(1.1)));
  EXPECT_FALSE(interpolate(a, a, at(0.0)));
  EXPECT_TRUE(interpolate(a, b, at(0.0)));
  EXPECT_TRUE(interpolate(a, b, at(1.0)));
}

TEST(WithRates, IsExactOnParabolasAtUnevenTimes) {
  const auto parabola = [](double t) {
    return TruthDirection{at(t), {3.1 + 0.3 * t + 0.2 * t * t, 0.2 - 0.1 * t * t}};
  };
  const auto samples = withRates({parabola(0.0), parabola(0.1), parabola(0.4)}, durationOf(1.0));
  ASSERT_EQ(samples.size(), 3u);
  EXPECT_NEAR(samples[1].motion(2), 0.3 + 0.4 * 0.1, 1e-9);
  EXPECT_NEAR(samples[1].motion(3), -0.2 * 0.1, 1e-9);
  EXPECT_NEAR(samples[0].motion(2), 0.3 + 0.2 * 0.1, 1e-9);  // the line to the neighbour
  EXPECT_NEAR(samples[2].motion(3), -0.1 * (0.16 - 0.01) / 0.3, 1e-9);
}

TEST(WithRates, DoesNotReachAcrossAGapAndKeepsTheFirstOfEqualTimes) {
  const auto samples =
      withRates({{at(0.0), {0.0, 0.0}}, {at(0.1), {0.1, 0.0}}, {at(0.1), {0.5, 0.0}}, {at(5.0), {1.0, 0.0}}},
                durationOf(1.0));
  ASSERT_EQ(samples.size(), 3u);
  EXPECT_NEAR(samples[1].motion(2), 1.0, 1e-9);
  EXPECT_EQ(samples[2].motion(2), 0.0);
}

TEST(TruthPath, KnowsTheTargetOnlyBetweenItsSamples) {
  TruthPath path(durationOf(0.5));
  path.add(sample(0.0, 0.0, 0.0, 1.0, 0.0));
  path.add(sample(0.4, 0.4, 0.0, 1.0, 0.0));
  path.add(sample(1.0, 1.0, 0.0, 1.0, 0.0));  // after a gap
  path.add(sample(1.2, 1.2, 0.0, 1.0, 0.0));
  EXPECT_FALSE(path.at(at(-0.01)));
  EXPECT_NEAR(path.at(at(0.3))->state.mean(0), 0.3, 1e-9);
  EXPECT_FALSE(path.at(at(0.7)));
  EXPECT_NEAR(path.at(at(1.0))->state.mean(0), 1.0, 1e-12);
  EXPECT_FALSE(path.at(at(1.21)));
}

TEST(TruthPath, AgeBeginsAnewAfterAGap) {
  TruthPath path(durationOf(0.5));
  for (const double t : {0.0, 0.4, 1.0, 1.2}) path.add(sample(t, t, 0.0, 1.0, 0.0));
  EXPECT_NEAR(path.at(at(0.3))->age, 0.3, 1e-9);
  EXPECT_NEAR(path.at(at(1.1))->age, 0.1, 1e-9);
  path.add(sample(0.7, 0.7, 0.0, 1.0, 0.0));  // late: closes the gap
  EXPECT_NEAR(path.at(at(1.1))->age, 1.1, 1e-9);
}

TEST(TruthPath, PutsALateSampleInItsPlaceAndReplacesARepeatedOne) {
  TruthPath path(durationOf(1.0));
  path.add(sample(0.0, 0.0, 0.0, 0.0, 0.0));
  path.add(sample(1.0, 0.0, 0.0, 0.0, 0.0));
  path.add(sample(0.5, 0.2, 0.0, 0.0, 0.0));
  EXPECT_NEAR(path.at(at(0.5))->state.mean(0), 0.2, 1e-12);
  path.add(sample(0.5, 0.3, 0.0, 0.0, 0.0));
  EXPECT_NEAR(path.at(at(0.5))->state.mean(0), 0.3, 1e-12);
}

TEST(TruthPath, ForgetsOnlyWhatIsNotNeeded) {
  TruthPath path(durationOf(1.0));
  for (int i = 0; i <= 10; ++i) path.add(sample(0.1 * i, 0.1 * i, 0.0, 1.0, 0.0));
  path.forgetBefore(at(0.55));
  EXPECT_TRUE(path.at(at(0.55)));
  EXPECT_TRUE(path.at(at(0.5)));
  EXPECT_FALSE(path.at(at(0.45)));
  path.forgetBefore(at(2.0));
  EXPECT_TRUE(path.empty());
}

}  // namespace
