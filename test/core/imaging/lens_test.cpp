#include "sightline/core/imaging/lens.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"
#include "sightline/core/simulation/random_stream.h"

namespace sightline::core {
namespace {

using Coefficients = std::vector<double>;

constexpr double kExact = 1e-9;  // [rad]

/// The model of Brown and Conrady as it stands in the books, written down once more.
Eigen::Vector2d imageByTheBook(const Coefficients& given, const Eigen::Vector3d& ray) {
  Coefficients k = given;
  k.resize(14, 0.0);
  const double x = ray.x() / ray.z(), y = ray.y() / ray.z(), r2 = x * x + y * y;
  const double radial = (1.0 + k[0] * r2 + k[1] * std::pow(r2, 2) + k[4] * std::pow(r2, 3)) /
                        (1.0 + k[5] * r2 + k[6] * std::pow(r2, 2) + k[7] * std::pow(r2, 3));
  return {x * radial + 2.0 * k[2] * x * y + k[3] * (r2 + 2.0 * x * x) + k[8] * r2 + k[9] * r2 * r2,
          y * radial + k[2] * (r2 + 2.0 * y * y) + 2.0 * k[3] * x * y + k[10] * r2 + k[11] * r2 * r2};
}

Eigen::Vector3d rayOff(double angle, double bearing) {
  return {std::sin(angle) * std::cos(bearing), std::sin(angle) * std::sin(bearing), std::cos(angle)};
}

void expectJacobianIsThatOfTheRay(const Lens& lens, const Eigen::Vector2d& image) {
  const auto ray = lens.rayAt(image);
  ASSERT_TRUE(ray);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(i);
    const auto more = lens.rayAt(image + step), less = lens.rayAt(image - step);
    ASSERT_TRUE(more && less);
    const Eigen::Vector3d slope = (more->direction - less->direction) / (2.0 * kStep);
    EXPECT_LT((ray->jacobian.col(i) - slope).norm(), 1e-5 * std::max(slope.norm(), 1.0))
        << image.transpose() << ", column " << i;
  }
}

TEST(Lens, PositiveRootsAreTheChangesOfSignInOrder) {
  // (x - 1)(x - 2)(x - 4) = -8 + 14 x - 7 x^2 + x^3
  const auto roots = positiveRoots({-8.0, 14.0, -7.0, 1.0});
  ASSERT_EQ(roots.size(), 3u);
  EXPECT_NEAR(roots[0], 1.0, 1e-12);
  EXPECT_NEAR(roots[1], 2.0, 1e-12);
  EXPECT_NEAR(roots[2], 4.0, 1e-12);
  EXPECT_TRUE(positiveRoots({1.0, 2.0, 3.0}).empty());
  EXPECT_TRUE(positiveRoots({4.0, -4.0, 1.0}).empty()) << "touches zero at 2 and does not change its sign";
  EXPECT_TRUE(positiveRoots({1.0}).empty());
  EXPECT_TRUE(positiveRoots({}).empty());
  const auto far = positiveRoots({1.0, 0.0, -1e-20});
  ASSERT_EQ(far.size(), 1u);
  EXPECT_NEAR(far[0], 1e10, 1e-3);
}

TEST(Lens, WithoutDistortionTheImageIsTheRay) {
  for (const Lens& lens : {Lens::perspective({}), Lens::perspective({0.0, 0.0, 0.0, 0.0, 0.0})}) {
    const auto ray = lens.rayAt({0.3, -2.0});
    ASSERT_TRUE(ray);
    EXPECT_LT(angleBetween(ray->direction, {0.3, -2.0, 1.0}), 1e-15);
    EXPECT_EQ(lens.edgeAngle(), kPi / 2.0);
    EXPECT_TRUE(std::isinf(lens.edgeRadius()));
  }
  const auto ray = Lens::equidistant({}).rayAt({0.8, 0.6});
  ASSERT_TRUE(ray);
  EXPECT_NEAR(angleBetween(ray->direction, {0.0, 0.0, 1.0}), 1.0, 1e-15) << "angle = radius";
}

struct Case {
  const char* name;
  Coefficients k;
  double radius;  // of the image, of which all of it is tried [focal lengths]
};

class PerspectiveLens : public testing::TestWithParam<Case> {};

TEST_P(PerspectiveLens, RaysLeadBackToTheirImagesByTheBook) {
  const Lens lens = Lens::perspective(GetParam().k);
  for (double r = 0.0; r <= GetParam().radius; r += GetParam().radius / 50.0) {
    for (double bearing = 0.0; bearing < 6.0; bearing += 0.37) {
      const Eigen::Vector2d image(r * std::cos(bearing), r * std::sin(bearing));
      const auto ray = lens.rayAt(image);
      ASSERT_TRUE(ray) << r << ", " << bearing;
      EXPECT_LT((imageByTheBook(GetParam().k, ray->direction) - image).norm(), 1e-13 * (1.0 + r));
      const auto back = lens.project(ray->direction);
      ASSERT_TRUE(back);
      EXPECT_LT((*back - image).norm(), 1e-13 * (1.0 + r));
    }
  }
  expectJacobianIsThatOfTheRay(lens, {0.5 * GetParam().radius, 0.3 * GetParam().radius});
  expectJacobianIsThatOfTheRay(lens, {0.0, 0.01});
}

INSTANTIATE_TEST_SUITE_P(
    Lens, PerspectiveLens,
    testing::Values(Case{"barrel", {-0.26, 0.075, 0.0, 0.0, -0.009}, 1.17},
                    Case{"tangential", {-0.31, 0.12, 0.001, -0.0015, -0.02}, 0.85},
                    Case{"pincushion", {0.15, 0.03, 0.0, 0.0, 0.01}, 3.0},
                    Case{"rational", {8.2, 5.1, 0.0, 0.0, 0.26, 8.5, 7.6, 1.5}, 1.2},
                    Case{
                        "prism", {-0.1, 0.02, 0.0, 0.001, 0.0, 0.0, 0.0, 0.0, 1e-3, 2e-4, -1e-3, 1e-4}, 1.2}),
    [](const auto& parameters) { return parameters.param.name; });

TEST(Lens, ATiltedSensorIsSeenAsByTheHomographyOfItsPlane) {
  Coefficients k(14, 0.0);
  k[0] = -0.1;
  k[12] = 0.05;  // about x
  k[13] = -0.03;
  const Lens lens = Lens::perspective(k);
  const double cx = std::cos(0.05), sx = std::sin(0.05), cy = std::cos(-0.03), sy = std::sin(-0.03);
  for (const Eigen::Vector2d& image : {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.4, -0.5)}) {
    const auto ray = lens.rayAt(image);
    ASSERT_TRUE(ray);
    const Eigen::Vector2d upright = imageByTheBook({-0.1, 0.0, 0.0, 0.0}, ray->direction);
    // The ray through the upright image, in coordinates of the tilted plane, meets that plane at depth
    // R33 / z.
    const Eigen::Vector3d turned_x(upright.x(), cx * upright.y() + sx, -sx * upright.y() + cx);
    const Eigen::Vector3d turned(cy * turned_x.x() - sy * turned_x.z(), turned_x.y(),
                                 sy * turned_x.x() + cy * turned_x.z());
    const Eigen::Vector3d axis(-sy * cx, sx, cy * cx);  // of the lens
    const Eigen::Vector2d met = turned.head<2>() * (axis.z() / turned.z()) - axis.head<2>();
    EXPECT_LT((met - image).norm(), 1e-12);
    expectJacobianIsThatOfTheRay(lens, image);
  }
}

