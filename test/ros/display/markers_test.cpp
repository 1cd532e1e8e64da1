#include "sightline/ros/display/markers.h"

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "sightline/core/model/chart.h"
#include "sightline/core/model/sphere.h"

namespace {

namespace core = sightline::core;
using sightline_ros::Canvas;
using sightline_ros::Colour;
using sightline_ros::Marker;
using sightline_ros::MarkerArray;

Eigen::Vector3d positionOf(const geometry_msgs::Point& point) {
  return {point.x, point.y, point.z};
}

/// Everything in reach of the sphere's shells, and a colour for each point.
void expectOnSphere(const Marker& marker, const Canvas& canvas) {
  EXPECT_EQ(marker.colors.size(), marker.points.size());
  for (const geometry_msgs::Point& point : marker.points) {
    EXPECT_NEAR(positionOf(point).norm(), canvas.radius, 0.011 * canvas.radius);
  }
}

sightline::Track trackAt(double azimuth, double elevation, double sigma) {
  sightline::Track track;
  track.id = 7;
  track.status = sightline::Track::CONFIRMED;
  track.azimuth = azimuth;
  track.elevation = elevation;
  const double sigma_azimuth = sigma / std::cos(elevation);
  track.covariance[0] = sigma_azimuth * sigma_azimuth;
  track.covariance[5] = sigma * sigma;
  track.covariance[10] = track.covariance[15] = 1e-4;
  track.sources = {"left", "right"};
  return track;
}

core::AngularState stateAt(double azimuth, double elevation, double azimuth_rate, double elevation_rate) {
  core::AngularState state;
  state.mean << azimuth, elevation, azimuth_rate, elevation_rate;
  state.covariance = 1e-4 * Eigen::Matrix4d::Identity();
  return state;
}

TEST(Markers, SheetOnWhichNothingWasDrawnDeletesItsMarker) {
  const Canvas canvas;
  Marker lines = sightline_ros::lineSheet(canvas, "lines", 0.01);
  EXPECT_EQ(sightline_ros::finished(lines).action, Marker::DELETE);
  sightline_ros::drawLine(lines, canvas, {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()}, Colour());
  EXPECT_EQ(sightline_ros::finished(lines).action, Marker::ADD);
}

TEST(Markers, SizesGrowWithTheRadius) {
  Canvas canvas;
  canvas.radius = 250.0;
  EXPECT_DOUBLE_EQ(sightline_ros::lineSheet(canvas, "lines", 0.01).scale.x, 2.5);
  EXPECT_DOUBLE_EQ(sightline_ros::dotSheet(canvas, "dots", 0.02).scale.y, 5.0);
}

TEST(Markers, CarryTheFrameTheNameAndTheLifetime) {
  Canvas canvas;
  canvas.frame = "ship";
  canvas.lifetime = ros::Duration(0.7);
  const Marker marker = sightline_ros::dotSheet(canvas, "sightings", 0.01);
  EXPECT_EQ(marker.header.frame_id, "ship");
  EXPECT_TRUE(marker.header.stamp.isZero());
  EXPECT_EQ(marker.ns, "sightings");
  EXPECT_EQ(marker.lifetime, ros::Duration(0.7));
}

TEST(Markers, UncertaintyIsRoundAndOfTheRightSizeAtAnyElevation) {
  const Canvas canvas;
  for (const double elevation : {0.0, 0.9, 1.5, core::kPi / 2.0 - 1e-4}) {
    core::AngularState state = stateAt(core::kPi, elevation, 0.0, 0.0);
    const double sigma_azimuth = 0.01 / std::cos(elevation);
    state.covariance(0, 0) = sigma_azimuth * sigma_azimuth;
    Marker lines = sightline_ros::lineSheet(canvas, "ellipses", 0.01);
    sightline_ros::drawUncertainty(lines, canvas, state, sightline_ros::mainColour());
    ASSERT_FALSE(lines.points.empty());
    expectOnSphere(lines, canvas);
    for (const geometry_msgs::Point& point : lines.points) {
      EXPECT_NEAR(core::angleBetween(positionOf(point), core::directionOf(state.angles())), 0.02, 1e-9);
    }
  }
}

TEST(Markers, SmallEllipsesHaveFewCornersAndNoChordLeavesTheRimVisibly) {
  const Canvas canvas;
  std::size_t fewer = 0;
  for (const double sigma : {1e-3, 0.01, 0.05}) {
    core::AngularState state = stateAt(0.3, 0.0, 0.0, 0.0);
    state.covariance.topLeftCorner<2, 2>() = sigma * sigma * Eigen::Matrix2d::Identity();
    Marker lines = sightline_ros::lineSheet(canvas, "ellipses", 0.01);
    sightline_ros::drawUncertainty(lines, canvas, state, sightline_ros::mainColour());
    EXPECT_GT(lines.points.size(), fewer) << sigma;
    fewer = lines.points.size();
    for (std::size_t i = 0; i + 1 < lines.points.size(); i += 2) {
      const Eigen::Vector3d middle = positionOf(lines.points[i]) + positionOf(lines.points[i + 1]);
      EXPECT_GT(core::angleBetween(middle, core::directionOf(state.angles())), 2.0 * sigma - 1e-3);
    }
  }
}

TEST(Markers, PredictionStartsAtTheTrackAndEndsWhereItsRatesLead) {
  const Canvas canvas;
  const core::AngularState state = stateAt(3.1, 0.2, 0.3, -0.1);  // across the wrap
  Marker lines = sightline_ros::lineSheet(canvas, "predictions", 0.01);
  sightline_ros::drawPrediction(lines, canvas, state, 1.0, sightline_ros::mainColour());
  expectOnSphere(lines, canvas);
  const Eigen::Vector3d end = positionOf(lines.points.back()).normalized();
  EXPECT_LT(core::angleBetween(end, core::directionOf({3.4, 0.1})), 1e-9);
}

TEST(Markers, PredictionGoesOnThroughTheZenith) {
  const Canvas canvas;
  const core::AngularState state = stateAt(0.0, core::kPi / 2.0 - 0.1, 0.0, 0.3);
  Marker lines = sightline_ros::lineSheet(canvas, "predictions", 0.01);
  sightline_ros::drawPrediction(lines, canvas, state, 1.0, sightline_ros::mainColour());
  const Eigen::Vector3d end = positionOf(lines.points.back()).normalized();
  EXPECT_LT(core::angleBetween(end, core::directionOf({core::kPi, core::kPi / 2.0 - 0.2})), 1e-6);
}

TEST(Markers, GateThatIsNotFiniteHasNoRectangle) {
  sightline::Gate gate;
  gate.azimuth = 0.3;
  gate.azimuth_half_width = gate.elevation_half_width = 0.1;
  ASSERT_TRUE(sightline_ros::rectangleOf(gate).has_value());
  const Canvas canvas;
  Marker patches = sightline_ros::patchSheet(canvas, "gates");
  sightline_ros::drawPatch(patches, canvas, *sightline_ros::rectangleOf(gate), Colour());
  EXPECT_EQ(patches.points.size() % 3, 0U);
  expectOnSphere(patches, canvas);
  gate.azimuth_half_width = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(sightline_ros::rectangleOf(gate).has_value());
}

TEST(Markers, AnglesAreReadInAUnitAPersonWouldChoose) {
  EXPECT_EQ(sightline_ros::readableAngle(0.02), "1.1 deg");
  EXPECT_EQ(sightline_ros::readableAngle(0.5), "29 deg");
  EXPECT_EQ(sightline_ros::readableAngle(1e-3), "1.0 mrad");
  EXPECT_EQ(sightline_ros::readableAngle(1.2e-5), "12 urad");
  EXPECT_EQ(sightline_ros::readableAngle(0.0), "0.0 urad");
  EXPECT_EQ(sightline_ros::readableAngle(0.004, 0.02), "0.2 deg");  // to be compared with 1.1 deg
}

TEST(Markers, LabelSaysIdStatusSigmaAndSources) {
  sightline::Track track = trackAt(0.2, 1.2, 0.002);
  const std::string label = sightline_ros::labelOf(track);
  for (const char* part : {"track 7", "confirmed", "sigma 2.0 mrad", "from left + right"}) {
    EXPECT_NE(label.find(part), std::string::npos) << label;
  }
  track.sources.assign(6, "camera");
  EXPECT_NE(sightline_ros::labelOf(track).find("6 sources"), std::string::npos);
}

TEST(Markers, GateOutcomeFollowsStatusMissesAndClaims) {
  using sightline_ros::GateOutcome;
  sightline::Track track = trackAt(0.0, 0.0, 0.1);
  EXPECT_EQ(sightline_ros::outcomeOf(track, false), GateOutcome::accepted);
  EXPECT_EQ(sightline_ros::outcomeOf(track, true), GateOutcome::accepted);
  track.misses = 1;
  EXPECT_EQ(sightline_ros::outcomeOf(track, false), GateOutcome::nothing_seen);
  EXPECT_EQ(sightline_ros::outcomeOf(track, true), GateOutcome::claimed_by_other);
  track.status = sightline::Track::TENTATIVE;
  EXPECT_EQ(sightline_ros::outcomeOf(track, true), GateOutcome::tentative);
}

TEST(Markers, GridStaysForEverAndIsLabelledInDegrees) {
  std::set<std::string> labels;
  for (const Marker& marker : sightline_ros::gridMarkers(Canvas()).markers) {
    EXPECT_TRUE(marker.lifetime.isZero());
    if (marker.type == Marker::TEXT_VIEW_FACING) labels.insert(marker.text);
  }
  for (const char* label : {"0", "30", "-30", "60", "-60", "180"})
    EXPECT_EQ(labels.count(label), 1U) << label;
}

TEST(Markers, FieldOfViewIsDrawnInTheSensorsFrame) {
  const Canvas canvas;
  const sightline_ros::FieldOfView view{"left", "left_frame", {0.4, 0.3}};
  const MarkerArray array = sightline_ros::fieldOfViewMarkers(canvas, view, {}, sightline_ros::mainColour());
  ASSERT_EQ(array.markers.size(), 2U);
  for (const Marker& marker : array.markers) {
    EXPECT_EQ(marker.header.frame_id, "left_frame");
    EXPECT_TRUE(marker.frame_locked);
  }
  EXPECT_EQ(array.markers[1].text, "left");
  const geometry_msgs::Point& name = array.markers[1].pose.position;
  EXPECT_LT(positionOf(name).norm(), 0.85 * canvas.radius);  // in front of sightings and of the inset
  double widest = 0.0, highest = 0.0;
  for (const geometry_msgs::Point& point : array.markers[0].points) {
    const Eigen::Vector2d angles = core::anglesOf(positionOf(point));
    widest = std::max(widest, std::abs(angles.x()));
    highest = std::max(highest, std::abs(angles.y()));
  }
  EXPECT_NEAR(widest, 0.4, 1e-9);
  EXPECT_NEAR(highest, 0.3, 1e-9);
}

TEST(Markers, FieldsOfViewThatCoincideShareTheirOutline) {
  std::set<std::vector<double>> starts;
  std::size_t segments = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const MarkerArray array = sightline_ros::fieldOfViewMarkers(Canvas(), {"sensor", "frame", {1e-3, 2e-3}},
                                                                {i, 3}, sightline_ros::mainColour());
    const auto& points = array.markers[0].points;
    EXPECT_GE(points.size(), 8U);  // a dash on each side at least
    for (std::size_t k = 0; k < points.size(); k += 2) {
      starts.insert({points[k].x, points[k].y, points[k].z});
      ++segments;
    }
  }
  EXPECT_GE(starts.size(), segments - 4);  // the corners end one side and start the next
}

}  // namespace
