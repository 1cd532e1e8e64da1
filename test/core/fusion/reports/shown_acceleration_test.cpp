#include "sightline/core/fusion/reports/shown_acceleration.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "support/local_tracks.h"

namespace sightline::core {
namespace {

using test::at;
using test::localTrack;

constexpr double kSigma = 1e-3;  // of positions [rad]; rates: 3.5e-3 rad/s

/// Reports of a target that accelerates evenly, thirty a second, for `duration`; rates are off by the
/// noise of a filter whose memory is 0.2 s, times `noise`.
ShownAcceleration shownBy(const Eigen::Vector2d& acceleration, double duration, double noise = 0.0,
                          std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Eigen::Vector2d error = Eigen::Vector2d::Zero();
  ShownAcceleration shown;
  const double h = 1.0 / 30.0, memory = std::exp(-h / 0.2);
  for (double t = 0.0; t <= duration; t += h) {
    Track track = localTrack(1, {0.5 * acceleration.x() * t * t, 0.5 * acceleration.y() * t * t}, kSigma);
    const double sigma = std::sqrt(track.state.covariance(2, 2));
    error = memory * error +
            std::sqrt(1.0 - memory * memory) * sigma * Eigen::Vector2d(normal(random), normal(random));
    track.state.mean.tail<2>() = acceleration * t + noise * error;
    shown.take(track.state, at(10.0 + t));
  }
  return shown;
}

TEST(ShownAcceleration, FindsASteadyTurn) {
  const Eigen::Vector3d shown = shownBy({0.2, -0.1}, 1.0).value();
  EXPECT_NEAR(shown.y(), 0.2, 0.02);
  EXPECT_NEAR(shown.z(), -0.1, 0.01);
}

TEST(ShownAcceleration, ShowsNothingWithoutTwoReports) {
  ShownAcceleration shown;
  EXPECT_TRUE(shown.value().isZero(0.0));
  shown.take(localTrack(1, {0.1, 0.2}, kSigma, {5.0, 3.0}).state, at(1.0));
  EXPECT_TRUE(shown.value().isZero(0.0));
  shown.take(localTrack(1, {0.1, 0.2}, kSigma, {9.0, 3.0}).state, at(1.0));  // no time has gone by
  EXPECT_TRUE(shown.value().isZero(0.0));
}

TEST(ShownAcceleration, NoiseOfTheRatesIsNoAcceleration) {
  int shows = 0;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed)
    shows += !shownBy({0.0, 0.0}, 1.0, 1.0, seed).value().isZero(0.0);
  EXPECT_LT(shows,
            200);  // what is shown then is below what the rates' covariance explains, and a little more
}

TEST(ShownAcceleration, AGreatCircleAtAConstantRateShowsNone) {
  ShownAcceleration shown;
  for (int k = 0; k < 30; ++k) {
    const Track track = localTrack(1, {0.03 * k, 0.0}, 1e-6, {0.9, 0.0});
    shown.take(track.state, at(10.0 + k / 30.0));
  }
  EXPECT_LT(shown.value().norm(), 1e-9);
}

TEST(ShownAcceleration, AllowsForHowFarThePredictionIsOff) {
  const Chart chart = Chart::around(directionOf({0.4, 0.0}));
  AngularState state = chart.fromTracking(localTrack(1, {0.4, 0.0}, kSigma).state);
  const Eigen::Matrix4d before = state.covariance;
  const Eigen::Vector3d to_the_left(-std::sin(0.4), std::cos(0.4), 0.0);
  allowFor(0.3 * to_the_left, 0.2, chart, state);
  Eigen::Vector4d off(0.5 * 0.3 * 0.04, 0.0, 0.3 * 0.2, 0.0);
  EXPECT_TRUE((state.covariance - before).isApprox(off * off.transpose(), 1e-9));
}

}  // namespace
}  // namespace sightline::core