/// Tangent of the angle off the axis of the barrel lens below, by bisection with more digits than a double
/// has.
double barrelTangent(double image_radius, double fold) {
  long double low = 0.0L, high = fold;
  for (int i = 0; i < 70; ++i) {
    const long double r = 0.5L * (low + high), s = r * r;
    r*(1.0L - 0.26L * s + 0.075L * s * s - 0.009L * s * s * s) < image_radius ? low = r : high = r;
  }
  return static_cast<double>(low);
}

// A barrel lens of 1280x960 pixels. The radius r (1 - 0.26 r^2 + 0.075 r^4 - 0.009 r^6) grows up to its first
// extreme and is largest there: at 703 px for f = 600, where the corners are 800 px from the centre.
TEST(Lens, OfABarrelLensEveryPixelWithinTheFoldHasItsRayAndNoneBeyond) {
  const Coefficients k = {-0.26, 0.075, 0.0, 0.0, -0.009};
  const Lens lens = Lens::perspective(k);
  // Independently: the largest image radius, by trying the tangents of all angles.
  double largest = 0.0, at = 0.0;
  for (double r = 0.0; r < 50.0; r += 1e-5) {
    const double image = r * (1.0 - 0.26 * std::pow(r, 2) + 0.075 * std::pow(r, 4) - 0.009 * std::pow(r, 6));
    if (image > largest) largest = image, at = r;
  }
  EXPECT_NEAR(lens.edgeRadius(), largest, 1e-9);
  EXPECT_NEAR(std::tan(lens.edgeAngle()), at, 2e-5);
  EXPECT_NEAR(600.0 * lens.edgeRadius(), 703.12, 0.01);
  for (const double f : {600.0, 700.0}) {
    int pixels = 0, without = 0;
    for (int u = 0; u < 1280; ++u) {
      for (int v = 0; v < 960; ++v, ++pixels) {
        const Eigen::Vector2d image = Eigen::Vector2d(u - 640.0, v - 480.0) / f;
        const auto ray = lens.rayAt(image);
        ASSERT_EQ(ray.has_value(), image.norm() <= largest) << u << ", " << v;
        if (!ray) {
          ++without;
          continue;
        }
        if (u % 10 != 0) continue;  // a tenth of them: in long double they take a while
        const double tangent = barrelTangent(image.norm(), at);
        const double angle = angleBetween(ray->direction, {0.0, 0.0, 1.0});
        ASSERT_NEAR(angle, std::atan(tangent), kExact) << u << ", " << v;
        ASSERT_LT((ray->direction.head<2>().normalized() - image.normalized()).norm(), kExact);
      }
    }
    EXPECT_NEAR(100.0 * without / pixels, f == 600.0 ? 3.42 : 0.0, f == 600.0 ? 0.01 : 0.0);
  }
}

