#include "sightline/core/smoothing/track_smoother.h"

#include <cmath>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "sightline/core/estimators/charted_estimator.h"

namespace sightline::core {
namespace {

constexpr double kSigma = 1e-3;  // [rad]

/// A target on a great circle that passes `closest` [rad] from the zenith, at 0.3 rad/s.
Eigen::Vector3d direction(double t, double closest) {
  const double angle = 0.3 * (t - 5.0);
  return Eigen::Vector3d(std::sin(angle), std::sin(closest) * std::cos(angle),
                         std::cos(closest) * std::cos(angle));
}

std::vector<TakenSighting> sightingsOf(double closest, double sigma, double stated, unsigned seed,
                                       const std::string& sensor = "sensor") {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<TakenSighting> sightings;
  for (double t = 0.0; t < 10.0; t += 0.04) {
    const Eigen::Vector3d truth = direction(t, closest);
    Eigen::Vector3d noise;
    for (int i = 0; i < 3; ++i) noise(i) = sigma * normal(random);
    TakenSighting sighting;
    sighting.tracklet.time = Time(durationOf(t));
    sighting.tracklet.sensor = sensor;
    Sighting& seen = sighting.tracklet.sighting;
    seen.direction = (truth + noise).normalized();
    seen.covariance =
        stated * stated * (Eigen::Matrix3d::Identity() - seen.direction * seen.direction.transpose());
    sightings.push_back(sighting);
  }
  return sightings;
}

std::vector<Time> timesOf(const std::vector<TakenSighting>& sightings) {
  std::vector<Time> times;
  for (const TakenSighting& sighting : sightings) times.push_back(sighting.tracklet.time);
  return times;
}

EstimatorParams paramsOf(EstimatorKind kind) {
  EstimatorParams params;
  params.kind = kind;
  return params;
}

class EveryEstimator : public testing::TestWithParam<EstimatorKind> {};

// Near the zenith charts tilt and turn, and azimuth goes through half a turn.
TEST_P(EveryEstimator, IsSmoothedOverTheZenithAndIsNearerThanItsFilter) {
  for (const double closest : {0.02, 0.6}) {
    const auto sightings = sightingsOf(closest, kSigma, kSigma, 1);
    const auto states = TrackSmoother(paramsOf(GetParam())).smooth(sightings, timesOf(sightings));
    ChartedEstimator filter(makeEstimator(paramsOf(GetParam())), sightings[0].tracklet);
    double of_filter = 0.0, of_smoother = 0.0;
    for (std::size_t i = 1; i < sightings.size(); ++i) {
      filter.update(sightings[i].tracklet);
      const double t = seconds(sightings[i].tracklet.time.time_since_epoch());
      ASSERT_TRUE(states[i]);
      ASSERT_TRUE(states[i]->mean.allFinite());
      ASSERT_EQ(Eigen::LLT<Eigen::Matrix4d>(states[i]->covariance).info(), Eigen::Success) << t;
      if (t < 1.0) continue;
      const Eigen::Vector3d truth = direction(t, closest);
      of_filter +=
          std::pow(angleBetween(truth, directionOf(filter.stateAt(sightings[i].tracklet.time).angles())), 2);
      of_smoother += std::pow(angleBetween(truth, directionOf(states[i]->angles())), 2);
    }
    EXPECT_LT(std::sqrt(of_smoother / of_filter), 0.72) << closest;
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryEstimator,
                         testing::Values(EstimatorKind::twbls, EstimatorKind::noga, EstimatorKind::kalman,
                                         EstimatorKind::imm),
                         [](const auto& info) { return estimatorName(info.param); });

TEST(TrackSmoother, SlowErrorOfACalmSensorStaysInTheCovariance) {
  const auto calm = sightingsOf(0.6, 0.2 * kSigma, kSigma, 2);
  const TrackSmoother smoother{EstimatorParams()};
  const auto states = smoother.smooth(calm, timesOf(calm));
  // The noise is a fifth of what is stated, the rest cannot be averaged out.
  EXPECT_GT(std::sqrt(states[125]->covariance(1, 1)), 0.9 * kSigma);
  const auto honest = sightingsOf(0.6, kSigma, kSigma, 2);
  EXPECT_LT(std::sqrt(smoother.smooth(honest, timesOf(honest))[125]->covariance(1, 1)), 0.5 * kSigma);
}

TEST(TrackSmoother, TwoRunsGiveTheSameBits) {
  const auto sightings = sightingsOf(0.02, kSigma, kSigma, 3);
  const TrackSmoother smoother{EstimatorParams()};
  const auto one = smoother.smooth(sightings, timesOf(sightings), 1.0);
  const auto two = smoother.smooth(sightings, timesOf(sightings), 1.0);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_TRUE(one[i]->mean == two[i]->mean);
    EXPECT_TRUE(one[i]->covariance == two[i]->covariance);
  }
}

TEST(TrackSmoother, WithoutSightingsThereIsNothing) {
  EXPECT_FALSE(TrackSmoother{EstimatorParams()}.smooth({}, {Time(durationOf(1.0))})[0]);
}

}  // namespace
}  // namespace sightline::core
