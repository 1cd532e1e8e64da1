#include "sightline/core/smoothing/fixed_lag_smoother.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "sightline/core/smoothing/smoothing_bank.h"

namespace sightline::core {
namespace {

constexpr double kSigma = 1e-3;  // [rad]

Time timeOf(double t) {
  return Time(durationOf(t));
}

/// A target on a great circle 0.3 rad beside the zenith, at 0.3 rad/s, so that charts change on the way.
std::vector<TakenSighting> sightingsOf(unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<TakenSighting> sightings;
  for (int i = 0; i < 250; ++i) {
    const double angle = 0.3 * (0.04 * i - 5.0);
    Eigen::Vector3d noise;
    for (int k = 0; k < 3; ++k) noise(k) = kSigma * normal(random);
    TakenSighting sighting;
    sighting.tracklet.time = timeOf(0.04 * i);
    sighting.tracklet.sensor = "sensor";
    Sighting& seen = sighting.tracklet.sighting;
    seen.direction =
        (Eigen::Vector3d(std::sin(angle), std::sin(0.3) * std::cos(angle), std::cos(0.3) * std::cos(angle)) +
         noise)
            .normalized();
    seen.covariance =
        kSigma * kSigma * (Eigen::Matrix3d::Identity() - seen.direction * seen.direction.transpose());
    sightings.push_back(sighting);
  }
  return sightings;
}

using States = std::vector<std::optional<AngularState>>;

void append(States& all, const States& more) {
  all.insert(all.end(), more.begin(), more.end());
}

TEST(FixedLagSmoother, BatchesAreToTheLastBitWhatTheSmootherSaysByTheSameSightings) {
  const auto sightings = sightingsOf(1);
  const TrackSmoother smoother{EstimatorParams{}};
  FixedLagSmoother live(smoothingBankOf({}));
  std::size_t taken = 0;
  for (int batch = 0; batch < 20; ++batch) {
    std::vector<Time> times;
    for (int i = 0; i < 10; ++i) times.push_back(timeOf(0.02 + 0.04 * (10 * batch + i)));
    const Time end = times.back();
    while (taken < sightings.size() && sightings[taken].tracklet.time <= end + durationOf(0.4))
      EXPECT_TRUE(live.take(sightings[taken++]));
    const States states = live.answer(times, end);
    const auto known = sightings.begin() + static_cast<std::ptrdiff_t>(taken);
    const States expected = smoother.smooth({sightings.begin(), known}, times);
    for (std::size_t i = 0; i < times.size(); ++i) {
      ASSERT_TRUE(states[i] && expected[i]) << batch << " " << i;
      EXPECT_EQ(states[i]->mean, expected[i]->mean) << batch << " " << i;
      EXPECT_EQ(states[i]->covariance, expected[i]->covariance) << batch << " " << i;
    }
  }
}

TEST(FixedLagSmoother, TheOrderOfArrivalWithinTheLagDoesNotCount) {
  const auto sightings = sightingsOf(2);
  auto shuffled = sightings;
  for (std::size_t i = 0; i + 5 <= shuffled.size(); i += 5)
    std::reverse(shuffled.begin() + static_cast<std::ptrdiff_t>(i),
                 shuffled.begin() + static_cast<std::ptrdiff_t>(i + 5));
  States in_order, out_of_order;
  for (auto* states : {&in_order, &out_of_order}) {
    const auto& stream = states == &in_order ? sightings : shuffled;
    FixedLagSmoother live(smoothingBankOf({}));
    for (std::size_t i = 0; i < stream.size(); ++i) {
      ASSERT_TRUE(live.take(stream[i])) << i;
      if (i % 25 != 24 || i < 50) continue;
      const Time end = timeOf(0.04 * (static_cast<double>(i) - 20.0));
      append(*states, live.answer({end - durationOf(0.3), end}, end));
    }
  }
  ASSERT_EQ(in_order.size(), out_of_order.size());
  for (std::size_t i = 0; i < in_order.size(); ++i) EXPECT_EQ(in_order[i]->mean, out_of_order[i]->mean) << i;
}

TEST(FixedLagSmoother, WhatComesAfterTheAnswerIsToldAndNotUsed) {
  const auto sightings = sightingsOf(3);
  FixedLagSmoother live(smoothingBankOf({})), other(smoothingBankOf({}));
  for (int i = 0; i < 100; ++i) {
    const auto& sighting = sightings[static_cast<std::size_t>(i)];
    other.take(sighting);
    if (i != 40) live.take(sighting);
  }
  const Time end = sightings[50].tracklet.time;
  live.answer({end}, end);
  EXPECT_FALSE(live.take(sightings[40]));
  EXPECT_FALSE(live.take(sightings[50]));
  EXPECT_FALSE(other.answer({}, end).size() > 0);
}

TEST(FixedLagSmoother, WithoutSightingsThereIsNoStateAndLongSilenceIsBridged) {
  const auto sightings = sightingsOf(4);
  FixedLagSmoother live(smoothingBankOf({}));
  EXPECT_FALSE(live.answer({timeOf(-2.0)}, timeOf(-1.0))[0]);
  for (int i = 0; i < 100; ++i) live.take(sightings[static_cast<std::size_t>(i)]);
  EXPECT_TRUE(live.answer({timeOf(3.9)}, timeOf(3.99))[0]);
  const auto coasting = live.answer({timeOf(4.2)}, timeOf(4.2))[0];
  ASSERT_TRUE(coasting);
  const auto before =
      TrackSmoother{EstimatorParams{}}.smooth({sightings.begin(), sightings.begin() + 100}, {timeOf(4.2)})[0];
  EXPECT_EQ(coasting->mean, before->mean);
}

}  // namespace
}  // namespace sightline::core
