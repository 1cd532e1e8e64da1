#include "sightline/core/model/sighting.h"

#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

const Eigen::Matrix2d kCovariance = (Eigen::Matrix2d() << 4e-6, 1e-6, 1e-6, 2e-6).finished();

TEST(Sighting, AnglesAndCovarianceComeBackAsTheyWentIn) {
  const Sighting sighting = sightingOf({2.5, 0.7}, kCovariance, 12.0);
  EXPECT_LT((anglesOf(sighting.direction) - Eigen::Vector2d(2.5, 0.7)).norm(), 1e-14);
  EXPECT_TRUE(anglesCovariance(sighting).isApprox(kCovariance, 1e-12));
  EXPECT_EQ(sighting.snr, 12.0);
}

TEST(Sighting, CovarianceLiesInTheTangentPlane) {
  const Sighting sighting = sightingOf({-1.0, 0.4}, kCovariance);
  EXPECT_LT((sighting.covariance * sighting.direction).norm(), 1e-18);
}

TEST(Sighting, TurningAboutTheVerticalOnlyMovesTheAzimuth) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Sighting turned = rotate(sightingOf({0.2, 0.7}, kCovariance), R);
  EXPECT_LT((anglesOf(turned.direction) - Eigen::Vector2d(1.2, 0.7)).norm(), 1e-14);
  EXPECT_TRUE(anglesCovariance(turned).isApprox(kCovariance, 1e-10));
}

TEST(Sighting, ARolledSensorSwapsItsVariances) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitX()).toRotationMatrix();
  const Sighting turned = rotate(sightingOf({0.0, 0.0}, Eigen::Vector2d(4e-6, 1e-6).asDiagonal()), R);
  EXPECT_TRUE(
      anglesCovariance(turned).isApprox(Eigen::Matrix2d(Eigen::Vector2d(1e-6, 4e-6).asDiagonal()), 1e-9));
}

TEST(Sighting, CovarianceGrowsInAzimuthTowardsTheZenithAndStaysFiniteThere) {
  const Sighting low = sightingOf({0.0, 0.0}, Eigen::Matrix2d::Identity() * 1e-6);
  for (const double elevation : {1.0, 1.5, 1.5707}) {
    const Eigen::Matrix3d R = Eigen::AngleAxisd(-elevation, Eigen::Vector3d::UnitY()).toRotationMatrix();
    EXPECT_NEAR(anglesCovariance(rotate(low, R))(0, 0), 1e-6 / std::pow(std::cos(elevation), 2),
                1e-6 * anglesCovariance(rotate(low, R))(0, 0));
  }
  const Eigen::Matrix3d to_zenith =
      Eigen::AngleAxisd(-std::acos(0.0), Eigen::Vector3d::UnitY()).toRotationMatrix();
  EXPECT_TRUE(anglesCovariance(rotate(low, to_zenith)).allFinite());
}

struct BadCase {
  const char* name;
  Eigen::Vector2d angles;
  Eigen::Matrix2d covariance;
  const char* said;
};

class Rejection : public testing::TestWithParam<BadCase> {};

