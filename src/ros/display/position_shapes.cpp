#include "sightline/ros/display/position_shapes.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "sightline/core/model/sphere.h"
#include "sightline/ros/display/markers.h"

namespace sightline_ros {
namespace {

constexpr int kRimSteps = 8;            // of each side of a field of view
constexpr double kVisible = 0.012;      // half axis of an ellipsoid that can be seen, as a share of the size
constexpr double kFaceOpacity = 0.05;   // of a field of view
constexpr double kMostEnlarged = 1e6;   // [1]
constexpr double kSmallestAxis = 1e-6;  // of an ellipsoid, as a share of the size
constexpr double kLargestAxis = 3.0;    // likewise

/// Sheets are as large as the scene, as those of the sphere are as large as its radius.
Canvas sheetsOf(const MetricCanvas& canvas) {
  return {canvas.frame, canvas.size, canvas.lifetime};
}

geometry_msgs::Point pointOf(const Eigen::Vector3d& place) {
  geometry_msgs::Point point;
  point.x = place.x();
  point.y = place.y();
  point.z = place.z();
  return point;
}

void setOrientation(Marker& marker, const Eigen::Quaterniond& turn) {
  marker.pose.orientation.x = turn.x();
  marker.pose.orientation.y = turn.y();
  marker.pose.orientation.z = turn.z();
  marker.pose.orientation.w = turn.w();
}

}  // namespace

Marker metricLines(const MetricCanvas& canvas, const std::string& name, double width) {
  return lineSheet(sheetsOf(canvas), name, width);
}

Marker metricDots(const MetricCanvas& canvas, const std::string& name, double diameter) {
  return dotSheet(sheetsOf(canvas), name, diameter);
}

Marker metricFaces(const MetricCanvas& canvas, const std::string& name) {
  return patchSheet(sheetsOf(canvas), name);
}

void drawSegment(Marker& lines, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                 const Colour& colour) {
  for (const Eigen::Vector3d& end : {from, to}) drawPoint(lines, end, colour);
}

void drawPoint(Marker& dots, const Eigen::Vector3d& place, const Colour& colour) {
  dots.points.push_back(pointOf(place));
  dots.colors.push_back(colour);
}

void drawFadingPath(Marker& lines, const std::vector<Eigen::Vector3d>& path, const Colour& colour) {
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const double share = static_cast<double>(i + 1) / static_cast<double>(path.size());
    drawSegment(lines, path[i], path[i + 1], dimmed(colour, share));
  }
}

void drawStar(Marker& lines, const Eigen::Vector3d& place, double arm, const Colour& colour) {
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d along = arm * Eigen::Vector3d::Unit(axis);
    drawSegment(lines, place - along, place + along, colour);
  }
}

void drawCrossOut(Marker& lines, const Eigen::Vector3d& place, double arm, const Colour& colour) {
  const double s = arm * std::sqrt(0.5);
  for (const Eigen::Vector3d& along : {Eigen::Vector3d(s, 0.0, s), Eigen::Vector3d(-s, 0.0, s),
                                       Eigen::Vector3d(0.0, s, s), Eigen::Vector3d(0.0, -s, s)})
    drawSegment(lines, place - along, place + along, colour);
}

void drawFieldOfView(Marker& lines, Marker& faces, const MetricCanvas& canvas, const StationView& view,
                     const Colour& colour) {
  const auto at = [&](double x, double y) -> Eigen::Vector3d {
    const Eigen::Vector2d angles(x * view.half_width.x(), y * view.half_width.y());
    return view.origin +
           kViewLength * canvas.size * view.R_metric_sensor * sightline::core::directionOf(angles);
  };
  const Eigen::Vector2d corners[5] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}, {1, 1}};
  const Colour face = withAlpha(colour, kFaceOpacity);
  for (int side = 0; side < 4; ++side) {
    drawSegment(lines, view.origin, at(corners[side].x(), corners[side].y()), dimmed(colour, 0.6));
    for (int step = 0; step < kRimSteps; ++step) {
      const Eigen::Vector2d a = corners[side] + step * (corners[side + 1] - corners[side]) / kRimSteps;
      const Eigen::Vector2d b = corners[side] + (step + 1) * (corners[side + 1] - corners[side]) / kRimSteps;
      const Eigen::Vector3d from = at(a.x(), a.y()), to = at(b.x(), b.y());
      drawSegment(lines, from, to, colour);
      for (const Eigen::Vector3d& corner : {view.origin, from, to}) drawPoint(faces, corner, face);
    }
  }
}

