#include "sightline/core/model/track_prediction.h"

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

TrackPrediction predictionAt(const Eigen::Vector2d& angles) {
  TrackPrediction prediction;
  prediction.chart = Chart::around(directionOf(angles));
  return prediction;
}

Sighting sightingAt(const Eigen::Vector2d& angles, double sigma) {
  return sightingOf(angles, Eigen::Matrix2d::Identity() * sigma * sigma);
}

TEST(TrackPrediction, TheNoiseOfASightingIsScaledPerChannelAndGrownByTheStampError) {
  TrackPrediction prediction = predictionAt({0.0, 0.0});
  prediction.noise_scale = {4.0, 0.25};
  prediction.stamp_covariance << 1e-6, 5e-7, 5e-7, 2e-6;
  const Eigen::Matrix2d noise = prediction.noiseOf(sightingAt({0.0, 0.0}, 1e-3));
  EXPECT_NEAR(noise(0, 0), 4e-6 + 1e-6, 1e-12);
  EXPECT_NEAR(noise(1, 1), 0.25e-6 + 2e-6, 1e-12);
  EXPECT_NEAR(noise(0, 1), 5e-7, 1e-12);
}

TEST(TrackPrediction, WithNothingLearntTheNoiseIsTheStatedOneInTheChart) {
  const TrackPrediction prediction = predictionAt({0.3, 0.2});
  const Sighting sighting = sightingAt({0.3, 0.2}, 2e-3);
  EXPECT_TRUE(prediction.noiseOf(sighting).isApprox(prediction.chart.covarianceOf(sighting), 1e-12));
}

}  // namespace
}  // namespace sightline::core
