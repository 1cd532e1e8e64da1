#include "sightline/core/positions/position_estimator.h"

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "simulated_stations.h"
#include "support/times.h"

// Allocations are counted at malloc, because Eigen does not go by operator new. A sanitizer has a malloc of
// its own.
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SIGHTLINE_COUNTS_ALLOCATIONS 1
namespace {
std::atomic<long> allocations{0};
}  // namespace
extern "C" {
void* __libc_malloc(std::size_t size);
void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
}
#else
#define SIGHTLINE_COUNTS_ALLOCATIONS 0
namespace {
std::atomic<long> allocations{0};
}  // namespace
#endif

namespace sightline::core {
namespace {

using test::at;
using test::SimulatedStation;
using test::WanderingTarget;
using Vector = Eigen::Vector3d;

constexpr double kStep = 0.04;  // [s] between sightings of one station

std::vector<SimulatedStation> field(int stations, double white, const SlowError& slow, std::uint64_t seed,
                                    double unit = 1.0) {
  const std::vector<Vector> origins{{0, 0, 0}, {100, 0, 2}, {40, 90, 5}, {-50, 60, 0}, {120, 80, 10}};
  std::vector<SimulatedStation> made;
  for (int i = 0; i < stations; ++i)
    made.emplace_back(i, unit * origins[static_cast<std::size_t>(i)], white, slow,
                      seed * 100 + static_cast<std::uint64_t>(i));
  return made;
}

double nees(const PositionState& state, const Vector& truth) {
  const Vector error = state.mean.head<3>() - truth;
  return error.dot(state.covariance.topLeftCorner<3, 3>().llt().solve(error)) / 3.0;
}

double sigmaAlong(const PositionState& state, const Vector& origin) {
  const Vector v = (state.mean.head<3>() - origin).normalized();
  return std::sqrt(v.dot(state.covariance.topLeftCorner<3, 3>() * v));
}

TEST(PositionEstimator, FollowsATargetWithAnHonestCovarianceAndWithoutAStationsErrorInIt) {
  double sum = 0.0, velocity_sum = 0.0, squares = 0.0;
  int count = 0;
  for (std::uint64_t run = 1; run <= 30; ++run) {
    WanderingTarget target({{30, 40, 20}, {3, -2, 0.5}}, 1.0, run);
    auto stations = field(3, 5e-4, {}, run);
    PositionEstimator estimator;
    for (int i = 1; i < 300; ++i) {
      const auto& now = target.advance(kStep);
      for (auto& station : stations) estimator.update(station.see(i * kStep, now.position));
      if (i < 50 || i % 25) continue;
      const auto state = estimator.stateAt(at(i * kStep));
      ASSERT_TRUE(state);
      ASSERT_TRUE(estimator.isPosition(*state));
      sum += nees(*state, now.position);
      const Vector error = state->mean.tail<3>() - now.velocity;
      velocity_sum += error.dot(state->covariance.bottomRightCorner<3, 3>().llt().solve(error)) / 3.0;
      squares += (state->mean.head<3>() - now.position).squaredNorm();
      ++count;
    }
  }
  EXPECT_GT(sum / count, 0.7);
  EXPECT_LT(sum / count, 1.3);
  EXPECT_GT(velocity_sum / count, 0.6);
  EXPECT_LT(velocity_sum / count, 1.4);
  EXPECT_LT(std::sqrt(squares / count), 0.04);  // one crossing of three rays has 0.03 to 0.05 m
}

TEST(PositionEstimator, SlowErrorsOfStationsAreInItsCovariance) {
  const SlowError slow{1e-6, 3.0};
  double sum = 0.0;
  int count = 0;
  for (std::uint64_t run = 1; run <= 40; ++run) {
    WanderingTarget target({{30, 40, 20}, {3, -2, 0.5}}, 1.0, run);
    auto stations = field(3, 2e-4, slow, run);
    PositionEstimator estimator;
    for (int i = 1; i < 400; ++i) {
      const auto& now = target.advance(kStep);
      for (auto& station : stations) estimator.update(station.see(i * kStep, now.position));
      if (i < 50 || i % 25) continue;
      sum += nees(*estimator.stateAt(at(i * kStep)), now.position);
      ++count;
    }
  }
  EXPECT_GT(sum / count, 0.7);
  EXPECT_LT(sum / count, 1.3);
}

TEST(PositionEstimator, UnitsMakeNoDifference) {
  std::vector<Vector> found;
  for (const double unit : {1.0, 1000.0}) {
    WanderingTarget target({unit * Vector(30, 40, 20), unit * Vector(3, -2, 0.5)}, unit * unit, 3);
    auto stations = field(3, 5e-4, {1e-7, 3.0}, 3, unit);
    PositionEstimator estimator;
    for (int i = 1; i < 200; ++i) {
      const auto& now = target.advance(kStep);
      for (auto& station : stations) estimator.update(station.see(i * kStep, now.position));
    }
    found.push_back(estimator.stateAt(at(199 * kStep))->mean.head<3>() / unit);
  }
  EXPECT_LT((found[0] - found[1]).norm(), 1e-6);
}

// The fault of extended filters: one camera's directions make them sure of a range that nobody measured.
TEST(PositionEstimator, OneStationAloneNeverMakesTheRangeBetterAndItsErrorStaysWithinTheCovariance) {
  double sum = 0.0;
  int count = 0, kept_for_a_second = 0;
  for (std::uint64_t run = 1; run <= 30; ++run) {
    WanderingTarget target({{30, 40, 20}, {3, -2, 0.5}}, 1.0, run);
    auto stations = field(2, 2e-4, {2.5e-7, 3.0}, run);
    PositionEstimator estimator;
    double along = 0.0, alone_until = 0.0;
    for (int i = 1; i < 500; ++i) {
      const auto& now = target.advance(kStep);
      const bool is_alone = i >= 200;
      estimator.update(stations[0].see(i * kStep, now.position));
      if (!is_alone) estimator.update(stations[1].see(i * kStep, now.position));
      const auto state = estimator.stateAt(at(i * kStep));
      if (!is_alone || !state) continue;
      if (i >= 210) {  // the other station counts as gone
        EXPECT_GE(sigmaAlong(*state, stations[0].origin()), along * (1.0 - 1e-6))
            << run << " at " << i * kStep;
        along = sigmaAlong(*state, stations[0].origin());
      }
      if (!estimator.isPosition(*state)) break;
      alone_until = (i - 200) * kStep;
      sum += nees(*state, now.position);
      ++count;
    }
    if (alone_until >= 1.0) ++kept_for_a_second;
  }
  EXPECT_GE(kept_for_a_second, 28);
  EXPECT_GT(sum / count, 0.3);
  EXPECT_LT(sum / count, 2.0);
}

TEST(PositionEstimator, TakesThePositionUpAgainWhenASecondStationReturns) {
  for (std::uint64_t run = 1; run <= 10; ++run) {
    WanderingTarget target({{50, 60, 20}, {1, -0.5, 0}}, 0.2, run);
    auto stations = field(2, 2e-4, {2.5e-7, 3.0}, run);
    PositionEstimator estimator;
    for (int i = 1; i < 300; ++i) {
      const auto& now = target.advance(kStep);
      estimator.update(stations[0].see(i * kStep, now.position));
      if (i < 200 || i >= 240) {
        const MeasurementUse use = estimator.update(stations[1].see(i * kStep, now.position));
        if (i >= 200) {
          EXPECT_EQ(use, MeasurementUse::taken) << run;
        }
      }
      if (i < 265) continue;
      const auto state = estimator.stateAt(at(i * kStep));
      ASSERT_TRUE(state);
      EXPECT_LT((state->mean.head<3>() - now.position).norm(), 0.5) << run;
    }
  }
}

TEST(PositionEstimator, NoRangeIsEverClaimedFromOneStationAtRest) {
  WanderingTarget target({{30, 40, 20}, {3, -2, 0.5}}, 1.0, 5);
  auto stations = field(1, 2e-4, {2.5e-7, 3.0}, 5);
  SimulatedStation beside(1, {0.05, 0, 0}, 2e-4, {2.5e-7, 3.0}, 77);  // a second camera on the same mast
  PositionEstimator estimator;
  for (int i = 1; i < 1000; ++i) {
    const auto& now = target.advance(kStep);
    EXPECT_EQ(estimator.update(stations[0].see(i * kStep, now.position)), MeasurementUse::waiting);
    EXPECT_EQ(estimator.update(beside.see(i * kStep, now.position)), MeasurementUse::waiting);
    ASSERT_FALSE(estimator.stateAt(at(i * kStep)));
  }
}

TEST(PositionEstimator, APositionThatOneStationCannotHoldBecomesADirectionAgain) {
  WanderingTarget target({{30, 40, 20}, {3, -2, 0.5}}, 1.0, 6);
  auto stations = field(2, 2e-4, {2.5e-7, 3.0}, 6);
  PositionEstimator estimator;
  int restarts = 0;
  for (int i = 1; i < 1500; ++i) {
    const auto& now = target.advance(kStep);
    if (estimator.update(stations[0].see(i * kStep, now.position)) == MeasurementUse::restarted) ++restarts;
    if (i < 100) estimator.update(stations[1].see(i * kStep, now.position));
  }
  EXPECT_EQ(restarts, 1);
  EXPECT_FALSE(estimator.stateAt(at(1500 * kStep)));
}

TEST(PositionEstimator, AMovingStationAloneMayFindTheRange) {
  SimulatedStation shore(1, {0, 500, 0}, 2e-4, {}, 9);
  PositionEstimator estimator;
  const Vector target(400, 300, 30);  // at rest
  double along_first = 0.0, along = 0.0;
  for (int i = 1; i < 1500; ++i) {
    SimulatedStation ship(0, {0, 8.0 * i * kStep, 0}, 2e-4, {}, static_cast<std::uint64_t>(i));
    estimator.update(ship.see(i * kStep, target));
    if (i < 100) estimator.update(shore.see(i * kStep, target));
    const auto state = estimator.stateAt(at(i * kStep));
    if (!state || i < 200) continue;
    along = sigmaAlong(*state, ship.origin());
    if (i == 200) along_first = along;
  }
  ASSERT_TRUE(estimator.stateAt(at(1500 * kStep)));
  EXPECT_GT(along, 0.0);
  EXPECT_LT(along, 30.0 * along_first);  // a station at rest has lost it long before
}

TEST(PositionEstimator, MoreStationsThanSlotsAreConsideredHonestly) {
  double sum = 0.0;
  int count = 0;
  for (std::uint64_t run = 1; run <= 20; ++run) {
    WanderingTarget target({{30, 40, 20}, {3, -2, 0.5}}, 1.0, run);
    std::vector<SimulatedStation> stations;
    for (int s = 0; s < kMostStations + 4; ++s) {
      const double angle = 0.6 * s;
      stations.emplace_back(s, Vector(30 + 80 * std::cos(angle), 40 + 80 * std::sin(angle), s), 2e-4,
                            SlowError{1e-6, 3.0}, run * 100 + static_cast<std::uint64_t>(s));
    }
    PositionEstimator estimator;
    for (int i = 1; i < 200; ++i) {
      const auto& now = target.advance(kStep);
      for (auto& station : stations) estimator.update(station.see(i * kStep, now.position));
      if (i < 75 || i % 25) continue;
      sum += nees(*estimator.stateAt(at(i * kStep)), now.position);
      ++count;
    }
  }
  EXPECT_GT(sum / count, 0.5);
  EXPECT_LT(sum / count, 1.6);
}

TEST(PositionEstimator, StartsAnewWhenTheTargetIsAnotherOne) {
  auto stations = field(3, 2e-4, {2.5e-7, 3.0}, 8);
  PositionEstimator estimator;
  int restarts = 0;
  for (int i = 1; i < 300; ++i) {
    const Vector target = i < 150 ? Vector(30, 40, 20) : Vector(60, 20, 40);
    for (auto& station : stations)
      if (estimator.update(station.see(i * kStep, target)) == MeasurementUse::restarted) ++restarts;
  }
  const auto state = estimator.stateAt(at(299 * kStep));
  ASSERT_TRUE(state);
  EXPECT_GE(restarts, 1);
  EXPECT_LT((state->mean.head<3>() - Vector(60, 20, 40)).norm(), 0.5);
}

TEST(PositionEstimator, BadMeasurementsAndParametersAreRefused) {
  auto stations = field(2, 2e-4, {}, 1);
  PositionEstimator estimator;
  StationMeasurement good = stations[0].see(1.0, {30, 40, 20});
  EXPECT_EQ(estimator.update(good), MeasurementUse::waiting);
  StationMeasurement bad = good;
  bad.time = at(0.5);
  EXPECT_EQ(estimator.update(bad), MeasurementUse::refused);
  bad = good;
  bad.ray.direction.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(estimator.update(bad), MeasurementUse::refused);
  bad = good;
  bad.ray.covariance.setZero();
  EXPECT_EQ(estimator.update(bad), MeasurementUse::refused);
  bad = good;
  bad.slow.time_constant = 0.0;
  EXPECT_EQ(estimator.update(bad), MeasurementUse::refused);
  bad = good;
  bad.station = -1;
  EXPECT_EQ(estimator.update(bad), MeasurementUse::refused);

  PositionEstimatorParams params;
  params.models.clear();
  EXPECT_THROW(PositionEstimator{params}, std::invalid_argument);
  params = {};
  params.max_relative_sigma = 1.5;
  EXPECT_THROW(PositionEstimator{params}, std::invalid_argument);
  params = {};
  params.dwell = 0.0;
  EXPECT_THROW(PositionEstimator{params}, std::invalid_argument);
}

TEST(PositionEstimator, ACopyGoesOnAsTheOriginal) {
  WanderingTarget target({{30, 40, 20}, {3, -2, 0.5}}, 1.0, 4);
  auto stations = field(3, 2e-4, {2.5e-7, 3.0}, 4);
  PositionEstimator estimator;
  std::vector<StationMeasurement> later;
  for (int i = 1; i < 200; ++i) {
    const auto& now = target.advance(kStep);
    for (auto& station : stations) {
      const StationMeasurement m = station.see(i * kStep, now.position);
      if (i < 100)
        estimator.update(m);
      else
        later.push_back(m);
    }
  }
  PositionEstimator copy = estimator;
  for (const auto& m : later) estimator.update(m);
  for (const auto& m : later) copy.update(m);
  EXPECT_EQ(copy.stateAt(at(8.0))->mean, estimator.stateAt(at(8.0))->mean);
  EXPECT_EQ(copy.stateAt(at(8.0))->covariance, estimator.stateAt(at(8.0))->covariance);
}

TEST(PositionEstimator, NothingIsAllocatedForAMeasurementAfterTheStart) {
  if (!SIGHTLINE_COUNTS_ALLOCATIONS) GTEST_SKIP() << "allocations cannot be counted here";
  WanderingTarget target({{30, 40, 20}, {3, -2, 0.5}}, 1.0, 2);
  auto stations = field(4, 2e-4, {2.5e-7, 3.0}, 2);
  PositionEstimator estimator;
  long before = 0;
  for (int i = 1; i < 200; ++i) {
    const auto& now = target.advance(kStep);
    if (i == 50) before = allocations;
    for (std::size_t s = 0; s < (i > 150 ? 1u : stations.size()); ++s)
      estimator.update(stations[s].see(i * kStep, now.position));
    if (i > 50) estimator.stateAt(at((i + 1) * kStep));
  }
  ASSERT_TRUE(estimator.hasState());
  EXPECT_EQ(allocations - before, 0);
  const auto used = std::make_unique<std::vector<double>>(1000);
  EXPECT_GT(allocations - before, 0) << "the counter does not count";
}

}  // namespace
}  // namespace sightline::core
