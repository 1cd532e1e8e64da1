#include "sightline/core/positions/stations/station_alignment.h"

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "sightline/core/simulation/random_stream.h"

#include "field_views.h"

namespace sightline::core {
namespace {

using test::Fault;
using test::kOrigins;
using test::kRateSigma;
using test::viewOf;
using Vector = Eigen::Vector3d;

constexpr double kSigma = test::kViewSigma;

/// Three targets that fly in circles, one sample a second of each.
StationAlignment aligned(const std::vector<Fault>& faults, double duration, std::uint64_t seed,
                         const StationAlignmentParams& params = {}) {
  RandomStream random(seed);
  StationAlignment alignment(params);
  for (double t = 0.0; t < duration; t += 1.0) {
    for (int target = 0; target < 3; ++target) {
      std::vector<Ray> rays;
      for (std::size_t s = 0; s < faults.size(); ++s) {
        const double phase = 0.5 * (t - faults[s].clock) + 2.0 * target;
        const Vector x(45 + 20 * std::cos(phase), 50 + 20 * std::sin(phase),
                       15 + 8 * target + 5 * std::sin(0.7 * phase));
        const Vector velocity(-10 * std::sin(phase), 10 * std::cos(phase), 1.75 * std::cos(0.7 * phase));
        const Vector to = x - kOrigins[s],
                     u = (to.normalized() + faults[s].turned.cross(to.normalized())).normalized();
        const auto B = acrossBasis(u);
        const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - u * u.transpose();
        Ray ray;
        ray.origin = kOrigins[s];
        ray.direction = (u + B.transpose() * kSigma * random.normalPair()).normalized();
        ray.covariance = kSigma * kSigma * across;
        ray.motion =
            RayMotion{across * velocity / to.norm() + B.transpose() * kRateSigma * random.normalPair(),
                      kRateSigma * kRateSigma * across, Vector::Zero()};
        rays.push_back(ray);
      }
      // Pairs of n rays share errors: each counts for 2/n of a sample of its own.
      for (std::size_t a = 0; a < rays.size(); ++a)
        for (std::size_t b = a + 1; b < rays.size(); ++b)
          alignment.take(Time(durationOf(t)), viewOf(a, target, rays[a]), viewOf(b, target, rays[b]),
                         2.0 / static_cast<double>(rays.size()));
    }
  }
  return alignment;
}

TEST(StationAlignment, FindsAClockAndAnOrientationAtOnceWithAnHonestStandardDeviation) {
  int honest = 0, total = 0;
  for (std::uint64_t seed = 1; seed <= 25; ++seed) {
    std::vector<Fault> faults(4);
    faults[2] = {0.05, {0.002, -0.003, 0.003}};
    const StationAlignment alignment = aligned(faults, 20.0, seed);
    const auto clock = alignment.clockDifference(0, 2);
    ASSERT_TRUE(clock);
    EXPECT_LT(clock->sigma, 0.01);
    ++total;
    if (std::abs(clock->difference - 0.05) < 3.0 * clock->sigma) ++honest;
    const auto estimate = alignment.of(2);
    ASSERT_TRUE(estimate);
    for (int axis = 0; axis < 3; ++axis) {
      ++total;
      if (std::abs(estimate->orientation(axis) - faults[2].turned(axis)) <
          3.0 * estimate->orientation_sigma(axis))
        ++honest;
    }
  }
  EXPECT_GE(honest, total * 95 / 100);
}

TEST(StationAlignment, StationsThatAreRightAreFoundRight) {
  const StationAlignment alignment = aligned(std::vector<Fault>(4), 30.0, 3);
  for (int station = 0; station < 4; ++station) {
    const auto estimate = alignment.of(station);
    ASSERT_TRUE(estimate);
    EXPECT_LT(std::abs(estimate->clock), 4.0 * estimate->clock_sigma) << station;
    EXPECT_LT(estimate->clock_sigma, 0.01);
  }
}

TEST(StationAlignment, WhatAnglesCannotTellStaysAtItsPrior) {
  // A common rotation of all stations about the vertical: angles among themselves are the same but for the
  // baselines.
  StationAlignmentParams params;
  const StationAlignment alignment = aligned(std::vector<Fault>(2), 30.0, 4, params);
  const auto estimate = alignment.of(0);
  ASSERT_TRUE(estimate);
  // Two stations: one equation a pair for six angles; the turn about the baseline is common.
  EXPECT_GT(estimate->orientation_sigma.x(), 0.5 * params.orientation_sigma);
}

/// Normalised error squared of a clock that one straight path before three stations tells in 10 s, whose slow
/// errors of 3 s are most of the error; mean of many runs with clocks and orientations drawn from the priors.
double clockErrorOfOnePath(bool slow_errors_stated) {
  constexpr double kSlow = 5e-4, kWhite = 1e-4, kTime = 3.0, kStep = 0.1;  // [rad], [rad], [s], [s]
  constexpr int kRuns = 200;
  StationAlignmentParams params;
  params.orientation_sigma = 1e-4;
  double squares = 0.0;
  for (int run = 1; run <= kRuns; ++run) {
    RandomStream random(static_cast<std::uint64_t>(run));
    StationAlignment alignment(params);
    Vector turned[3], slow[3];
    double late[3];
    for (int s = 0; s < 3; ++s) {
      late[s] = params.clock_sigma * random.normalPair().x();
      const Eigen::Vector2d a = random.normalPair(), b = random.normalPair(), c = random.normalPair();
      turned[s] = params.orientation_sigma * Vector(a.x(), a.y(), b.x());
      slow[s] = kSlow * Vector(b.y(), c.x(), c.y());
    }
    for (double t = 0.0; t < 10.0; t += kStep) {
      std::vector<LocalView> views;
      for (std::size_t s = 0; s < 3; ++s) {
        const double at = t - late[s];
        const Vector velocity(6, -2, 0.5), to = Vector(10, 70, 30) + at * velocity - kOrigins[s];
        const Eigen::Vector2d a = random.normalPair(), b = random.normalPair(), c = random.normalPair();
        slow[s] = std::exp(-kStep / kTime) * slow[s] +
                  std::sqrt(1.0 - std::exp(-2.0 * kStep / kTime)) * kSlow * Vector(a.x(), a.y(), b.x());
        const Vector u = (to.normalized() + turned[s].cross(to.normalized()) + slow[s]).normalized();
        const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - u * u.transpose();
        Ray ray;
        ray.origin = kOrigins[s];
        ray.direction = (u + kWhite * across * Vector(b.y(), c.x(), c.y())).normalized();
        ray.covariance = (kSlow * kSlow + kWhite * kWhite) * across;
        ray.motion = RayMotion{across * velocity / to.norm(), 1e-8 * across, Vector::Zero()};
        views.push_back(viewOf(s, 0, ray));
        if (slow_errors_stated) views.back().slow = {kSlow * kSlow, kTime};
      }
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = a + 1; b < 3; ++b)
          alignment.take(Time(durationOf(t)), views[a], views[b], 2.0 / 3.0);
    }
    alignment.forget(1.0);  // what was taken last counts from now on
    const auto clock = alignment.clockDifference(0, 1);
    squares += std::pow((clock->difference - late[1] + late[0]) / clock->sigma, 2) / kRuns;
  }
  return squares;
}

TEST(StationAlignment, TheClockOfOnePathIsHonestWhereSlowErrorsLookLikeIt) {
  const double honest = clockErrorOfOnePath(true);
  EXPECT_GT(honest, 0.5);
  EXPECT_LT(honest, 1.5);
  EXPECT_GT(clockErrorOfOnePath(false), 2.0) << "errors that stay count";
}

TEST(StationAlignment, TargetsAtRestTellNoClock) {
  StationAlignmentParams params;
  StationAlignment alignment(params);
  for (int i = 0; i < 100; ++i) {
    std::vector<Ray> rays;
    for (int s = 0; s < 2; ++s) {
      Ray ray;
      ray.origin = kOrigins[static_cast<std::size_t>(s)];
      ray.direction = (Vector(40, 50, 20) - ray.origin).normalized();
      const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - ray.direction * ray.direction.transpose();
      ray.covariance = kSigma * kSigma * across;
      ray.motion = RayMotion{Vector::Zero(), kRateSigma * kRateSigma * across, Vector::Zero()};
      rays.push_back(ray);
    }
    alignment.take(Time(durationOf(0.1 * i)), viewOf(0, 0, rays[0]), viewOf(1, 0, rays[1]), 1.0);
  }
  EXPECT_NEAR(alignment.clockDifference(0, 1)->sigma, std::sqrt(2.0) * params.clock_sigma, 1e-6);
}

TEST(StationAlignment, ForgetsWhatIsLongAgo) {
  StationAlignment alignment = aligned(std::vector<Fault>(3), 20.0, 5);
  const double before = alignment.clockDifference(0, 1)->sigma;
  alignment.forget(1200.0);
  EXPECT_GT(alignment.clockDifference(0, 1)->sigma, 1.5 * before);
}

TEST(StationAlignment, UnknownStationsAndBadParametersAreRefused) {
  const StationAlignment alignment;
  EXPECT_FALSE(alignment.of(0));
  EXPECT_FALSE(alignment.clockDifference(0, 1));
  StationAlignmentParams params;
  params.memory = 0.0;
  EXPECT_THROW(StationAlignment{params}, std::invalid_argument);
}

}  // namespace
}  // namespace sightline::core
