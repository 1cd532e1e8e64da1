#include "sightline/core/positions/smoothing/position_smoother.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "../simulated_stations.h"
#include "support/times.h"

namespace sightline::core {
namespace {

using test::at;
using test::SimulatedStation;
using test::WanderingTarget;
using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix<double, 6, 6>;

constexpr double kStep = 0.04;  // [s] between sightings of one station
constexpr int kSteps = 300;

struct Flight {
  std::vector<StationMeasurement> measurements;
  std::vector<Time> times;
  std::vector<Vector> truth;
};

/// Three stations, of which all but the first are silent from the step `alone` up to `together`.
Flight flightOf(std::uint64_t seed, const SlowError& slow = {}, int alone = 0, int together = 0) {
  WanderingTarget target({{30, 40, 20}, {3, -2, 0.5}}, 1.0, seed);
  std::vector<SimulatedStation> stations;
  const Vector origins[] = {{0, 0, 0}, {100, 0, 2}, {40, 90, 5}};
  for (int i = 0; i < 3; ++i)
    stations.emplace_back(i, origins[i], 5e-4, slow, 100 * seed + static_cast<std::uint64_t>(i));
  Flight flight;
  for (int i = 1; i < kSteps; ++i) {
    const auto& now = target.advance(kStep);
    for (int station = 0; station < 3; ++station) {
      const StationMeasurement seen =
          stations[static_cast<std::size_t>(station)].see(i * kStep, now.position);
      if (station == 0 || i < alone || i >= together) flight.measurements.push_back(seen);
    }
    flight.times.push_back(at(i * kStep));
    flight.truth.push_back(now.position);
  }
  return flight;
}

using Positions = std::vector<std::optional<SmoothedPosition>>;

Positions filtered(const Flight& flight) {
  PositionEstimator estimator;
  Positions positions;
  std::size_t next = 0;
  for (const Time time : flight.times) {
    for (; next < flight.measurements.size() && flight.measurements[next].time <= time; ++next)
      estimator.update(flight.measurements[next]);
    const auto state = estimator.stateAt(time);
    positions.push_back(state ? std::make_optional(SmoothedPosition{state->mean, state->covariance})
                              : std::nullopt);
  }
  return positions;
}

struct Figures {
  double square = 0.0, nees = 0.0;
  int count = 0;

  void take(const Positions& positions, const Flight& flight, int from, int to) {
    for (int i = from; i < to; ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (!positions[k]) continue;
      const Vector error = positions[k]->mean.head<3>() - flight.truth[k];
      square += error.squaredNorm();
      nees += error.dot(positions[k]->covariance.topLeftCorner<3, 3>().llt().solve(error)) / 3.0;
      ++count;
    }
  }
  double rms() const { return std::sqrt(square / count); }
  double anees() const { return nees / count; }
};

TEST(PositionSmoother, IsNearerToTheTargetThanTheFilterAndHonest) {
  Figures filter, smoother;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Flight flight = flightOf(seed);
    filter.take(filtered(flight), flight, 50, 270);
    smoother.take(PositionSmoother().smooth(flight.measurements, flight.times), flight, 50, 270);
  }
  EXPECT_EQ(smoother.count, filter.count);
  EXPECT_LT(smoother.rms(), 0.72 * filter.rms());
  EXPECT_GT(smoother.anees(), 0.7);
  EXPECT_LT(smoother.anees(), 1.3);
}

TEST(PositionSmoother, WithSlowErrorsTheCovarianceIsHonestAsWell) {
  Figures filter, smoother;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Flight flight = flightOf(seed, {1e-6, 3.0});
    filter.take(filtered(flight), flight, 50, 270);
    smoother.take(PositionSmoother().smooth(flight.measurements, flight.times), flight, 50, 270);
  }
  EXPECT_LT(smoother.rms(), filter.rms());
  EXPECT_GT(smoother.anees(), 0.6);
  EXPECT_LT(smoother.anees(), 1.4);
}

TEST(PositionSmoother, BridgesASecondOfOneStationAloneByWhatComesBehind) {
  Figures filter, smoother;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Flight flight = flightOf(seed, {}, 150, 175);
    filter.take(filtered(flight), flight, 155, 174);
    smoother.take(PositionSmoother().smooth(flight.measurements, flight.times), flight, 155, 174);
  }
  EXPECT_GT(filter.count, 300);
  EXPECT_LT(smoother.rms(), 0.5 * filter.rms());
  EXPECT_LT(smoother.anees(), 1.5);
}

TEST(PositionSmoother, AtTheEndItIsTheFilter) {
  const Flight flight = flightOf(3);
  const auto filter = filtered(flight).back(),
             smoother = PositionSmoother().smooth(flight.measurements, flight.times).back();
  ASSERT_TRUE(filter && smoother);
  EXPECT_LT((filter->mean - smoother->mean).norm(), 1e-9);
  EXPECT_LT((filter->covariance - smoother->covariance).norm(), 1e-9 * filter->covariance.norm());
}

