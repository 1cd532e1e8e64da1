#include "sightline/ros/display/markers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "sightline/core/model/chart.h"
#include "sightline/core/model/sphere.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {
namespace {

constexpr double kLineStep = 2.0 * sightline::core::kDegree;      // of curves along the sphere
constexpr double kGridStep = 5.0 * sightline::core::kDegree;      // of the grid's
constexpr int kFewestCorners = 12, kMostCorners = 36;             // of an ellipse
constexpr double kCornerDepth = 0.03 * sightline::core::kDegree;  // of an ellipse's rim within its chords
constexpr double kTextHeight = 2.4 * sightline::core::kDegree;
constexpr double kNameWidth = 11.0 * sightline::core::kDegree;   // half of a sensor's name, and a bit
constexpr double kNameSpacing = 3.8 * sightline::core::kDegree;  // from line to line

// Things of different kinds lie in thin shells, so that they do not fight for the same depth. Shares of the
// radius.
constexpr double kGridShell = 1.004;
constexpr double kPatchShell = 1.002;
constexpr double kTrailShell = 1.001;
constexpr double kLineShell = 1.0;
constexpr double kDotShell = 0.998;
constexpr double kTextShell = 0.99;
constexpr double kNameShell = 0.8;  // of sensors' names: texts face the camera, so one end is further off

geometry_msgs::Point pointAt(const Canvas& canvas, const Eigen::Vector3d& direction, double shell) {
  const Eigen::Vector3d position = canvas.radius * shell * direction;
  geometry_msgs::Point point;
  point.x = position.x();
  point.y = position.y();
  point.z = position.z();
  return point;
}

void addVertex(Marker& marker, const Canvas& canvas, const Eigen::Vector3d& direction, double shell,
               const Colour& colour) {
  marker.points.push_back(pointAt(canvas, direction, shell));
  marker.colors.push_back(colour);
}

std::string degreesText(int degrees) {
  return std::to_string(degrees);
}

/// Their names when they are few, else their number.
std::string sourcesText(const std::vector<std::string>& sources) {
  constexpr std::size_t kFew = 2;
  if (sources.empty() || sources.size() > kFew) return std::to_string(sources.size()) + " sources";
  std::string text = "from " + sources.front();
  for (std::size_t i = 1; i < sources.size(); ++i) text += " + " + sources[i];
  return text;
}

void drawGridLines(Marker& lines, const Canvas& canvas) {
  const Colour line = dimmed(gridColour(), 0.45);
  const Colour horizon = dimmed(gridColour(), 0.9);
  for (int azimuth = -180; azimuth < 180; azimuth += 30) {
    const double angle = azimuth * sightline::core::kDegree;
    const Directions meridian = gridLine({angle, -75.0 * sightline::core::kDegree},
                                         {angle, 75.0 * sightline::core::kDegree}, kGridStep);
    drawLine(lines, canvas, meridian, azimuth == 0 ? horizon : line);
  }
  for (int elevation = -75; elevation <= 75; elevation += 15) {
    const double angle = elevation * sightline::core::kDegree;
    if (elevation % 30 != 0 && std::abs(elevation) != 75) continue;
    drawLine(lines, canvas,
             gridLine({-sightline::core::kPi, angle}, {sightline::core::kPi, angle}, kGridStep),
             elevation == 0 ? horizon : line);
  }
}

/// A rim of two sigma, of no more corners than can be seen: rviz takes time for each piece of a line.
Directions twoSigmaOutline(const Eigen::Vector2d& angles, const Eigen::Matrix2d& covariance) {
  const double radius = std::max(2.0 * semiAxes(covariance).x(), kCornerDepth);
  const double corners = std::ceil(sightline::core::kPi / std::acos(1.0 - kCornerDepth / radius));
  return ellipseOutline(angles, covariance, 2.0,
                        std::clamp(static_cast<int>(corners), kFewestCorners, kMostCorners));
}

}  // namespace

Marker emptyMarker(const Canvas& canvas, const std::string& name, int type) {
  Marker marker;
  marker.header.frame_id = canvas.frame;
  marker.ns = name;
  marker.type = type;
  marker.action = Marker::ADD;
  marker.pose.orientation.w = 1.0;
  marker.scale.x = marker.scale.y = marker.scale.z = 1.0;
  marker.color = withAlpha(gridColour(), 1.0);
  marker.lifetime = canvas.lifetime;
  return marker;
}

