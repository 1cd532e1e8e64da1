#include "sightline/ros/display/position_shapes.h"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

namespace {

using namespace sightline_ros;

Eigen::Vector3d placeOf(const geometry_msgs::Point& point) {
  return {point.x, point.y, point.z};
}

TEST(PositionShapes, WidthsGrowWithTheScene) {
  MetricCanvas canvas;
  canvas.size = 200.0;
  EXPECT_DOUBLE_EQ(metricLines(canvas, "lines", 0.002).scale.x, 0.4);
  EXPECT_DOUBLE_EQ(metricDots(canvas, "dots", 0.01).scale.z, 2.0);
  EXPECT_DOUBLE_EQ(metricText(canvas, "text", 0, {1.0, 2.0, 3.0}, "a", 0.03, Colour()).scale.z, 6.0);
}

TEST(PositionShapes, FieldOfViewStartsAtTheStationAndItsRimIsAtOneDistanceInTheDirectionsThatItSees) {
  MetricCanvas canvas;
  StationView view;
  view.origin = {10.0, 20.0, 5.0};
  view.R_metric_sensor = Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  view.half_width = {0.6, 0.3};
  Marker lines = metricLines(canvas, "lines", 0.002), faces = metricFaces(canvas, "faces");
  drawFieldOfView(lines, faces, canvas, view, Colour());
  ASSERT_EQ(lines.points.size(), lines.colors.size());
  double widest = 0.0, highest = 0.0;
  int at_station = 0;
  for (const auto& point : lines.points) {
    const Eigen::Vector3d from_station = placeOf(point) - view.origin;
    if (from_station.norm() < 1e-9) {
      ++at_station;
      continue;
    }
    EXPECT_NEAR(from_station.norm(), kViewLength * canvas.size, 1e-9);
    const Eigen::Vector2d angles = sightline::core::anglesOf(view.R_metric_sensor.transpose() * from_station);
    widest = std::max(widest, std::abs(angles.x()));
    highest = std::max(highest, std::abs(angles.y()));
  }
  EXPECT_EQ(at_station, 4);
  EXPECT_NEAR(widest, 0.6, 1e-9);
  EXPECT_NEAR(highest, 0.3, 1e-9);
  EXPECT_EQ(faces.points.size() % 3, 0u);
  EXPECT_LT(faces.colors.at(0).a, 0.2F);
}

TEST(PositionShapes, EllipsoidHasTheAxesOfTheCovariance) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  const Eigen::Matrix3d covariance = turn * Eigen::Vector3d(1.0, 4.0, 9.0).asDiagonal() * turn.transpose();
  const Marker marker =
      ellipsoidMarker(MetricCanvas{}, "ellipsoids", 3, {1.0, 2.0, 3.0}, covariance, 2.0, Colour());
  EXPECT_NEAR(marker.scale.x, 4.0, 1e-9);  // diameter of two sigmas of 1 m
  EXPECT_NEAR(marker.scale.z, 12.0, 1e-9);
  const auto& q = marker.pose.orientation;
  const Eigen::Matrix3d R = Eigen::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix();
  const Eigen::Vector3d halves(marker.scale.x / 4.0, marker.scale.y / 4.0, marker.scale.z / 4.0);
  EXPECT_LT((R * halves.cwiseAbs2().asDiagonal() * R.transpose() - covariance).norm(), 1e-9);
}

TEST(PositionShapes, EllipsoidNeitherVanishesNorFillsTheScene) {
  const Marker small = ellipsoidMarker(MetricCanvas{}, "e", 0, Eigen::Vector3d::Zero(),
                                       Eigen::Matrix3d::Zero(), 2.0, Colour());
  EXPECT_GT(small.scale.x, 0.0);
  const Marker large = ellipsoidMarker(MetricCanvas{}, "e", 0, Eigen::Vector3d::Zero(),
                                       1e12 * Eigen::Matrix3d::Identity(), 2.0, Colour());
  EXPECT_LE(large.scale.x, 300.0);
}

TEST(PositionShapes, FadingPathEndsInItsFullColour) {
  Marker lines = metricLines(MetricCanvas{}, "trail", 0.002);
  Colour white;
  white.r = white.g = white.b = white.a = 1.0F;
  drawFadingPath(lines, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, white);
  ASSERT_EQ(lines.points.size(), 6u);
  EXPECT_LT(lines.colors.front().r, lines.colors.back().r);
  EXPECT_EQ(lines.points.back().x, 3.0);
  Marker none = metricLines(MetricCanvas{}, "trail", 0.002);
  drawFadingPath(none, {}, white);
  EXPECT_TRUE(none.points.empty());
}

TEST(PositionShapes, CrossesAreRoundTheirPlace) {
  for (const auto draw : {drawStar, drawCrossOut}) {
    Marker lines = metricLines(MetricCanvas{}, "crosses", 0.002);
    draw(lines, {5.0, 6.0, 7.0}, 2.0, Colour());
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& point : lines.points) {
      EXPECT_NEAR((placeOf(point) - Eigen::Vector3d(5.0, 6.0, 7.0)).norm(), 2.0, 1e-9);
      sum += placeOf(point);
    }
    EXPECT_LT((sum / static_cast<double>(lines.points.size()) - Eigen::Vector3d(5.0, 6.0, 7.0)).norm(), 1e-9);
  }
}

TEST(PositionShapes, ArrowAndBoxAreWhereTheyAreDrawn) {
  const Marker arrow = arrowMarker(MetricCanvas{}, "v", 1, {1.0, 1.0, 1.0}, {0.0, 4.0, 0.0}, Colour());
  ASSERT_EQ(arrow.points.size(), 2u);
  EXPECT_EQ(arrow.points[1].y, 5.0);
  const Marker box = boxMarker(MetricCanvas{}, "b", 1, {0.0, 0.0, 0.0}, {2.0, 4.0, 6.0}, Colour());
  EXPECT_EQ(box.pose.position.z, 3.0);
  EXPECT_EQ(box.scale.y, 4.0);
}

TEST(PositionShapes, EnlargementIsARoundNumberThatKeepsStillWhileItServes) {
  const double first = enlargementFor(0.05, 100.0, 0.0);  // 1.2 m wanted: 24 times
  EXPECT_EQ(first, 20.0);
  EXPECT_EQ(enlargementFor(0.08, 100.0, first), 20.0);
  EXPECT_EQ(enlargementFor(0.5, 100.0, first), 2.0);
  EXPECT_EQ(enlargementFor(50.0, 100.0, 0.0), 1.0) << "never made smaller";
  EXPECT_EQ(enlargementFor(0.0, 100.0, 5.0), 5.0);
  EXPECT_EQ(enlargementFor(std::nan(""), 100.0, 0.0), 1.0);
}

TEST(PositionShapes, LengthsAreSaidInTheUnitOfAPerson) {
  EXPECT_EQ(readableLength(0.0042), "4.2 mm");
  EXPECT_EQ(readableLength(0.063), "6.3 cm");
  EXPECT_EQ(readableLength(0.63), "63 cm");
  EXPECT_EQ(readableLength(1.24), "1.2 m");
  EXPECT_EQ(readableLength(63.0), "63 m");
  EXPECT_EQ(readableLength(3400.0), "3.4 km");
}

}  // namespace