TEST_P(Rejection, NamesWhatIsWrong) {
  const auto reason = rejectionOf(GetParam().angles, GetParam().covariance);
  ASSERT_TRUE(reason);
  EXPECT_EQ(reason->kind, "invalid");
  EXPECT_NE(reason->detail.find(GetParam().said), std::string::npos) << reason->detail;
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
const Eigen::Matrix2d kGood = Eigen::Matrix2d::Identity() * 1e-6;

INSTANTIATE_TEST_SUITE_P(
    Sighting, Rejection,
    testing::Values(BadCase{"nan_azimuth", {kNan, 0.0}, kGood, "not finite"},
                    BadCase{"infinite_elevation", {0.0, kInf}, kGood, "not finite"},
                    BadCase{"degrees", {45.0, 0.0}, kGood, "degrees"},
                    BadCase{"over_the_top", {0.0, 1.6}, kGood, "off the sphere"},
                    BadCase{"nan_covariance", {0.0, 0.0}, kGood* kNan, "not finite"},
                    BadCase{"zero", {0.0, 0.0}, Eigen::Matrix2d::Zero(), "positive definite"},
                    BadCase{"negative", {0.0, 0.0}, -kGood, "positive definite"},
                    BadCase{"indefinite",
                            {0.0, 0.0},
                            (Eigen::Matrix2d() << 1e-6, 2e-6, 2e-6, 1e-6).finished(),
                            "positive definite"},
                    BadCase{"asymmetric",
                            {0.0, 0.0},
                            (Eigen::Matrix2d() << 1e-6, 2e-7, 1e-7, 1e-6).finished(),
                            "symmetric"},
                    BadCase{"too_small", {0.0, 0.0}, kGood * 1e-14, "below"},
                    BadCase{"too_large", {0.0, 0.0}, kGood * 1e8, "above pi/2"}),
    [](const auto& parameters) { return parameters.param.name; });

TEST(Sighting, RealSigmasFromTenMicroradianToTwentyDegreesAreAccepted) {
  EXPECT_FALSE(rejectionOf({-1.8, 0.0}, Eigen::Vector2d(0.0174533 * 0.0174533, 0.349 * 0.349).asDiagonal()));
  EXPECT_FALSE(rejectionOf({3.1, 1.5}, Eigen::Matrix2d::Identity() * 1e-10));
}

TEST(Sighting, AnglesThatAreRoundedBeyondTheEndOfTheirRangeAreTaken) {
  const Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity() * 1e-6;
  for (const double elevation : {double(float(kPi / 2.0)), 1.570796327, -1.5708, kPi / 2.0}) {
    EXPECT_FALSE(rejectionOf({0.4, elevation}, covariance))
        << textOf(*rejectionOf({0.4, elevation}, covariance));
    const Sighting sighting = sightingOf({0.4, elevation}, covariance);
    EXPECT_NEAR(angleBetween(sighting.direction, {0.0, 0.0, elevation}), 0.0, 1e-9) << "the pole";
    EXPECT_FALSE(rejectionOf(anglesOf(sighting.direction), anglesCovariance(sighting)));
  }
  for (const double azimuth : {double(float(2.0 * kPi)), 6.2832, -6.283185308}) {
    EXPECT_FALSE(rejectionOf({azimuth, 0.1}, covariance));
    EXPECT_LT(angleBetween(sightingOf({azimuth, 0.1}, covariance).direction, directionOf({0.0, 0.1})), 2e-5);
  }
  EXPECT_TRUE(rejectionOf({6.3, 0.0}, covariance));
  EXPECT_TRUE(rejectionOf({0.0, 1.58}, covariance));
}

// An azimuth at the zenith says nothing of where across it the target is; its elevation does, to its sigma.
TEST(Sighting, AtThePoleAnAzimuthsArcIsHeldOffZeroByTheElevationsSigmaAndIsNeverLonger) {
  const auto sigmas = [](double sigma_azimuth, double sigma_elevation) {
    const Eigen::Vector2d variances(sigma_azimuth * sigma_azimuth, sigma_elevation * sigma_elevation);
    const Sighting sighting = sightingOf({0.0, kPi / 2.0}, variances.asDiagonal());
    return Eigen::Vector2d(std::sqrt(sighting.covariance(0, 0)), std::sqrt(sighting.covariance(1, 1)));
  };
  EXPECT_NEAR(sigmas(1e-3, 2e-3).x(), 2e-3, 1e-12) << "along the elevation";
  EXPECT_NEAR(sigmas(1e-3, 2e-3).y(), 1e-3 * 2e-3, 1e-12) << "across";
  EXPECT_NEAR(sigmas(1e6, 2e-3).y(), 2e-3, 1e-12) << "an azimuth of which nothing is known";
}

}  // namespace
}  // namespace sightline::core
