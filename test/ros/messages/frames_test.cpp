#include "sightline/ros/messages/frames.h"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"
#include "sightline/ros/messages/conversions.h"

#include "support/times.h"

namespace {

namespace core = sightline::core;
using sightline::test::at;
using sightline_ros::FrameChange;
using sightline_ros::FrameChangeParams;
using sightline_ros::toCore;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

sightline::Sighting sighting(double azimuth, double elevation, double sigma = 1e-3) {
  sightline::Sighting sighting;
  sighting.azimuth = azimuth;
  sighting.elevation = elevation;
  sighting.covariance = {sigma * sigma, 0.0, 0.0, sigma * sigma};
  sighting.snr = kNaN;
  return sighting;
}

sightline::SightingArray scanAt(double stamp, const std::string& frame, const std::string& sensor = "eye") {
  sightline::SightingArray scan;
  scan.header.stamp = ros::Time(stamp);
  scan.header.frame_id = frame;
  scan.sensor = sensor;
  scan.ifov = 1e-3;
  scan.detection_probability = kNaN;
  scan.clutter_density = kNaN;
  scan.sightings = {sighting(0.1, 0.2)};
  return scan;
}

sightline::SightingArray::ConstPtr shared(const sightline::SightingArray& scan) {
  return boost::make_shared<sightline::SightingArray>(scan);
}

/// Transform that turns the sensor by `yaw` about z of the tracking frame.
void setYaw(tf2::BufferCore& buffer, double stamp, const std::string& frame, double yaw,
            bool is_static = false) {
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = ros::Time(stamp);
  transform.header.frame_id = "platform_enu";
  transform.child_frame_id = frame;
  transform.transform.translation.x = 123.0;  // directions have no origin
  transform.transform.rotation.z = std::sin(yaw / 2.0);
  transform.transform.rotation.w = std::cos(yaw / 2.0);
  buffer.setTransform(transform, "test", is_static);
}

class Frames : public testing::Test {
 protected:
  FrameChange& frames() {
    if (!frames_) frames_ = std::make_unique<FrameChange>(params_, buffer_);
    return *frames_;
  }

  /// The only result of a scan that is added and released at its own stamp.
  sightline_ros::FramedScan resultOf(const sightline::SightingArray& scan) {
    frames().add(shared(scan), toCore(scan.header.stamp));
    const auto released = frames().release(toCore(scan.header.stamp));
    EXPECT_EQ(released.size(), 1u);
    return released.empty() ? sightline_ros::FramedScan{} : released.front();
  }