TEST(Lens, RaysOfABarrelLensAreExactFromTheCentreToTheFold) {
  const Coefficients k = {-0.26, 0.075, 0.0, 0.0, -0.009};
  const Lens lens = Lens::perspective(k);
  for (double share = 0.0; share < 0.9999; share += 0.0007) {
    const Eigen::Vector3d ray = rayOff(share * lens.edgeAngle(), 2.1);
    const auto found = lens.rayAt(imageByTheBook(k, ray));
    ASSERT_TRUE(found) << share;
    EXPECT_LT(angleBetween(found->direction, ray), kExact) << share;
  }
}

TEST(Lens, AFisheyesRaysAreExactBeyondNinetyDegrees) {
  for (const Coefficients& k :
       {Coefficients{}, Coefficients{0.0, 0.0, 0.0, 0.0}, Coefficients{0.02, -0.004, 0.001, 0.0},
        Coefficients{-0.03, 0.002, 0.0, 0.0}}) {
    const Lens lens = Lens::equidistant(k);
    Coefficients four = k;
    four.resize(4, 0.0);
    for (double degrees = 0.0; degrees <= 110.0; degrees += 0.5) {
      const double angle = degrees * kDegree;
      ASSERT_LT(angle, lens.edgeAngle());
      const double radius = angle * (1.0 + four[0] * std::pow(angle, 2) + four[1] * std::pow(angle, 4) +
                                     four[2] * std::pow(angle, 6) + four[3] * std::pow(angle, 8));
      const Eigen::Vector2d image(radius * std::cos(-2.0), radius * std::sin(-2.0));
      const auto ray = lens.rayAt(image);
      ASSERT_TRUE(ray) << degrees;
      EXPECT_LT(angleBetween(ray->direction, rayOff(angle, -2.0)), kExact) << degrees;
      const auto back = lens.project(ray->direction);
      ASSERT_TRUE(back);
      EXPECT_LT((*back - image).norm(), 1e-14);
    }
    expectJacobianIsThatOfTheRay(lens, {1.2, -0.9});
    expectJacobianIsThatOfTheRay(lens, {1e-3, 0.0});
  }
}

TEST(Lens, AFisheyeEndsAtItsFoldOrBehindItself) {
  EXPECT_NEAR(Lens::equidistant({}).edgeAngle(), kPi, 1e-12);
  EXPECT_TRUE(Lens::equidistant({}).rayAt({3.1, 0.0}));
  EXPECT_FALSE(Lens::equidistant({}).rayAt({3.2, 0.0}));
  const Lens folds = Lens::equidistant({-0.1, 0.0, 0.0, 0.0});  // slope 1 - 0.3 angle^2
  EXPECT_NEAR(folds.edgeAngle(), std::sqrt(1.0 / 0.3), 1e-12);
  EXPECT_NEAR(folds.edgeRadius(), 2.0 / 3.0 * std::sqrt(1.0 / 0.3), 1e-12);
  EXPECT_TRUE(folds.rayAt({1.2, 0.0}));
  EXPECT_FALSE(folds.rayAt({1.3, 0.0}));
  EXPECT_FALSE(folds.project(rayOff(2.0, 0.0)));
}

TEST(Lens, WhatIsNotImagedHasNoImageAndWhatIsNotANumberNoRay) {
  const Lens lens = Lens::perspective({-0.26, 0.075, 0.001, 0.0, -0.009});
  EXPECT_FALSE(lens.project({0.1, 0.1, -1.0}));
  EXPECT_FALSE(lens.project({0.0, 0.0, 0.0}));
  EXPECT_FALSE(lens.project({3.0, 0.0, 1.0})) << "beyond the fold";
  EXPECT_FALSE(lens.rayAt({1.3, 0.0})) << "with a tangential term, too";
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(lens.rayAt({nan, 0.0}));
  EXPECT_FALSE(Lens::equidistant({}).rayAt({0.0, nan}));
  EXPECT_FALSE(lens.rayAt({1e300, 1e300}));
}

TEST(Lens, AnyLensEndsOrAnswersInTime) {
  RandomStream stream(11);
  int answered = 0;
  for (int i = 0; i < 2000; ++i) {
    Coefficients k;
    for (int j = 0; j < 12; ++j) k.push_back(0.5 * stream.normalPair().x());
    for (const Lens& lens : {Lens::perspective(k), Lens::equidistant({k[0], k[1], k[2], k[3]})}) {
      const Eigen::Vector2d image = 0.5 * stream.normalPair();
      const auto ray = lens.rayAt(image);
      if (!ray) continue;
      ++answered;
      const auto back = lens.project(ray->direction);
      ASSERT_TRUE(back) << i;
      EXPECT_LT((*back - image).norm(), 1e-10) << i;
    }
  }
  EXPECT_GT(answered, 1000);
}

}  // namespace
}  // namespace sightline::core
