#include "sightline/formats/star_coordinates.h"

#include <cmath>

#include <gtest/gtest.h>

#include "sightline/formats/field_text.h"

#include "format_files.h"

namespace {

using namespace sightline::test;
using sightline::formats::Equinox;
using sightline::formats::horizontalOf;
using sightline::formats::isoTime;
using sightline::formats::Station;

double hours(double h, double m, double s) {
  return (h + m / 60.0 + s / 3600.0) * 15.0 * kDegree;
}

/// Precession from J2000.0 by Lieske's angles (Meeus, Astronomical Algorithms, chapter 21).
Eigen::Vector2d precessed(const Eigen::Vector2d& j2000, double centuries) {
  const double t = centuries, arcsec = kDegree / 3600.0;
  const double zeta = (2306.2181 * t + 0.30188 * t * t) * arcsec,
               z = (2306.2181 * t + 1.09468 * t * t) * arcsec;
  const double theta = (2004.3109 * t - 0.42665 * t * t) * arcsec;
  const double a = std::cos(j2000.y()) * std::sin(j2000.x() + zeta);
  const double b = std::cos(theta) * std::cos(j2000.y()) * std::cos(j2000.x() + zeta) -
                   std::sin(theta) * std::sin(j2000.y());
  const double c = std::sin(theta) * std::cos(j2000.y()) * std::cos(j2000.x() + zeta) +
                   std::cos(theta) * std::sin(j2000.y());
  return {std::atan2(a, b) + z, std::asin(c)};
}

TEST(StarCoordinates, VenusAtWashingtonStandsWhereMeeusHasIt) {
  // Astronomical Algorithms, example 13.b: azimuth 68.0337 degrees from the south, elevation 15.1249.
  const Station washington{(38.0 + 55.0 / 60.0 + 17.0 / 3600.0) * kDegree,
                           -(77.0 + 3.0 / 60.0 + 56.0 / 3600.0) * kDegree, 0.0};
  const Eigen::Vector2d venus(hours(23, 9, 16.641), -(6.0 + 43.0 / 60.0 + 11.61 / 3600.0) * kDegree);
  const auto angles =
      horizontalOf(venus, Equinox::of_date, *isoTime("1987-04-10T19:21:00Z"), washington, 0.0);
  ASSERT_TRUE(angles);
  EXPECT_NEAR(angles->x() / kDegree, 90.0 - 248.0337, 3e-4);
  EXPECT_NEAR(angles->y() / kDegree, 15.1249, 3e-4);
}

TEST(StarCoordinates, J2000IsTheApparentPlaceWithoutPrecessionToTheAberration) {
  const Station site{52.0 * kDegree, -2.0 * kDegree, 70.0};
  const auto time = *isoTime("2024-03-12T19:30:15Z");
  for (const Eigen::Vector2d& star :
       {Eigen::Vector2d(1.0, 0.8), Eigen::Vector2d(4.0, -0.2), Eigen::Vector2d(5.9, 1.4)}) {
    const auto by_catalogue = horizontalOf(star, Equinox::j2000, time, site, 0.0);
    const auto by_date = horizontalOf(precessed(star, 0.24195), Equinox::of_date, time, site, 0.0);
    // aberration of 20.5 and nutation of 17 arc seconds at most; precession is a third of a degree
    EXPECT_LT(apart(*by_catalogue, *by_date), 2e-4);
    EXPECT_GT(apart(*by_catalogue, *horizontalOf(star, Equinox::of_date, time, site, 0.0)), 1e-3);
  }
}

TEST(StarCoordinates, RegulusIsOneStarInBothCatalogues) {
  const Station site{52.0 * kDegree, -2.0 * kDegree, 70.0};
  const auto time = *isoTime("2000-01-01T12:00:00Z");
  const Eigen::Vector2d b1950(hours(10, 5, 43.0), (12.0 + 12.0 / 60.0 + 44.0 / 3600.0) * kDegree);
  const Eigen::Vector2d j2000(hours(10, 8, 22.3), (11.0 + 58.0 / 60.0 + 2.0 / 3600.0) * kDegree);
  EXPECT_LT(apart(*horizontalOf(b1950, Equinox::b1950, time, site, 0.0),
                  *horizontalOf(j2000, Equinox::j2000, time, site, 0.0)),
            2e-4);
}

TEST(StarCoordinates, ASecondOfUt1TurnsTheSkyByFifteenArcSeconds) {
  const Station equator{0.0, 0.0, 0.0};
  const auto time = *isoTime("2024-03-12T19:30:15Z");
  const Eigen::Vector2d star(1.0, 0.0);
  EXPECT_NEAR(apart(*horizontalOf(star, Equinox::j2000, time, equator, 0.0),
                    *horizontalOf(star, Equinox::j2000, time, equator, 0.9)),
              0.9 * 15.041 * kDegree / 3600.0, 2e-7);
}

}  // namespace