Marker ellipsoidMarker(const MetricCanvas& canvas, const std::string& name, int id,
                       const Eigen::Vector3d& centre, const Eigen::Matrix3d& covariance, double sigmas,
                       const Colour& colour) {
  Marker marker = emptyMarker(sheetsOf(canvas), name, Marker::SPHERE);
  marker.id = id;
  marker.pose.position = pointOf(centre);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  Eigen::Matrix3d axes = solver.eigenvectors();
  if (axes.determinant() < 0.0) axes.col(0) *= -1.0;
  setOrientation(marker, Eigen::Quaterniond(axes));
  const Eigen::Vector3d diameters = 2.0 * sigmas * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  const auto bounded = [&](double diameter) {
    return std::clamp(diameter, kSmallestAxis * canvas.size, kLargestAxis * canvas.size);
  };
  marker.scale.x = bounded(diameters.x());
  marker.scale.y = bounded(diameters.y());
  marker.scale.z = bounded(diameters.z());
  marker.color = colour;
  return marker;
}

Marker arrowMarker(const MetricCanvas& canvas, const std::string& name, int id, const Eigen::Vector3d& from,
                   const Eigen::Vector3d& step, const Colour& colour) {
  Marker marker = emptyMarker(sheetsOf(canvas), name, Marker::ARROW);
  marker.id = id;
  marker.points = {pointOf(from), pointOf(from + step)};
  marker.scale.x = 0.004 * canvas.size;  // of the shaft
  marker.scale.y = 0.012 * canvas.size;  // of the head
  marker.scale.z = 0.018 * canvas.size;  // its length
  marker.color = colour;
  return marker;
}

Marker boxMarker(const MetricCanvas& canvas, const std::string& name, int id, const Eigen::Vector3d& low,
                 const Eigen::Vector3d& high, const Colour& colour) {
  Marker marker = emptyMarker(sheetsOf(canvas), name, Marker::CUBE);
  marker.id = id;
  marker.pose.position = pointOf(0.5 * (low + high));
  marker.scale.x = high.x() - low.x();
  marker.scale.y = high.y() - low.y();
  marker.scale.z = high.z() - low.z();
  marker.color = colour;
  return marker;
}

Marker metricText(const MetricCanvas& canvas, const std::string& name, int id, const Eigen::Vector3d& place,
                  const std::string& text, double height, const Colour& colour) {
  Marker marker = emptyMarker(sheetsOf(canvas), name, Marker::TEXT_VIEW_FACING);
  marker.id = id;
  marker.pose.position = pointOf(place);
  marker.scale.z = height * canvas.size;
  marker.color = colour;
  marker.text = text;
  return marker;
}

double enlargementFor(double sigma, double size, double before) {
  if (!(sigma > 0.0) || !(size > 0.0)) return before > 0.0 ? before : 1.0;
  const double wanted = std::clamp(kVisible * size / sigma, 1.0, kMostEnlarged);
  // What served goes on until it is off by a factor of three: it must not flicker.
  if (before > 0.0 && wanted < 3.0 * before && wanted > before / 3.0) return before;
  const double decade = std::pow(10.0, std::floor(std::log10(wanted)));
  const double share = wanted / decade;
  return decade * (share < 2.0 ? 1.0 : share < 5.0 ? 2.0 : 5.0);
}

std::string readableLength(double length) {
  struct Unit {
    double size;
    const char* name;
  };
  const double magnitude = std::abs(length);
  const Unit unit = magnitude >= 995.0     ? Unit{1e3, "km"}
                    : magnitude >= 0.995   ? Unit{1.0, "m"}
                    : magnitude >= 0.00995 ? Unit{1e-2, "cm"}
                                           : Unit{1e-3, "mm"};
  const double value = length / unit.size;
  char text[48];
  std::snprintf(text, sizeof(text), std::abs(value) < 9.95 ? "%.1f %s" : "%.0f %s", value, unit.name);
  return text;
}

}  // namespace sightline_ros
