// The properties that every estimator has, run over all of them.

#include "sightline/core/estimators/estimator.h"

#include <atomic>
#include <cstdlib>
#include <functional>
#include <memory>
#include <new>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "sightline/core/estimators/estimators.h"

#include "support/covariances.h"
#include "support/simulated.h"

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

/// What may be asked of an estimator beyond what every one has.
struct Virtues {
  bool free_of_scale = true;   ///< does the same for an angular scale and its sigmas, whatever the scale
  bool free_of_origin = true;  ///< does not depend on where azimuth is zero
  bool accurate = true;        ///< better than the sightings
  bool honest = true;          ///< its errors are of the size that its covariance says
  double coasts_for = 1e4;     ///< seconds ahead for which the covariance is one in double precision
};

/// An estimator of the default settings, or of others that the tests must reach too.
struct Candidate {
  std::string name;
  std::function<std::unique_ptr<Estimator>()> make;
  Virtues virtues;
};

void PrintTo(const Candidate& candidate, std::ostream* stream) {
  *stream << candidate.name;
}

template <typename Type, typename Params>
auto making(const Params& params) {
  return [params]() -> std::unique_ptr<Estimator> { return std::make_unique<Type>(params); };
}

std::vector<Candidate> candidates() {
  NogaParams printed, weighted, short_rows;
  printed.covariance = NogaCovariance::printed;
  weighted.weighted = true;
  short_rows.rows = 3;
  KalmanParams absolute;
  absolute.process_noise = 0.3;
  TwblsParams raw, few;
  raw.anchor = TwblsAnchor::raw;
  few.max_sightings = 20;
  Virtues line, raw_line, auto_regression, printed_auto_regression, wild, in_radians;
  // A straight line carried on undisturbed: the variance of its far end swallows that of its beginning.
  line.coasts_for = raw_line.coasts_for = 10.0;
  raw_line.accurate = false;  // it publishes the sightings
  auto_regression.free_of_origin = false;
  printed_auto_regression = wild = auto_regression;
  printed_auto_regression.honest = false;
  wild.free_of_scale = wild.accurate = wild.honest = false;
  in_radians.free_of_scale = false;
  std::vector<Candidate> all = {
      {"Twbls", making<TwblsEstimator>(TwblsParams{}), line},
      {"TwblsRaw", making<TwblsEstimator>(raw), raw_line},
      {"TwblsFew", making<TwblsEstimator>(few), line},
      {"TwblsConsistent", making<TwblsConsistentEstimator>(TwblsConsistentParams{}), {}},
      {"NogaConsistent", making<NogaConsistentEstimator>(NogaConsistentParams{}), {}},
      {"Noga", making<NogaEstimator>(NogaParams{}), auto_regression},
      {"NogaPrinted", making<NogaEstimator>(printed), printed_auto_regression},
      {"NogaWeighted", making<NogaEstimator>(weighted), wild},
      {"NogaShort", making<NogaEstimator>(short_rows), wild},
      {"Kalman", making<KalmanEstimator>(KalmanParams{}), {}},
      {"KalmanAbsolute", making<KalmanEstimator>(absolute), in_radians},
      {"Imm", making<ImmEstimator>(ImmParams{}), {}}};
  for (const EstimatorEntry& entry : estimatorTable())
    all.push_back({std::string("Default_") + entry.name, [make = entry.make] { return make({}); }, {}});
  return all;
}

std::vector<Candidate> candidatesThatAre(bool Virtues::*virtue) {
  std::vector<Candidate> chosen;
  for (const Candidate& candidate : candidates())
    if (candidate.virtues.*virtue) chosen.push_back(candidate);
  return chosen;
}

void expectSoundAt(const Estimator& estimator, Time time) {
  const auto state = estimator.stateAt(time);
  ASSERT_TRUE(state);
  ASSERT_TRUE(state->mean.allFinite());
  ASSERT_TRUE(test::isCovariance(state->covariance));
}

class AnyEstimator : public testing::TestWithParam<Candidate> {
 protected:
  std::unique_ptr<Estimator> make() const { return GetParam().make(); }

  /// The covariance is one at the last sighting, after it and before it.
  void expectSound(const Estimator& estimator, Time last) const {
    for (const double h : {0.0, 1e-9, 0.01, 0.03, 0.5, 10.0, GetParam().virtues.coasts_for, -0.02, -1.0})
      expectSoundAt(estimator, last + durationOf(h));
  }
};

class EstimatorFreeOfScale : public AnyEstimator {};
class EstimatorFreeOfOrigin : public AnyEstimator {};
class AccurateEstimator : public AnyEstimator {};
class HonestEstimator : public AnyEstimator {};