Marker lineSheet(const Canvas& canvas, const std::string& name, double width) {
  Marker marker = emptyMarker(canvas, name, Marker::LINE_LIST);
  marker.scale.x = width * canvas.radius;
  return marker;
}

Marker dotSheet(const Canvas& canvas, const std::string& name, double diameter) {
  Marker marker = emptyMarker(canvas, name, Marker::SPHERE_LIST);
  marker.scale.x = marker.scale.y = marker.scale.z = diameter * canvas.radius;
  return marker;
}

Marker patchSheet(const Canvas& canvas, const std::string& name) {
  return emptyMarker(canvas, name, Marker::TRIANGLE_LIST);
}

Marker finished(Marker sheet) {
  if (sheet.points.empty()) sheet.action = Marker::DELETE;
  return sheet;
}

void drawLine(Marker& lines, const Canvas& canvas, const Directions& line, const Colour& colour) {
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    addVertex(lines, canvas, line[i], kLineShell, colour);
    addVertex(lines, canvas, line[i + 1], kLineShell, colour);
  }
}

void drawFadingLine(Marker& lines, const Canvas& canvas, const Directions& line, const Colour& colour) {
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const double share = static_cast<double>(i + 1) / static_cast<double>(line.size());
    const Colour faded = dimmed(colour, share);
    addVertex(lines, canvas, line[i], kTrailShell, faded);
    addVertex(lines, canvas, line[i + 1], kTrailShell, faded);
  }
}

void drawDot(Marker& dots, const Canvas& canvas, const Eigen::Vector3d& direction, const Colour& colour) {
  addVertex(dots, canvas, direction, kDotShell, colour);
}

void drawCross(Marker& lines, const Canvas& canvas, const Eigen::Vector2d& angles, double arm,
               const Colour& colour) {
  for (const Eigen::Vector2d& along : {Eigen::Vector2d(arm, 0.0), Eigen::Vector2d(0.0, arm)}) {
    drawLine(lines, canvas, {walk(angles, -along), walk(angles, along)}, colour);
  }
}

void drawUncertainty(Marker& lines, const Canvas& canvas, const sightline::core::AngularState& state,
                     const Colour& colour) {
  const Eigen::Matrix2d covariance = tangentCovariance(state.angles(), state.anglesCovariance());
  drawLine(lines, canvas, twoSigmaOutline(state.angles(), covariance), colour);
}

void drawPrediction(Marker& lines, const Canvas& canvas, const sightline::core::AngularState& state,
                    double horizon, const Colour& colour) {
  constexpr int kSteps = 8, kEllipseEvery = 2;
  // In the chart round the target constant rates are a motion, not a swing round the pole.
  const auto chart = sightline::core::Chart::around(sightline::core::directionOf(state.angles()));
  const sightline::core::AngularState start = chart.fromTracking(state);
  Directions way;
  for (int step = 0; step <= kSteps; ++step) {
    const auto later = sightline::core::propagate(start, horizon * step / kSteps, 0.0);
    way.push_back(chart.directionAt(later.angles()));
    if (step == 0 || step % kEllipseEvery != 0) continue;
    const Eigen::Matrix2d covariance = tangentCovariance(later.angles(), later.anglesCovariance());
    Directions outline = twoSigmaOutline(later.angles(), covariance);
    for (Eigen::Vector3d& corner : outline) corner = chart.R_chart_tracking().transpose() * corner;
    drawLine(lines, canvas, outline, dimmed(colour, 0.8 - 0.5 * step / kSteps));
  }
  drawLine(lines, canvas, way, colour);
}

std::optional<AngleRectangle> rectangleOf(const sightline::Gate& gate) {
  const sightline::core::Gate g = toCore(gate);
  if (!g.centre.allFinite() || !g.half_width.allFinite()) return std::nullopt;
  return AngleRectangle{g.centre, g.half_width};
}

void drawPatch(Marker& patches, const Canvas& canvas, const AngleRectangle& rectangle, const Colour& colour) {
  for (const Eigen::Vector3d& vertex : rectanglePatch(rectangle, 2.0 * kLineStep)) {
    addVertex(patches, canvas, vertex, kPatchShell, colour);
  }
}

Marker textMarker(const Canvas& canvas, const std::string& name, int id, const Eigen::Vector3d& direction,
                  const std::string& text, double height, const Colour& colour) {
  Marker marker = emptyMarker(canvas, name, Marker::TEXT_VIEW_FACING);
  marker.id = id;
  marker.pose.position = pointAt(canvas, direction, kTextShell);
  marker.scale.z = height * canvas.radius;
  marker.color = colour;
  marker.text = text;
  return marker;
}