TEST(PositionSmoother, AModelOfOneIsTheRecursionOfRauchTungAndStriebel) {
  // Two ways to the same: a batch of all measurements of a linear-Gaussian target that stands still is what
  // the recursion gives at every time.
  PositionEstimatorParams params;
  params.models = {{PositionModel::Kind::white_acceleration, 0.0}};
  WanderingTarget target({{30, 40, 20}, {0, 0, 0}}, 0.0, 1);
  std::vector<SimulatedStation> stations;
  stations.emplace_back(0, Vector(0, 0, 0), 5e-4, SlowError{}, 7u);
  stations.emplace_back(1, Vector(100, 0, 2), 5e-4, SlowError{}, 8u);
  Flight flight;
  for (int i = 1; i < 200; ++i) {
    for (auto& station : stations) flight.measurements.push_back(station.see(i * kStep, {30, 40, 20}));
    flight.times.push_back(at(i * kStep));
  }
  const auto positions = PositionSmoother(params).smooth(flight.measurements, flight.times);
  const SmoothedPosition& last = *positions.back();
  const SmoothedPosition& early = *positions[50];
  const double h = seconds(flight.times.back() - flight.times[50]);
  Matrix F = Matrix::Identity();
  F.topRightCorner<3, 3>().diagonal().setConstant(-h);
  // Without process noise what is known of then is what is known of the end, moved back.
  EXPECT_LT((early.mean - F * last.mean).norm(), 1e-6);
  EXPECT_LT((early.covariance - F * last.covariance * F.transpose()).norm(),
            1e-4 * (F * last.covariance * F.transpose()).norm());
}

TEST(PositionSmoother, TimesBetweenMeasurementsLieBetweenTheirNeighbours) {
  Flight flight = flightOf(4);
  std::vector<Time> times;
  for (int i = 100; i < 200; ++i)
    for (const double part : {0.0, 0.5}) times.push_back(at((i + part) * kStep));
  const auto positions = PositionSmoother().smooth(flight.measurements, times);
  for (std::size_t i = 1; i + 1 < times.size(); i += 2) {
    ASSERT_TRUE(positions[i]);
    const Vector between = 0.5 * (positions[i - 1]->mean + positions[i + 1]->mean).head<3>();
    EXPECT_LT((positions[i]->mean.head<3>() - between).norm(), 0.02) << i;
    EXPECT_EQ(positions[i]->covariance.llt().info(), Eigen::Success) << i;
  }
}

TEST(PositionSmoother, ALagIsBetweenTheFilterAndAllMeasurements) {
  Figures filter, lagging, smoother;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Flight flight = flightOf(seed);
    filter.take(filtered(flight), flight, 50, 270);
    lagging.take(PositionSmoother().smooth(flight.measurements, flight.times, 0.4), flight, 50, 270);
    smoother.take(PositionSmoother().smooth(flight.measurements, flight.times), flight, 50, 270);
  }
  EXPECT_LT(lagging.rms(), 0.85 * filter.rms());
  EXPECT_LT(smoother.rms(), 1.01 * lagging.rms());
}

TEST(PositionSmoother, ALagOfNothingIsTheFilter) {
  const Flight flight = flightOf(5);
  const auto filter = filtered(flight),
             smoother = PositionSmoother().smooth(flight.measurements, flight.times, 0.0);
  for (std::size_t i = 0; i < filter.size(); ++i) {
    ASSERT_EQ(filter[i].has_value(), smoother[i].has_value()) << i;
    if (filter[i]) {
      EXPECT_LT((filter[i]->mean - smoother[i]->mean).norm(), 1e-9) << i;
    }
  }
}

TEST(PositionSmoother, MoreMeasurementsThanABlockAreTheSameAsInOneAndAgainTheSame) {
  const Flight flight = flightOf(6);  // 897 measurements; a block has 512
  const PositionSmoother smoother;
  const auto once = smoother.smooth(flight.measurements, flight.times);
  const auto again = smoother.smooth(flight.measurements, flight.times);
  const auto late = smoother.smooth(flight.measurements, {flight.times.begin() + 250, flight.times.end()});
  for (std::size_t i = 0; i < once.size(); ++i) {
    ASSERT_EQ(once[i].has_value(), again[i].has_value());
    if (once[i]) {
      EXPECT_EQ(once[i]->mean, again[i]->mean);
    }
    if (i >= 250) {
      EXPECT_EQ(once[i]->mean, late[i - 250]->mean);
    }
  }
}

TEST(PositionSmoother, BeforeThereIsAPositionThereIsNone) {
  const Flight flight = flightOf(7);
  std::vector<Time> times{at(-1.0), at(0.01)};
  times.insert(times.end(), flight.times.begin(), flight.times.end());
  const auto positions = PositionSmoother().smooth(flight.measurements, times);
  EXPECT_FALSE(positions[0]);
  EXPECT_FALSE(positions[1]);
  EXPECT_TRUE(positions.back());
  EXPECT_TRUE(PositionSmoother().smooth({}, {}).empty());
  EXPECT_FALSE(PositionSmoother().smooth({}, {at(1.0)})[0]);
}

TEST(PositionSmoother, RefusesWhatIsNotInOrder) {
  Flight flight = flightOf(8);
  const PositionSmoother smoother;
  EXPECT_THROW(smoother.smooth(flight.measurements, {at(2.0), at(1.0)}), std::invalid_argument);
  EXPECT_THROW(smoother.smooth(flight.measurements, {at(1.0)}, -0.1), std::invalid_argument);
  EXPECT_THROW(smoother.smooth(flight.measurements, {at(1.0)}, std::nan("")), std::invalid_argument);
  std::swap(flight.measurements.front(), flight.measurements.back());
  EXPECT_THROW(smoother.smooth(flight.measurements, flight.times), std::invalid_argument);
}

}  // namespace
}  // namespace sightline::core