std::string nameOf(const testing::TestParamInfo<Candidate>& info) {
  return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(Estimators, AnyEstimator, testing::ValuesIn(candidates()), nameOf);
INSTANTIATE_TEST_SUITE_P(Estimators, EstimatorFreeOfScale,
                         testing::ValuesIn(candidatesThatAre(&Virtues::free_of_scale)), nameOf);
INSTANTIATE_TEST_SUITE_P(Estimators, EstimatorFreeOfOrigin,
                         testing::ValuesIn(candidatesThatAre(&Virtues::free_of_origin)), nameOf);
INSTANTIATE_TEST_SUITE_P(Estimators, AccurateEstimator,
                         testing::ValuesIn(candidatesThatAre(&Virtues::accurate)), nameOf);
INSTANTIATE_TEST_SUITE_P(Estimators, HonestEstimator, testing::ValuesIn(candidatesThatAre(&Virtues::honest)),
                         nameOf);

constexpr double kSigma = 0.01;

Eigen::Matrix2d coupled(double sigma) {
  Eigen::Matrix2d R;
  R << 1.0, 0.95 * 2.0, 0.95 * 2.0, 4.0;
  return sigma * sigma * R;
}

/// Sightings of a target in slow flight near the middle of the chart.
Eigen::Vector4d slow(double t) {
  return {0.1 * t, 0.3 + 0.05 * t, 0.1, 0.05};
}

TEST_P(AnyEstimator, KnowsNothingBeforeTheFirstSighting) {
  const auto estimator = make();
  EXPECT_FALSE(estimator->stateAt(Time{}));
  estimator->rotate(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()).toRotationMatrix());
  EXPECT_FALSE(estimator->stateAt(Time{}));
  EXPECT_FALSE(estimator->clone()->stateAt(Time{}));
}

TEST_P(AnyEstimator, StartsWithTheFirstSighting) {
  const auto estimator = make();
  Measurement first;
  first.time = timeOf(1'700'000'000'000'000'000);
  first.position << 0.1, 0.2;
  first.covariance = kSigma * kSigma * Eigen::Matrix2d::Identity();
  estimator->update(first);
  const AngularState state = *estimator->stateAt(first.time);
  EXPECT_TRUE(state.angles().isApprox(first.position, 1e-12));
  EXPECT_TRUE(state.anglesCovariance().isApprox(first.covariance, 1e-9));
  EXPECT_EQ(state.rates().norm(), 0.0);
  expectSound(*estimator, first.time);
}

TEST_P(AnyEstimator, HasACovarianceAfterEverySighting) {
  for (const Eigen::Matrix2d& R : {coupled(kSigma), coupled(1e-5), coupled(0.1)}) {
    const auto estimator = make();
    for (const Measurement& sighting : test::sightingsOf(test::sinusoid, R, 1, 3.0)) {
      estimator->update(sighting);
      expectSound(*estimator, sighting.time);
    }
  }
}

TEST_P(AnyEstimator, ItsHypothesesHaveTheMeanAndTheCovarianceOfItsState) {
  const auto estimator = make();
  EXPECT_TRUE(estimator->hypothesesAt(Time{}).empty());
  for (const Measurement& sighting : test::sightingsOf(test::sinusoid, kSigma, 1, 2.0)) {
    estimator->update(sighting);
    for (const double h : {0.0, 0.03, 2.0}) {
      const Time time = sighting.time + durationOf(h);
      const AngularState state = *estimator->stateAt(time);
      double sum = 0.0;
      Eigen::Vector4d mean = Eigen::Vector4d::Zero();
      for (const Hypothesis& hypothesis : estimator->hypothesesAt(time)) {
        sum += hypothesis.probability;
        mean += hypothesis.probability * hypothesis.state.mean;
      }
      Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
      for (const Hypothesis& hypothesis : estimator->hypothesesAt(time)) {
        const Eigen::Vector4d offset = hypothesis.state.mean - mean;
        covariance += hypothesis.probability * (hypothesis.state.covariance + offset * offset.transpose());
      }
      ASSERT_NEAR(sum, 1.0, 1e-9);
      ASSERT_LT((mean - state.mean).norm(), 1e-9 * (1.0 + state.mean.norm()));
      ASSERT_LT((covariance - state.covariance).norm(), 1e-9 * state.covariance.norm());
    }
  }
}

