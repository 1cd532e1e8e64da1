#include "sightline/core/smoothing/bank_smoother.h"

#include <cmath>
#include <stdexcept>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "support/simulated.h"

namespace sightline::core {
namespace {

constexpr double kSigma = 0.08;
using Sightings = std::vector<ChartedMeasurement>;

Time at(double t) {
  return Time(durationOf(t));
}

Sightings charted(const std::vector<Measurement>& measurements) {
  Sightings sightings;
  for (const Measurement& measurement : measurements) sightings.push_back({measurement, std::nullopt});
  return sightings;
}

std::vector<Time> timesOf(const Sightings& sightings) {
  std::vector<Time> times;
  for (const ChartedMeasurement& sighting : sightings) times.push_back(sighting.measurement.time);
  return times;
}

/// Straight flight with white acceleration of density q [rad^2/s^3], nothing learnt.
NogaConsistentParams straightBank(double q, double rate_sigma) {
  NogaConsistentParams params;
  params.models = {{ResponseModel::Kind::straight, q}};
  params.amplitude = 1.0;
  params.initial_rate_sigma = rate_sigma;
  params.outlier_share = 0.0;
  params.noise.enabled = false;
  return params;
}

/// All positions and rates of one channel at `times` at once, by least squares over sightings, process noise
/// and the prior of the first rate: mean and covariance of (x, v) at each time.
struct LeastSquares {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};
LeastSquares leastSquares(const std::vector<Time>& times, const Sightings& sightings, int channel, double q,
                          double rate_sigma) {
  const auto n = static_cast<Eigen::Index>(times.size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(2 * n);
  information(1, 1) += 1.0 / (rate_sigma * rate_sigma);
  for (Eigen::Index i = 0; i + 1 < n; ++i) {
    const double h = seconds(times[static_cast<std::size_t>(i + 1)] - times[static_cast<std::size_t>(i)]);
    Eigen::Matrix2d Q;
    Q << h * h * h / 3.0, h * h / 2.0, h * h / 2.0, h;
    Eigen::Matrix<double, 2, 4> A;
    A << -1.0, -h, 1.0, 0.0, 0.0, -1.0, 0.0, 1.0;
    information.block<4, 4>(2 * i, 2 * i) += A.transpose() * (q * Q).inverse() * A;
  }
  for (const ChartedMeasurement& sighting : sightings) {
    for (Eigen::Index i = 0; i < n; ++i) {
      if (times[static_cast<std::size_t>(i)] != sighting.measurement.time) continue;
      const double w = 1.0 / sighting.measurement.covariance(channel, channel);
      information(2 * i, 2 * i) += w;
      right(2 * i) += w * sighting.measurement.position(channel);
    }
  }
  const Eigen::MatrixXd covariance = information.inverse();
  return {covariance * right, covariance};
}

TEST(BankSmoother, OneStraightModelGivesTheLeastSquaresSolutionAlsoBetweenSightings) {
  constexpr double kQ = 0.3, kRate = 2.0;
  const Sightings sightings = charted(test::sightingsOf(test::sinusoid, kSigma, 1, 2.0));
  std::vector<Time> times = timesOf(sightings);
  const std::size_t between = 20;
  times.insert(times.begin() + between, times[between - 1] + durationOf(0.004));
  const auto motions = BankSmoother(straightBank(kQ, kRate)).smooth(sightings, times);
  for (int channel = 0; channel < 2; ++channel) {
    const LeastSquares exact = leastSquares(times, sightings, channel, kQ, kRate);
    for (std::size_t i = 0; i < times.size(); ++i) {
      ASSERT_TRUE(motions[i]);
      const AngularState& state = motions[i]->state;
      const auto k = static_cast<Eigen::Index>(2 * i);
      EXPECT_NEAR(state.mean(channel), exact.mean(k), 1e-9) << i;
      EXPECT_NEAR(state.mean(channel + 2), exact.mean(k + 1), 1e-8) << i;
      EXPECT_NEAR(state.covariance(channel, channel), exact.covariance(k, k), 1e-9 * kSigma * kSigma) << i;
      EXPECT_NEAR(state.covariance(channel, channel + 2), exact.covariance(k, k + 1), 1e-9) << i;
      EXPECT_NEAR(state.covariance(channel + 2, channel + 2), exact.covariance(k + 1, k + 1), 1e-8) << i;
    }
  }
}

TEST(BankSmoother, StraightFlightIsTheSameBackwardInTime) {
  const NogaConsistentParams bank =
      straightBank(0.3, 1e4);  // of the first rate nothing is known, at either end
  const Sightings forward = charted(test::sightingsOf(test::sinusoid, kSigma, 2, 3.0));
  Sightings backward(forward.rbegin(), forward.rend());
  const Time end = backward.front().measurement.time;
  for (ChartedMeasurement& sighting : backward)
    sighting.measurement.time = at(seconds(end - sighting.measurement.time));
  const auto one = BankSmoother(bank).smooth(forward, timesOf(forward));
  const auto other = BankSmoother(bank).smooth(backward, timesOf(backward));
  for (std::size_t i = 0; i < one.size(); ++i) {
    const AngularState &a = one[i]->state, &b = other[one.size() - 1 - i]->state;
    EXPECT_TRUE(a.angles().isApprox(b.angles(), 1e-6)) << i;
    EXPECT_TRUE(a.rates().isApprox(-b.rates(), 1e-5)) << i;
    EXPECT_NEAR(a.covariance(0, 0), b.covariance(0, 0), 1e-6 * kSigma * kSigma) << i;
    EXPECT_NEAR(a.covariance(0, 2), -b.covariance(0, 2), 1e-6 * kSigma) << i;
  }
}

TEST(BankSmoother, NoSightingGivesNothingAndOneGivesItself) {
  const BankSmoother smoother{NogaConsistentParams()};
  EXPECT_FALSE(smoother.smooth({}, {at(1.0)})[0]);
  EXPECT_TRUE(smoother.smooth({}, {}).empty());
  Sightings sightings = charted(test::sightingsOf(test::straight, kSigma, 1, 1.0));
  sightings.resize(1);
  const auto motions = smoother.smooth(sightings, {at(-0.5), at(0.0), at(0.5)});
  EXPECT_FALSE(motions[0]);
  EXPECT_TRUE(motions[1]->state.angles().isApprox(sightings[0].measurement.position, 1e-12));
  EXPECT_NEAR(motions[1]->state.covariance(0, 0), kSigma * kSigma, 1e-12);
  EXPECT_GT(motions[2]->state.covariance(0, 0), kSigma * kSigma);
}

TEST(BankSmoother, TwoSightingsTellTheRateAtTheFirstToo) {
  Sightings sightings = charted(test::sightingsOf(test::straight, 1e-3, 1, 1.0));
  sightings = {sightings.front(), sightings.back()};
  const auto motions = BankSmoother{NogaConsistentParams()}.smooth(sightings, timesOf(sightings));
  EXPECT_NEAR(motions[0]->state.mean(2), 0.3, 0.05);
  EXPECT_LE(motions[0]->state.covariance(0, 0), 1.0001e-6);
  for (const auto& motion : motions)
    EXPECT_EQ(Eigen::LLT<Eigen::Matrix4d>(motion->state.covariance).info(), Eigen::Success);
}

TEST(BankSmoother, AtAndAfterTheLastSightingItIsTheFilter) {
  const Sightings sightings = charted(test::sightingsOf(test::sinusoid, kSigma, 3, 4.0));
  NogaConsistentEstimator filter{NogaConsistentParams()};
  for (const ChartedMeasurement& sighting : sightings) filter.update(sighting.measurement);
  const Time last = sightings.back().measurement.time;
  const std::vector<Time> times{last, last + durationOf(0.7)};
  const auto motions = BankSmoother{NogaConsistentParams()}.smooth(sightings, times);
  for (std::size_t i = 0; i < times.size(); ++i) {
    EXPECT_TRUE(motions[i]->state.mean.isApprox(filter.stateAt(times[i])->mean, 1e-12));
    EXPECT_TRUE(motions[i]->state.covariance.isApprox(filter.stateAt(times[i])->covariance, 1e-12));
  }
}

TEST(BankSmoother, ALagThatHoldsAllSightingsChangesNothingAndNoLagIsTheFilter) {
  const Sightings sightings = charted(test::sightingsOf(test::sinusoid, kSigma, 4, 3.0));
  std::vector<Time> times = timesOf(sightings);
  times.insert(times.begin() + 30, times[29] + durationOf(0.003));
  const BankSmoother smoother{NogaConsistentParams()};
  const auto all = smoother.smooth(sightings, times), lagged = smoother.smooth(sightings, times, 10.0);
  for (std::size_t i = 0; i < times.size(); ++i)
    EXPECT_TRUE(all[i]->state.mean == lagged[i]->state.mean) << i;
  NogaConsistentEstimator filter{NogaConsistentParams()};
  const auto none = smoother.smooth(sightings, timesOf(sightings), 0.0);
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    filter.update(sightings[i].measurement);
    const Time time = sightings[i].measurement.time;
    EXPECT_TRUE(none[i]->state.mean.isApprox(filter.stateAt(time)->mean, 1e-12)) << i;
  }
}

TEST(BankSmoother, MoreSightingsThanAreKeptAtOnceGiveTheSameAsALagThatHoldsTheRest) {
  Sightings sightings;
  for (const Measurement& sighting : test::sightingsOf(test::sinusoid, kSigma, 5, 130.0))
    sightings.push_back({sighting, std::nullopt});
  ASSERT_GT(sightings.size(), 4200u);
  const BankSmoother smoother{NogaConsistentParams()};
  const std::vector<Time> times = timesOf(sightings);
  const auto all = smoother.smooth(sightings, times);
  for (const std::size_t k : {4000u, 4094u, 4095u, 4096u, 4097u, 4150u}) {
    const auto lagged = smoother.smooth(sightings, {times[k]}, 1000.0);
    EXPECT_TRUE(all[k]->state.mean == lagged[0]->state.mean) << k;
    EXPECT_TRUE(all[k]->state.covariance == lagged[0]->state.covariance) << k;
  }
}

struct Figures {
  double filter = 0.0, smoother = 0.0, nees = 0.0;  // mean squares
};

Figures figuresOf(test::Path path, double sigma, int runs) {
  Figures sum;
  int count = 0;
  for (int run = 1; run <= runs; ++run) {
    const Sightings sightings = charted(test::sightingsOf(path, sigma, static_cast<unsigned>(run)));
    const auto motions = BankSmoother{NogaConsistentParams()}.smooth(sightings, timesOf(sightings));
    NogaConsistentEstimator filter{NogaConsistentParams()};
    for (std::size_t i = 0; i < sightings.size(); ++i) {
      filter.update(sightings[i].measurement);
      const double t = test::timeOf(sightings[i].measurement);
      if (t <= 1.0) continue;
      const Eigen::Vector2d truth = path(t).head<2>();
      const Eigen::Vector2d error = motions[i]->state.angles() - truth;
      sum.filter += (filter.stateAt(sightings[i].measurement.time)->angles() - truth).squaredNorm();
      sum.smoother += error.squaredNorm();
      sum.nees += error.dot(motions[i]->state.anglesCovariance().llt().solve(error)) / 2.0;
      ++count;
    }
  }
  for (double* figure : {&sum.filter, &sum.smoother, &sum.nees}) *figure /= count;
  return sum;
}

// Of 100 runs: 0.39 of the filter's error, ANEES 0.95; 20 runs have standard errors of 0.02 and 0.07.
TEST(BankSmoother, SinusoidHasLessThanHalfOfTheFiltersErrorAndAnHonestCovariance) {
  const Figures figures = figuresOf(test::sinusoid, kSigma, 20);
  EXPECT_LT(std::sqrt(figures.smoother / figures.filter), 0.5);
  EXPECT_GT(figures.nees, 0.75);
  EXPECT_LT(figures.nees, 1.25);
}

TEST(BankSmoother, AnAngularScaleChangesNothing) {
  const Sightings large = charted(test::sightingsOf(test::sinusoid, kSigma, 6, 3.0));
  const Sightings small = charted(test::sightingsOf(test::sinusoid, kSigma, 6, 3.0, 1e-3));
  const BankSmoother smoother{NogaConsistentParams()};
  const auto a = smoother.smooth(large, timesOf(large)), b = smoother.smooth(small, timesOf(small));
  for (std::size_t i = 60; i < a.size(); ++i)
    EXPECT_NEAR(a[i]->state.mean(0), 1e3 * b[i]->state.mean(0), 0.1 * kSigma) << i;
}

TEST(BankSmoother, TheGapOfADropoutIsBridged) {
  Sightings seen;
  for (const ChartedMeasurement& sighting : charted(test::sightingsOf(test::sinusoid, kSigma, 7))) {
    const double t = test::timeOf(sighting.measurement);
    if (t < 4.0 || t >= 5.0) seen.push_back(sighting);
  }
  const std::vector<Time> hidden{at(4.2), at(4.5), at(4.8)};
  const auto motions = BankSmoother{NogaConsistentParams()}.smooth(seen, hidden);
  for (std::size_t i = 0; i < hidden.size(); ++i) {
    const double t = seconds(hidden[i].time_since_epoch());
    const Eigen::Vector2d error = motions[i]->state.angles() - test::sinusoid(t).head<2>();
    EXPECT_LT(error.norm(), kSigma) << t;
  }
}

TEST(BankSmoother, ATurnedChartIsTheSameMotionInOtherCoordinates) {
  std::vector<Measurement> measurements = test::sightingsOf(test::straight, 0.01, 8, 3.0);
  const Sightings level = charted(measurements);
  constexpr double kTurn = 0.4;
  const Eigen::Matrix3d R = Eigen::AngleAxisd(-kTurn, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  Sightings turned = level;
  for (std::size_t i = 40; i < turned.size(); ++i) turned[i].measurement.position.x() -= kTurn;
  turned[40].R_new_old = R;
  const BankSmoother smoother{NogaConsistentParams()};
  const auto a = smoother.smooth(level, timesOf(level)), b = smoother.smooth(turned, timesOf(turned));
  for (std::size_t i = 0; i < a.size(); ++i) {
    Eigen::Vector4d mean = b[i]->state.mean;
    if (b[i]->chart_of >= 40) mean(0) += kTurn;
    EXPECT_TRUE(a[i]->state.mean.isApprox(mean, 1e-5)) << i << " in the chart of " << b[i]->chart_of;
  }
  EXPECT_LT(b[30]->chart_of, 40u);
}

TEST(BankSmoother, CoupledChannelsGiveTheSameWhereNothingCouplesThem) {
  Eigen::Matrix2d R = kSigma * kSigma * Eigen::Matrix2d::Identity();
  const Sightings apart = charted(test::sightingsOf(test::sinusoid, R, 9, 3.0));
  Sightings together = apart;  // by a correlation that is just not left out
  for (ChartedMeasurement& sighting : together)
    sighting.measurement.covariance(0, 1) = sighting.measurement.covariance(1, 0) = 1e-5 * kSigma * kSigma;
  const BankSmoother smoother(straightBank(0.3, 2.0));
  const auto a = smoother.smooth(apart, timesOf(apart)), b = smoother.smooth(together, timesOf(together));
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_TRUE(a[i]->state.mean.isApprox(b[i]->state.mean, 1e-3)) << i;
    EXPECT_NEAR(a[i]->state.covariance(0, 0), b[i]->state.covariance(0, 0), 1e-4 * kSigma * kSigma) << i;
    EXPECT_NE(b[i]->state.covariance(0, 1), 0.0) << i;
  }
}

TEST(BankSmoother, SightingsOfOneInstantCountTogether) {
  Sightings sightings;
  for (const ChartedMeasurement& sighting : charted(test::sightingsOf(test::sinusoid, kSigma, 10, 2.0))) {
    sightings.push_back(sighting);
    sightings.push_back(sighting);
  }
  const auto motions = BankSmoother(straightBank(0.3, 2.0)).smooth(sightings, timesOf(sightings));
  for (std::size_t i = 0; i < motions.size(); i += 2) {
    EXPECT_TRUE(motions[i]->state.mean.isApprox(motions[i + 1]->state.mean, 1e-9));
    EXPECT_TRUE(motions[i]->state.mean.allFinite());
  }
}

TEST(BankSmoother, ALongSilenceDividesTheTrack) {
  Sightings sightings = charted(test::sightingsOf(test::straight, kSigma, 11, 2.0));
  const std::size_t first = sightings.size();
  for (ChartedMeasurement later : charted(test::sightingsOf(test::straight, kSigma, 12, 2.0))) {
    later.measurement.time += durationOf(1000.0);
    sightings.push_back(later);
  }
  const BankSmoother smoother{NogaConsistentParams()};
  const auto all = smoother.smooth(sightings, timesOf(sightings));
  const Sightings before(sightings.begin(), sightings.begin() + static_cast<std::ptrdiff_t>(first));
  const auto alone = smoother.smooth(before, timesOf(before));
  for (std::size_t i = 0; i < first; ++i) EXPECT_TRUE(all[i]->state.mean == alone[i]->state.mean) << i;
  const auto between = smoother.smooth(sightings, {at(500.0)});
  EXPECT_TRUE(between[0]->state.mean.allFinite());
}

TEST(BankSmoother, RefusesWhatIsNotInOrderOfTime) {
  Sightings sightings = charted(test::sightingsOf(test::straight, kSigma, 1, 1.0));
  const BankSmoother smoother{NogaConsistentParams()};
  EXPECT_THROW(smoother.smooth(sightings, {at(1.0), at(0.5)}), std::invalid_argument);
  EXPECT_THROW(smoother.smooth(sightings, {}, -1.0), std::invalid_argument);
  std::swap(sightings[3], sightings[4]);
  EXPECT_THROW(smoother.smooth(sightings, {}), std::invalid_argument);
}

}  // namespace
}  // namespace sightline::core
