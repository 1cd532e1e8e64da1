#include "sightline/formats/geodesy.h"

#include <cmath>
#include <string>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "format_files.h"
#include "support/scratch_folder.h"

namespace {

using namespace sightline::test;
using namespace sightline::formats;

TEST(Geodesy, PlacesOfTheEllipsoid) {
  EXPECT_LT((earthFixed({0.0, 0.0, 0.0}) - Eigen::Vector3d(6378137.0, 0.0, 0.0)).norm(), 1e-6);
  EXPECT_LT(
      (earthFixed({90.0 * kDegree, 0.0, 100.0}) - Eigen::Vector3d(0.0, 0.0, 6356752.3142 + 100.0)).norm(),
      1e-3);
  const Station station{-30.66 * kDegree, 134.186 * kDegree, 149.1};
  const Station back = stationAt(earthFixed(station));
  EXPECT_NEAR(back.latitude, station.latitude, 1e-12);
  EXPECT_NEAR(back.longitude, station.longitude, 1e-12);
  EXPECT_NEAR(back.height, station.height, 1e-6);
}

TEST(Geodesy, StationsStandInAFrameAtTheirMeanAndLookAlongTheirOwnHorizons) {
  const Station west{48.0 * kDegree, 10.0 * kDegree, 500.0}, east{48.0 * kDegree, 11.0 * kDegree, 500.0};
  const StationLayout layout = layoutOf({{"west", west}, {"east", east}});
  const FramePlace &w = layout.places.at("west"), &e = layout.places.at("east");
  EXPECT_NEAR((w.origin - e.origin).norm(), (earthFixed(west) - earthFixed(east)).norm(), 1e-6);
  EXPECT_NEAR(w.origin.x(), -e.origin.x(), 1e-6);
  EXPECT_GT(e.origin.x(), 37000.0);
  EXPECT_NEAR(w.origin.z(), e.origin.z(), 1e-6);
  EXPECT_NEAR(layout.origin->latitude, 48.0 * kDegree, 1e-12);
  EXPECT_NEAR(layout.origin->longitude, 10.5 * kDegree, 1e-12);
  EXPECT_NEAR(layout.origin->height, 500.0, 1e-9);
  // The eastern station's up leans to the east.
  EXPECT_NEAR(e.rotation(0, 2), std::cos(48.0 * kDegree) * std::sin(0.5 * kDegree), 1e-9);
  EXPECT_NEAR((e.rotation * e.rotation.transpose() - Eigen::Matrix3d::Identity()).norm(), 0.0, 1e-12);
  EXPECT_NEAR(e.rotation.determinant(), 1.0, 1e-12);
}

TEST(Geodesy, TheMeanOfLongitudesAcrossTheDateLineIsThere) {
  const StationLayout layout =
      layoutOf({{"a", {0.1, 179.0 * kDegree, 0.0}}, {"b", {0.1, -179.0 * kDegree, 0.0}}});
  EXPECT_NEAR(std::abs(layout.origin->longitude), 180.0 * kDegree, 1e-9);
}

TEST(Geodesy, OneStationIsTheOriginItself) {
  const StationLayout layout = layoutOf({{"a", {0.5, 0.2, 100.0}}});
  EXPECT_EQ(layout.places.at("a").origin.norm(), 0.0);
  EXPECT_LT((layout.places.at("a").rotation - Eigen::Matrix3d::Identity()).norm(), 1e-15);
}

TEST(Geodesy, TablesOfStationsInMetresAndInDegrees) {
  const ScratchFolder folder;
  const StationLayout metres =
      readStationLayout(folder.write("m.csv", "sensor,east_m,north_m,up_m\na,1,2,3\nb,-4,5,6\n"));
  EXPECT_EQ(metres.places.at("b").origin, Eigen::Vector3d(-4.0, 5.0, 6.0));
  EXPECT_EQ(metres.places.at("b").rotation, Eigen::Matrix3d::Identity());
  EXPECT_FALSE(metres.origin);
  const std::string degrees =
      folder.write("d.csv", "sensor,latitude_deg,longitude_deg,height_m\na,48,11,500\n");
  EXPECT_TRUE(readStationLayout(degrees).origin);
  EXPECT_NEAR(readStations(degrees).at("a").latitude, 48.0 * kDegree, 1e-12);
}

TEST(Geodesy, MistakesInTablesAreNamed) {
  const ScratchFolder folder;
  const auto why = [&](const std::string& text) {
    return refusal([&] { readStationLayout(folder.write("s.csv", text)); });
  };
  EXPECT_TRUE(
      contains(why("sensor,east_m,north_m\na,1,2\n"), "expected the columns sensor,east_m,north_m,up_m or"));
  EXPECT_TRUE(
      contains(why("sensor,latitude_deg,longitude_deg,height_m\na,98,11,500\n"), "s.csv:2: latitude_deg"));
  EXPECT_TRUE(contains(why("sensor,east_m,north_m,up_m\na,1,2,3\na,1,2,3\n"), "stands twice"));
  EXPECT_TRUE(contains(why("sensor,east_m,north_m,up_m\n"), "no station"));
  EXPECT_TRUE(
      contains(refusal([&] { readStations(folder.write("s.csv", "sensor,east_m,north_m,up_m\na,1,2,3\n")); }),
               "in metres"));
}

}  // namespace