  FrameChangeParams params_;
  tf2::BufferCore buffer_;
  std::unique_ptr<FrameChange> frames_;
};

TEST_F(Frames, ScanInTheTrackingFrameNeedsNoTransform) {
  const auto framed = resultOf(scanAt(10.0, "platform_enu"));
  EXPECT_FALSE(framed.refusal);
  ASSERT_EQ(framed.scan.sightings.size(), 1u);
  EXPECT_NEAR(core::anglesOf(framed.scan.sightings[0].direction).x(), 0.1, 1e-12);
  EXPECT_EQ(framed.scan.sensor, "eye");
  EXPECT_EQ(framed.scan.time, at(10.0));
  EXPECT_EQ(framed.scan.ifov, 1e-3);
  EXPECT_TRUE(std::isnan(framed.scan.clutter_density));
}

TEST_F(Frames, DirectionsAreTurnedByTheTransformAtTheStampOfExposure) {
  setYaw(buffer_, 10.0, "eye_frame", 0.0);
  setYaw(buffer_, 11.0, "eye_frame", 1.0);
  const auto framed = resultOf(scanAt(10.25, "eye_frame"));
  ASSERT_FALSE(framed.refusal);
  const auto angles = core::anglesOf(framed.scan.sightings[0].direction);
  EXPECT_NEAR(angles.x(), 0.1 + 0.25, 1e-9);
  EXPECT_NEAR(angles.y(), 0.2, 1e-9);
}

TEST_F(Frames, CovarianceTurnsWithTheDirection) {
  // A quarter turn about x swaps the channels of a sighting dead ahead.
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = ros::Time(1.0);
  transform.header.frame_id = "platform_enu";
  transform.child_frame_id = "rolled";
  transform.transform.rotation.x = std::sqrt(0.5);
  transform.transform.rotation.w = std::sqrt(0.5);
  buffer_.setTransform(transform, "test", true);
  auto scan = scanAt(10.0, "rolled");
  scan.sightings[0] = sighting(0.0, 0.0);
  scan.sightings[0].covariance = {4e-6, 0.0, 0.0, 1e-6};
  const auto covariance = core::anglesCovariance(resultOf(scan).scan.sightings.at(0));
  EXPECT_NEAR(covariance(0, 0), 1e-6, 1e-12);
  EXPECT_NEAR(covariance(1, 1), 4e-6, 1e-12);
}

/// 200 deg/s, in transforms a tenth of a second apart.
TEST_F(Frames, FastTurnIsExactBetweenTransformsAtTenHertz) {
  constexpr double kRate = 200.0 * 3.14159265358979323846 / 180.0;  // [rad/s]
  for (int i = 0; i <= 20; ++i) setYaw(buffer_, 10.0 + 0.1 * i, "eye_frame", kRate * 0.1 * i);
  for (const double time : {0.013, 0.05, 0.58, 0.9999, 1.777}) {
    const auto framed = resultOf(scanAt(10.0 + time, "eye_frame"));
    ASSERT_FALSE(framed.refusal);
    const auto seen = framed.scan.sightings[0].direction;
    EXPECT_LT((seen - core::directionOf({0.1 + kRate * time, 0.2})).norm(), 1e-8) << time;
  }
}

/// The error of interpolation: half the turn's acceleration times what is left and right of the stamp.
TEST_F(Frames, TurnThatChangesLosesNoMoreThanItsAccelerationInterpolated) {
  constexpr double kAmplitude = 1.0, kFrequency = 3.5;  // [rad], [rad/s]: up to 200 deg/s
  const auto yaw = [](double time) { return kAmplitude * std::sin(kFrequency * time); };
  const double bound = kAmplitude * kFrequency * kFrequency * 0.1 * 0.1 / 8.0;
  for (int i = 0; i <= 20; ++i) setYaw(buffer_, 10.0 + 0.1 * i, "eye_frame", yaw(0.1 * i));
  double worst = 0.0;
  for (double time = 0.05; time < 2.0; time += 0.1) {
    const auto seen = resultOf(scanAt(10.0 + time, "eye_frame")).scan.sightings.at(0).direction;
    worst = std::max(worst, std::abs(core::wrapAngle(core::anglesOf(seen).x() - 0.1 - yaw(time))));
  }
  EXPECT_LT(worst, 1.01 * bound);
  EXPECT_GT(worst, 0.9 * bound) << "the bound is what is lost where the turn changes most";
}

TEST_F(Frames, ExtrapolationIsRefusedWithItsRemedy) {
  setYaw(buffer_, 10.0, "eye_frame", 0.0);
  setYaw(buffer_, 10.1, "eye_frame", 0.0);
  for (const double time : {9.99, 10.11}) {
    const auto scan = scanAt(time, "eye_frame");
    frames().add(shared(scan), at(time));
    const auto released = frames().release(at(time + params_.tf_timeout));
    ASSERT_EQ(released.size(), 1u);
    EXPECT_EQ(released[0].refusal.value().kind, "no transform");
    EXPECT_NE(released[0].refusal.value().detail.find("never extrapolated"), std::string::npos)
        << released[0].refusal.value().detail;
  }
}

TEST_F(Frames, AttitudeThatIsUncertainWidensTheSightingsThatAreTurned) {
  params_.attitude.sigma = {0.0, 2e-3, 3e-3};
  setYaw(buffer_, 0.0, "eye_frame", 1.0, true);
  auto scan = scanAt(10.0, "eye_frame");
  scan.sightings[0] = sighting(0.0, 0.0);
  const auto covariance = core::anglesCovariance(resultOf(scan).scan.sightings.at(0));
  EXPECT_NEAR(covariance(0, 0), 1e-6 + 9e-6, 1e-12);
  EXPECT_NEAR(covariance(1, 1), 1e-6 + 4e-6, 1e-12);
  scan.header.frame_id = "platform_enu";
  EXPECT_NEAR(core::anglesCovariance(resultOf(scan).scan.sightings.at(0))(0, 0), 1e-6, 1e-12)
      << "a scan in the tracking frame has no attitude";
}

TEST_F(Frames, TimeOfATransformThatIsUncertainCountsByTheTurn) {
  params_.attitude.time_sigma = 2e-3;
  setYaw(buffer_, 10.0, "eye_frame", 0.0);
  setYaw(buffer_, 10.5, "eye_frame", 1.5);  // 3 rad/s
  setYaw(buffer_, 11.0, "eye_frame", 1.5);  // and at rest
  const auto azimuthVariance = [&](double time) {
    return core::anglesCovariance(resultOf(scanAt(time, "eye_frame")).scan.sightings.at(0))(0, 0);
  };
  EXPECT_NEAR(azimuthVariance(10.3), 1e-6 + std::pow(2e-3 * 3.0, 2), 1e-9);
  EXPECT_NEAR(azimuthVariance(10.0), 1e-6 + std::pow(2e-3 * 3.0, 2), 1e-9) << "at the first transform";
  EXPECT_NEAR(azimuthVariance(10.8), 1e-6, 1e-9);
}

TEST_F(Frames, FieldOfViewTurnsWithTheScanAtItsStamp) {
  params_.fields_of_view["eye"] = {0.3, 0.2};
  setYaw(buffer_, 10.0, "eye_frame", 0.0);
  setYaw(buffer_, 11.0, "eye_frame", 1.0);
  const auto framed = resultOf(scanAt(10.75, "eye_frame"));
  ASSERT_TRUE(framed.scan.view);
  EXPECT_TRUE(framed.scan.view->holds(core::directionOf({0.75 + 0.29, 0.19})));
  EXPECT_FALSE(framed.scan.view->holds(core::directionOf({0.75 + 0.31, 0.0})));
  EXPECT_FALSE(framed.scan.view->holds(core::directionOf({0.75 - 0.31, 0.0})));
  EXPECT_FALSE(framed.scan.view->holds(core::directionOf({0.75, 0.21})));
}

TEST_F(Frames, FieldOfViewOfAScanInTheTrackingFrameIsNotTurned) {
  params_.fields_of_view["eye"] = {0.3, 0.2};
  const auto framed = resultOf(scanAt(10.0, "platform_enu"));
  ASSERT_TRUE(framed.scan.view);
  EXPECT_TRUE(framed.scan.view->R_sensor_tracking.isIdentity(0.0));
  EXPECT_EQ(framed.scan.view->half_widths, Eigen::Vector2d(0.3, 0.2));
}

TEST_F(Frames, EmptyScanHasItsFieldOfViewToo) {
  params_.fields_of_view["eye"] = {0.3, 0.2};
  auto scan = scanAt(10.0, "platform_enu");
  scan.sightings.clear();
  EXPECT_TRUE(resultOf(scan).scan.view);
}

TEST_F(Frames, FieldOfViewIsNotKnownUnlessItIsGivenForThatSensor) {
  params_.fields_of_view["other_eye"] = {0.3, 0.2};
  EXPECT_FALSE(resultOf(scanAt(10.0, "platform_enu")).scan.view);
}

TEST_F(Frames, ScanWaitsForItsTransformAndGoesOnAsSoonAsItIsThere) {
  params_.tf_timeout = 1.0;
  frames().add(shared(scanAt(10.0, "eye_frame")), at(10.0));
  EXPECT_TRUE(frames().release(at(10.1)).empty());
  EXPECT_EQ(frames().waiting(), 1u);
  setYaw(buffer_, 9.0, "eye_frame", 0.0);
  EXPECT_TRUE(frames().release(at(10.2)).empty()) << "extrapolation is no knowledge";
  setYaw(buffer_, 10.5, "eye_frame", 0.0);
  const auto released = frames().release(at(10.2));
  ASSERT_EQ(released.size(), 1u);
  EXPECT_FALSE(released[0].refusal);
  EXPECT_EQ(frames().waiting(), 0u);
}

TEST_F(Frames, ScanIsDroppedWithItsReasonAfterTheTimeout) {
  params_.tf_timeout = 0.5;
  frames().add(shared(scanAt(10.0, "nowhere")), at(100.0));
  EXPECT_TRUE(frames().release(at(100.4)).empty());
  const auto released = frames().release(at(100.5));
  ASSERT_EQ(released.size(), 1u);
  EXPECT_EQ(released[0].refusal.value().kind, "no transform");
  EXPECT_NE(released[0].refusal.value().detail.find("nowhere"), std::string::npos);
  EXPECT_NE(released[0].refusal.value().detail.find("tf_timeout 0.5 s"), std::string::npos);
  EXPECT_EQ(released[0].scan.sensor, "eye");
}

TEST_F(Frames, ScansOfOneFrameKeepTheirOrderAndDoNotHoldUpOtherFrames) {
  setYaw(buffer_, 0.0, "fixed", 0.0, true);
  frames().add(shared(scanAt(10.0, "late", "a")), at(10.0));
  frames().add(shared(scanAt(10.1, "fixed", "b")), at(10.1));
  frames().add(shared(scanAt(10.2, "late", "c")), at(10.2));
  auto released = frames().release(at(10.2));
  ASSERT_EQ(released.size(), 1u);
  EXPECT_EQ(released[0].scan.sensor, "b");
  setYaw(buffer_, 0.0, "late", 0.0, true);
  frames().add(shared(scanAt(10.3, "late", "d")), at(10.3));
  released = frames().release(at(10.3));
  ASSERT_EQ(released.size(), 3u);
  EXPECT_EQ(released[0].scan.sensor, "a");
  EXPECT_EQ(released[1].scan.sensor, "c");
  EXPECT_EQ(released[2].scan.sensor, "d");
}

TEST_F(Frames, WaitingIsBoundedInNumberAndTheOldestMakesRoom) {
  params_.max_waiting = 2;
  for (const char* sensor : {"a", "b", "c"}) frames().add(shared(scanAt(10.0, "nowhere", sensor)), at(10.0));
  const auto released = frames().release(at(10.0));
  ASSERT_EQ(released.size(), 1u);
  EXPECT_EQ(released[0].scan.sensor, "a");
  EXPECT_EQ(released[0].refusal.value().kind, "too many waiting");
  EXPECT_EQ(frames().waiting(), 2u);
}

TEST_F(Frames, ClockThatGoesBackDoesNotKeepScansWaitingForEver) {
  params_.tf_timeout = 0.5;
  frames().add(shared(scanAt(10.0, "nowhere")), at(1000.0));
  EXPECT_TRUE(frames().release(at(10.0)).empty());
  EXPECT_EQ(frames().release(at(10.5)).size(), 1u);
}

TEST_F(Frames, BadSightingIsRejectedWithItsReasonAndTheOthersAreKept) {
  auto scan = scanAt(10.0, "platform_enu");
  scan.sightings = {sighting(0.1, 0.2), sighting(kNaN, 0.0), sighting(0.3, 0.2), sighting(0.0, 0.0, 0.0)};
  const auto framed = resultOf(scan);
  EXPECT_FALSE(framed.refusal);
  EXPECT_EQ(framed.scan.sightings.size(), 4u);
  ASSERT_EQ(framed.rejections.size(), 2u);
  EXPECT_EQ(framed.rejections[0].first, 1u);
  EXPECT_NE(framed.rejections[0].second.find("not finite"), std::string::npos);
  EXPECT_EQ(framed.rejections[1].first, 3u);
  EXPECT_TRUE(framed.scan.sightings[1].covariance.hasNaN());
  EXPECT_NEAR(core::anglesOf(framed.scan.sightings[2].direction).x(), 0.3, 1e-12);
}

TEST_F(Frames, EmptyScanIsGoodButOneWithBadSightingsOnlySaysNothing) {
  auto scan = scanAt(10.0, "platform_enu");
  scan.sightings.clear();
  EXPECT_FALSE(resultOf(scan).refusal);
  scan.sightings = {sighting(kNaN, 0.0)};
  const auto framed = resultOf(scan);
  EXPECT_EQ(framed.refusal.value().kind, "no usable sighting");
  EXPECT_EQ(framed.rejections.size(), 1u);
}

TEST_F(Frames, ScanFromTheFutureIsRefusedButOnlyWhereThereIsAClock) {
  params_.max_future = 0.1;
  const auto scan = shared(scanAt(10.0, "platform_enu"));
  frames().add(scan, at(9.8));
  EXPECT_EQ(frames().release(at(9.8)).at(0).refusal.value().kind, "from the future");
  frames().add(scan, at(9.95));
  EXPECT_FALSE(frames().release(at(9.95)).at(0).refusal);
  frames().add(scan, at(0.0));
  EXPECT_FALSE(frames().release(at(0.0)).at(0).refusal);
}

TEST_F(Frames, BadHeadersAreRefusedByNameOfTheField) {
  const auto refused = [](const std::function<void(sightline::SightingArray&)>& spoil) {
    auto scan = scanAt(10.0, "platform_enu");
    spoil(scan);
    const auto refusal = sightline_ros::refusalOf(scan);
    return refusal ? refusal->detail : "";
  };
  EXPECT_NE(refused([](auto& scan) { scan.header.stamp = ros::Time(); }).find("header.stamp"),
            std::string::npos);
  EXPECT_NE(refused([](auto& scan) { scan.header.frame_id = ""; }).find("frame_id"), std::string::npos);
  EXPECT_NE(refused([](auto& scan) { scan.header.frame_id = "/a"; }).find("slash"), std::string::npos);
  EXPECT_NE(refused([](auto& scan) { scan.sensor = ""; }).find("sensor"), std::string::npos);
  for (double bad : {0.0, -1.0, HUGE_VAL}) {
    EXPECT_NE(refused([bad](auto& scan) { scan.ifov = bad; }).find("ifov"), std::string::npos) << bad;
  }
  for (double bad : {0.0, -0.1, 1.1}) {
    EXPECT_NE(refused([bad](auto& scan) { scan.detection_probability = bad; }), "") << bad;
  }
  for (double bad : {-1.0, HUGE_VAL}) {
    EXPECT_NE(refused([bad](auto& scan) { scan.clutter_density = bad; }), "") << bad;
  }
  EXPECT_EQ(refused([](auto& scan) { scan.ifov = kNaN; }), "");
  EXPECT_EQ(refused([](auto& scan) { scan.detection_probability = 1.0; }), "");
  EXPECT_EQ(refused([](auto& scan) { scan.clutter_density = 0.0; }), "");
}

}  // namespace