TEST_P(AnyEstimator, TakesSightingsAtOneTimeAndAtOnePlace) {
  const auto estimator = make();
  auto sightings = test::sightingsOf(slow, kSigma, 2, 2.0);
  for (Measurement& sighting : sightings) sighting.time = Time{};
  for (const Measurement& sighting : sightings) {
    estimator->update(sighting);
    expectSound(*estimator, sighting.time);
  }
  for (std::size_t i = 0; i < sightings.size(); ++i) {  // then in pairs, and always in the same place
    Measurement sighting = sightings.front();
    sighting.time = Time(std::chrono::milliseconds(30 * (1 + i / 2)));
    estimator->update(sighting);
    expectSound(*estimator, sighting.time);
  }
}

TEST_P(AnyEstimator, TakesSightingsWithoutAnyNoiseAtAll) {
  const auto estimator = make();
  for (int i = 0; i < 60; ++i) {
    Measurement sighting;
    sighting.time = Time(std::chrono::milliseconds(30 * i));
    sighting.position.setZero();
    sighting.covariance = kSigma * kSigma * Eigen::Matrix2d::Identity();
    estimator->update(sighting);
    expectSound(*estimator, sighting.time);
    EXPECT_LT(estimator->stateAt(sighting.time)->mean.norm(), 1e-9);
  }
}

TEST_P(AnyEstimator, OutlivesAPauseOfHours) {
  for (const double sigma : {1e-5, 0.1}) {
    const auto estimator = make();
    Time last{};
    for (Measurement sighting : test::sightingsOf(slow, sigma, 3, 4.0)) {
      if (test::timeOf(sighting) > 2.0) sighting.time += durationOf(1e4);
      if (test::timeOf(sighting) > 3e4) continue;
      estimator->update(sighting);
      expectSound(*estimator, sighting.time);
      last = sighting.time;
    }
    const AngularState state = *estimator->stateAt(last);
    EXPECT_LT((state.angles() - slow(seconds(last.time_since_epoch()) - 1e4).head<2>()).norm(), 20.0 * sigma);
  }
}

TEST_P(AnyEstimator, DoesNotDependOnTheEpoch) {
  const auto early = make(), late = make();
  const Duration shift(1'700'000'000'123'456'789);
  for (Measurement sighting : test::sightingsOf(test::sinusoid, coupled(0.02), 4, 3.0)) {
    early->update(sighting);
    const Time soon = sighting.time + durationOf(0.04);
    sighting.time += shift;
    late->update(sighting);
    EXPECT_EQ(early->stateAt(soon)->mean, late->stateAt(soon + shift)->mean);
    EXPECT_EQ(early->stateAt(soon)->covariance, late->stateAt(soon + shift)->covariance);
  }
}

TEST_P(EstimatorFreeOfScale, DoesTheSameAtEveryAngularScale) {
  // What is known of rates beforehand is in radians, and has faded after six seconds.
  for (const double scale : {1e-2, 1e-4}) {
    const auto large = make(), small = make();
    const auto at_one = test::sightingsOf(test::sinusoid, 0.08, 5, 8.0);
    const auto scaled = test::sightingsOf(test::sinusoid, 0.08, 5, 8.0, scale);
    for (std::size_t i = 0; i < at_one.size(); ++i) {
      large->update(at_one[i]);
      small->update(scaled[i]);
      if (test::timeOf(at_one[i]) < 6.0) continue;
      const AngularState a = *large->stateAt(at_one[i].time), b = *small->stateAt(at_one[i].time);
      EXPECT_LT((b.angles() / scale - a.angles()).norm(), 0.05 * 0.08) << scale;
      EXPECT_LT((b.covariance.diagonal().cwiseQuotient(a.covariance.diagonal()) / (scale * scale)).maxCoeff(),
                1.2);
      EXPECT_GT((b.covariance.diagonal().cwiseQuotient(a.covariance.diagonal()) / (scale * scale)).minCoeff(),
                0.8);
    }
  }
}

TEST_P(EstimatorFreeOfOrigin, DoesNotDependOnWhereAzimuthIsZero) {
  const double turn = 0.8;
  const auto here = make(), there = make();
  for (Measurement sighting : test::sightingsOf(slow, coupled(kSigma), 6, 3.0)) {
    here->update(sighting);
    sighting.position.x() += turn;
    there->update(sighting);
    const AngularState a = *here->stateAt(sighting.time), b = *there->stateAt(sighting.time);
    EXPECT_LT((b.mean - a.mean - Eigen::Vector4d(turn, 0.0, 0.0, 0.0)).norm(), 1e-9);
    EXPECT_TRUE(b.covariance.isApprox(a.covariance, 1e-9));
  }
}

