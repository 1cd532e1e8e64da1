#include "sightline/core/sensors/noise_calibration.h"

#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "sightline/core/tracking/local_tracker.h"

namespace sightline::core {
namespace {

constexpr double kSigma = 1e-3;  // stated [rad]

TEST(NoiseCalibration, TrustsASensorItDoesNotKnow) {
  EXPECT_EQ(NoiseCalibration(NoiseCalibrationParams{}).scale("camera"), 1.0);
}

TEST(NoiseCalibration, SuspectsAndThenFindsThatTheStatedNoiseIsFarTooSmall) {
  NoiseCalibration calibration(NoiseCalibrationParams{});
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal(0.0, 1e-3);
  bool is_found = false;
  for (int k = 0; !is_found && k < 20; ++k) {
    EXPECT_EQ(calibration.suspectedScale("camera") > 100.0, k >= 3) << k;
    EXPECT_EQ(calibration.scale("camera"), 1.0) << k;
    Scan scan;
    scan.sensor = "camera";
    scan.time = Time(durationOf(0.1 * k));
    scan.sightings.push_back(
        sightingOf({normal(random), normal(random)}, 1e-12 * Eigen::Matrix2d::Identity()));
    is_found = calibration.takeUntracked(scan);
  }
  ASSERT_TRUE(is_found);
  EXPECT_GT(calibration.scale("camera"), 1e5);
  EXPECT_EQ(calibration.suspectedScale("camera"), calibration.scale("camera"));
  EXPECT_EQ(calibration.suspectedScale("another"), 1.0);
}

TEST(NoiseCalibration, FindsTheScaleOfEachSensor) {
  NoiseCalibration calibration(NoiseCalibrationParams{});
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const auto sight = [&](const std::string& sensor, double truth) {
    const double P = 0.3;  // of the prediction, in stated variances
    const Eigen::Vector2d innovation = std::sqrt(P + truth) * Eigen::Vector2d(normal(random), normal(random));
    const double expected = P + calibration.scale(sensor);
    calibration.take(sensor, innovation.cwiseAbs2(), Eigen::Vector2d::Constant(expected),
                     Eigen::Vector2d::Ones());
  };
  for (int i = 0; i < 3000; ++i) {
    sight("calm", 0.04);
    sight("honest", 1.0);
    sight("rough", 6.0);
  }
  // 300 sightings of two channels count: 6 % of chance each, and what P adds for the calm one.
  EXPECT_NEAR(calibration.scale("calm"), 0.04, 0.06);
  EXPECT_NEAR(calibration.scale("honest"), 1.0, 0.25);
  EXPECT_NEAR(calibration.scale("rough"), 6.0, 1.3);
  ASSERT_EQ(calibration.sensors().size(), 3U);
  EXPECT_EQ(calibration.sensors()[0].sensor, "calm");
}

TEST(NoiseCalibration, RefusesParametersOutOfRange) {
  NoiseCalibrationParams params;
  params.settled = 1.0;
  EXPECT_THROW(NoiseCalibration{params}, std::invalid_argument);
  params = {};
  params.trust = 0.0;
  EXPECT_THROW(NoiseCalibration{params}, std::invalid_argument);
}

/// Follows a straight target for `duration` [s] with sensors of 30 Hz whose true sigma is `truth` of the
/// stated one; each in turn.
Track followed(LocalTracker& tracker, const std::vector<double>& truth, double duration,
               double slow_error = 0.0) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  Track last;
  for (int k = 0; k < static_cast<int>(30.0 * duration); ++k) {
    for (std::size_t s = 0; s < truth.size(); ++s) {
      const double t = k / 30.0 + 0.005 * static_cast<double>(s);
      Scan scan;
      scan.time = Time(durationOf(100.0 + t));
      scan.sensor = "sensor_" + std::to_string(s);
      const Eigen::Vector2d noise = truth[s] * kSigma * Eigen::Vector2d(normal(random), normal(random));
      const Eigen::Vector2d position(0.01 * t + slow_error, 0.1 - 0.005 * t + slow_error);
      scan.sightings = {sightingOf(position + noise, Eigen::Matrix2d::Identity() * kSigma * kSigma)};
      const ScanReport report = tracker.onScan(scan);
      if (!report.tracks.empty()) last = report.tracks.front();
    }
  }
  return last;
}

TEST(NoiseCalibration, ATrackerTellsItsSensorsApart) {
  LocalTracker tracker{LocalTrackerParams{}};
  followed(tracker, {0.2, 1.0}, 60.0);
  const auto& sensors = tracker.calibratedSensors();
  ASSERT_EQ(sensors.size(), 2U);
  EXPECT_NEAR(std::sqrt(sensors[0].scale), 0.2, 0.1);
  EXPECT_NEAR(std::sqrt(sensors[1].scale), 1.0, 0.25);
}

TEST(NoiseCalibration, ASensorThatIsRougherThanItSaysIsFoundWithoutOthersToo) {
  // Beside others the guard would take it for one whose noise has grown.
  LocalTracker tracker{LocalTrackerParams{}};
  followed(tracker, {2.0}, 60.0);
  ASSERT_EQ(tracker.calibratedSensors().size(), 1U);
  EXPECT_NEAR(std::sqrt(tracker.calibratedSensors()[0].scale), 2.0, 0.5);
}

TEST(NoiseCalibration, AnHonestSensorLeavesTheReportedCovarianceFreeOfAnySlowError) {
  LocalTracker tracker{LocalTrackerParams{}};
  const Track track = followed(tracker, {1.0}, 30.0);
  EXPECT_LT(std::sqrt(track.state.covariance(0, 0)), 0.5 * kSigma);
}

TEST(NoiseCalibration, ACalmSensorIsReportedAsAccurateAsItSays) {
  // White noise of a tenth of the stated sigma and an error that does not change: what is published covers
  // it.
  LocalTracker tracker{LocalTrackerParams{}};
  const Track track = followed(tracker, {0.1}, 30.0, 0.9 * kSigma);
  EXPECT_NEAR(std::sqrt(track.state.covariance(0, 0)), kSigma, 0.1 * kSigma);
  EXPECT_LT(std::sqrt(track.state.covariance(2, 2)), kSigma);  // rates do not suffer from it
}

}  // namespace
}  // namespace sightline::core