std::string readableAngle(double angle, std::optional<double> scale) {
  struct Unit {
    double size;
    const char* name;
  };
  const double magnitude = std::abs(scale.value_or(angle));
  const Unit unit = magnitude >= 5e-3   ? Unit{sightline::core::kDegree, "deg"}
                    : magnitude >= 1e-4 ? Unit{1e-3, "mrad"}
                                        : Unit{1e-6, "urad"};
  const double value = angle / unit.size;
  char text[48];
  std::snprintf(text, sizeof(text), std::abs(value) < 9.95 ? "%.1f %s" : "%.0f %s", value, unit.name);
  return text;
}

std::string labelOf(const sightline::Track& track) {
  static constexpr std::array<const char*, 3> kStatus = {"tentative", "confirmed", "coasting"};
  const sightline::core::AngularState state = toCore(track).state;
  const double sigma = semiAxes(tangentCovariance(state.angles(), state.anglesCovariance())).x();
  const char* status = track.status < kStatus.size() ? kStatus[track.status] : "unknown status";
  return "track " + std::to_string(track.id) + "  " + status + "\nsigma " + readableAngle(sigma) + "\n" +
         sourcesText(track.sources);
}

GateOutcome outcomeOf(const sightline::Track& track, bool claimed) {
  if (track.status == sightline::Track::TENTATIVE) return GateOutcome::tentative;
  if (track.misses == 0) return GateOutcome::accepted;
  return claimed ? GateOutcome::claimed_by_other : GateOutcome::nothing_seen;
}

MarkerArray gridMarkers(Canvas canvas) {
  canvas.lifetime = ros::Duration(0.0);
  MarkerArray array;
  Canvas outer = canvas;
  outer.radius *= kGridShell;
  array.markers.push_back(lineSheet(outer, "lines", 0.1 * sightline::core::kDegree));
  drawGridLines(array.markers.back(), outer);
  const Colour colour = withAlpha(gridColour(), 1.0);
  int id = 0;
  const auto label = [&](double azimuth, double elevation, int degrees) {
    array.markers.push_back(textMarker(canvas, "degrees", id++,
                                       sightline::core::directionOf({azimuth * sightline::core::kDegree,
                                                                     elevation * sightline::core::kDegree}),
                                       degreesText(degrees), kTextHeight, colour));
  };
  for (int azimuth = -150; azimuth <= 180; azimuth += 30) label(azimuth, -1.5, azimuth);
  for (int elevation = -60; elevation <= 60; elevation += 30) {
    if (elevation != 0) label(1.5, elevation + 1.0, elevation);
  }
  for (Marker& marker : array.markers) marker.frame_locked = true;  // the view may turn under them
  return array;
}

MarkerArray fieldOfViewMarkers(Canvas canvas, const FieldOfView& view, const Place& place,
                               const Colour& colour) {
  canvas.frame = view.frame;
  canvas.lifetime = ros::Duration(0.0);
  MarkerArray array;
  array.markers.push_back(lineSheet(canvas, "field of view", 0.2 * sightline::core::kDegree));
  const double step = std::min(kLineStep, view.half_width.minCoeff() / place.count);
  const Directions outline = rectangleOutline({Eigen::Vector2d::Zero(), view.half_width}, step);
  for (std::size_t i = place.index; i + 1 < outline.size(); i += place.count) {
    drawLine(array.markers.back(), canvas, {outline[i], outline[i + 1]}, colour);
  }
  // One below the other: inside the left rim where there is room, else above.
  const bool is_wide = view.half_width.x() > 0.4;
  const double middle =
      is_wide ? 0.0 : view.half_width.y() + (0.5 * static_cast<double>(place.count) + 1.0) * kNameSpacing;
  const double lines_up = 0.5 * static_cast<double>(place.count - 1) - static_cast<double>(place.index);
  const Eigen::Vector2d name(is_wide ? view.half_width.x() - kNameWidth : 0.0,
                             middle + lines_up * kNameSpacing);
  Canvas nearer = canvas;  // in front of whatever lies there
  nearer.radius *= kNameShell;
  array.markers.push_back(
      textMarker(nearer, "name", 0, sightline::core::directionOf(name), view.sensor, kTextHeight, colour));
  for (Marker& marker : array.markers) marker.frame_locked = true;
  return array;
}

}  // namespace sightline_ros