TEST_P(AnyEstimator, GoesOverToAnotherChartAsTheStateDoes) {
  const Eigen::Matrix3d R =
      (Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(-0.3, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  const auto estimator = make();
  Time last{};
  for (const Measurement& sighting : test::sightingsOf(slow, coupled(1e-3), 7, 2.0)) {
    estimator->update(sighting);
    last = sighting.time;
  }
  const AngularState before = *estimator->stateAt(last);
  estimator->rotate(R);
  const AngularState expected = rotateState(before, R), turned = *estimator->stateAt(last);
  EXPECT_LT((turned.mean - expected.mean).head<2>().norm(), 1e-3);  // a sigma: a window's line bends a little
  EXPECT_LT((turned.mean - expected.mean).tail<2>().norm(), 3e-3);
  expectSound(*estimator, last);

  estimator->rotate(R.transpose());
  const AngularState back = *estimator->stateAt(last);
  EXPECT_LT((back.mean - before.mean).norm(), 1e-9);
  EXPECT_LT((back.covariance - before.covariance).norm(), 1e-4 * before.covariance.norm());
}

TEST_P(AccurateEstimator, FollowsItsTargetFromChartToChart) {
  const Eigen::Matrix3d R =
      (Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(-0.3, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  const auto stays = make(), moves = make();
  double worst = 0.0;
  bool gone_over = false;
  for (const Measurement& sighting : test::sightingsOf(slow, 1e-3, 8, 4.0)) {
    stays->update(sighting);
    Measurement turned = sighting;
    if (test::timeOf(sighting) > 2.0) {
      if (!gone_over) moves->rotate(R);
      gone_over = true;
      const Eigen::Matrix2d J = rotationJacobian(sighting.position, R);
      turned.position = rotateAngles(sighting.position, R);
      turned.covariance = symmetric(J * sighting.covariance * J.transpose());
    }
    moves->update(turned);
    if (!gone_over) continue;
    const Eigen::Vector2d stayed = rotateAngles(stays->stateAt(sighting.time)->angles(), R);
    worst = std::max(worst, (moves->stateAt(sighting.time)->angles() - stayed).norm());
  }
  EXPECT_TRUE(gone_over);
  EXPECT_LT(worst, 4e-3) << "four sigmas of a sighting";
}

TEST_P(AnyEstimator, CloneKnowsAllAndGoesItsOwnWay) {
  const auto sightings = test::sightingsOf(test::sinusoid, coupled(0.02), 9, 3.0);
  const auto original = make();
  std::size_t i = 0;
  for (; i < 50; ++i) original->update(sightings[i]);
  const auto clone = original->clone();
  const Time soon = sightings[i - 1].time + durationOf(0.05);
  const AngularState before = *clone->stateAt(soon);
  EXPECT_EQ(original->stateAt(soon)->mean, before.mean);
  EXPECT_EQ(original->stateAt(soon)->covariance, before.covariance);

  for (std::size_t j = i; j < sightings.size(); ++j) original->update(sightings[j]);
  EXPECT_EQ(clone->stateAt(soon)->mean, before.mean);
  for (std::size_t j = i; j < sightings.size(); ++j) clone->update(sightings[j]);
  const Time end = sightings.back().time;
  EXPECT_EQ(clone->stateAt(end)->mean, original->stateAt(end)->mean);
  EXPECT_EQ(clone->stateAt(end)->covariance, original->stateAt(end)->covariance);
}

TEST_P(AnyEstimator, AllocatesNothingPerSightingAfterWarmUp) {
  if (!SIGHTLINE_COUNTS_ALLOCATIONS) GTEST_SKIP() << "allocations cannot be counted here";
  const auto sightings = test::sightingsOf(test::sinusoid, coupled(0.02), 10, 30.0);
  const auto estimator = make();
  std::size_t i = 0;
  for (; i < 300; ++i) estimator->update(sightings[i]);
  const long before = allocations;
  double sum = 0.0;
  for (; i < sightings.size(); ++i) {
    sum += estimator->stateAt(sightings[i].time)->mean(0);
    estimator->update(sightings[i]);
  }
  EXPECT_EQ(allocations - before, 0);
  EXPECT_TRUE(std::isfinite(sum));
  const auto clone = estimator->clone();
  EXPECT_GT(allocations - before, 0) << "the counter does not count";
}

TEST_P(AccurateEstimator, IsBetterThanTheSightingsOnAStraightLine) {
  const auto figures = test::benchmark(slow, kSigma, 10, GetParam().make);
  EXPECT_LT(figures.estimate, 0.85);
}

TEST_P(HonestEstimator, HasInnovationsOfTheSizeItExpectsOnAStraightLine) {
  const auto figures = test::benchmark(slow, kSigma, 10, GetParam().make);
  EXPECT_GT(figures.innovation, 0.6);
  EXPECT_LT(figures.innovation, 1.2);
}

}  // namespace
}  // namespace sightline::core
