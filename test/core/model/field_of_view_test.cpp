#include "sightline/core/model/field_of_view.h"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"
#include "sightline/core/simulation/random_stream.h"

namespace sightline::core {
namespace {

TEST(FieldOfView, DefaultIsTheWholeSphere) {
  const FieldOfView everywhere;
  EXPECT_TRUE(everywhere.holds(-Eigen::Vector3d::UnitX()));
  EXPECT_TRUE(everywhere.holds(Eigen::Vector3d::UnitZ()));
  EXPECT_TRUE(everywhere.holds(-Eigen::Vector3d::UnitZ()));
  EXPECT_NEAR(everywhere.solidAngle(), 4.0 * kPi, 1e-12);
}

TEST(FieldOfView, RimBelongsToItAndWhatIsBeyondDoesNot) {
  FieldOfView view;
  view.half_widths = {0.5, 0.2};
  for (const double side : {-1.0, 1.0}) {
    EXPECT_TRUE(view.holds(directionOf({side * 0.5, 0.0})));
    EXPECT_FALSE(view.holds(directionOf({side * 0.5001, 0.0})));
    EXPECT_TRUE(view.holds(directionOf({0.0, side * 0.2})));
    EXPECT_FALSE(view.holds(directionOf({0.0, side * 0.2001})));
  }
  EXPECT_FALSE(view.holds(-Eigen::Vector3d::UnitX())) << "what is behind is not seen";
}

TEST(FieldOfView, LengthOfTheDirectionDoesNotMatter) {
  FieldOfView view;
  view.half_widths = {0.5, 0.2};
  EXPECT_TRUE(view.holds(1000.0 * directionOf({0.49, 0.19})));
  EXPECT_FALSE(view.holds(1e-3 * directionOf({0.51, 0.19})));
}

TEST(FieldOfView, TurnsWithTheSensor) {
  FieldOfView view;
  view.half_widths = {0.5, 0.2};
  const Eigen::Matrix3d R_tracking_sensor =
      (Eigen::AngleAxisd(3.0, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(-0.6, Eigen::Vector3d::UnitY()))
          .toRotationMatrix();
  view.R_sensor_tracking = R_tracking_sensor.transpose();
  EXPECT_TRUE(view.holds(directionOf({3.0, 0.6}))) << "along the boresight, across the wrap";
  EXPECT_FALSE(view.holds(Eigen::Vector3d::UnitX()));
  for (const double azimuth : {-0.51, -0.49, 0.49, 0.51}) {
    EXPECT_EQ(view.holds(R_tracking_sensor * directionOf({azimuth, 0.1})), std::abs(azimuth) < 0.5);
  }
}

/// Share of directions, uniform on the sphere, that lie in the view: binomial, five standard deviations.
TEST(FieldOfView, SolidAngleIsTheShareOfTheSphereThatItHolds) {
  FieldOfView view;
  view.half_widths = {1.0, 0.8};
  view.R_sensor_tracking = Eigen::AngleAxisd(1.0, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()).matrix();
  RandomStream random(1);
  constexpr int kDraws = 100000;
  int held = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double azimuth = kPi * (2.0 * random.uniform() - 1.0);
    const double elevation = std::asin(2.0 * random.uniform() - 1.0);
    if (view.holds(directionOf({azimuth, elevation}))) ++held;
  }
  const double share = view.solidAngle() / (4.0 * kPi);
  EXPECT_NEAR(static_cast<double>(held) / kDraws, share, 5.0 * std::sqrt(share * (1.0 - share) / kDraws));
}

}  // namespace
}  // namespace sightline::core
