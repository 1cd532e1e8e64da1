#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include <ros/duration.h>
#include <visualization_msgs/Marker.h>
#include <visualization_msgs/MarkerArray.h>

#include "sightline/ros/display/display_colours.h"

/// Stations, rays and positions as markers in a metric frame. Pure: nothing is kept, no clock is read.
/// Widths, heights and diameters are shares of the scene's size, so that a picture does not depend on it.
namespace sightline_ros {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

/// Where markers are drawn, and how large the scene is.
struct MetricCanvas {
  std::string frame = "world";
  double size = 100.0;          ///< of the scene, about the distance of its stations [m]
  ros::Duration lifetime{1.0};  ///< after which a marker that is not repeated vanishes; 0 = never
};

/// A sensor where it stands, with what it can see.
struct StationView {
  std::string sensor;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Matrix3d R_metric_sensor = Eigen::Matrix3d::Identity();
  Eigen::Vector2d half_width = Eigen::Vector2d::Zero();  ///< of azimuth and elevation [rad]
};

/// How far from a station its field of view and its sightings are drawn, as a share of the scene's size.
inline constexpr double kViewLength = 0.2;

// Empty sheets to draw on: one marker for all things of a kind, so that no thing outlives its report.
Marker metricLines(const MetricCanvas& canvas, const std::string& name, double width);
Marker metricDots(const MetricCanvas& canvas, const std::string& name, double diameter);
Marker metricFaces(const MetricCanvas& canvas, const std::string& name);

void drawSegment(Marker& lines, const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Colour& colour);
void drawPoint(Marker& dots, const Eigen::Vector3d& place, const Colour& colour);

/// A path that gets visible towards its end.
void drawFadingPath(Marker& lines, const std::vector<Eigen::Vector3d>& path, const Colour& colour);

/// Three lines along the axes, each 2 `arm` [m] long.
void drawStar(Marker& lines, const Eigen::Vector3d& place, double arm, const Colour& colour);

/// Two lines across each other and across up, as a letter X, each 2 `arm` [m] long, and a third one upright.
void drawCrossOut(Marker& lines, const Eigen::Vector3d& place, double arm, const Colour& colour);

/// The field of view as a pyramid with a rim that lies on a sphere round the station.
void drawFieldOfView(Marker& lines, Marker& faces, const MetricCanvas& canvas, const StationView& view,
                     const Colour& colour);

/// The ellipsoid of `sigmas` standard deviations of a covariance [m^2].
Marker ellipsoidMarker(const MetricCanvas& canvas, const std::string& name, int id,
                       const Eigen::Vector3d& centre, const Eigen::Matrix3d& covariance, double sigmas,
                       const Colour& colour);

/// An arrow from a place along `step` [m].
Marker arrowMarker(const MetricCanvas& canvas, const std::string& name, int id, const Eigen::Vector3d& from,
                   const Eigen::Vector3d& step, const Colour& colour);

/// A box with sides along the axes.
Marker boxMarker(const MetricCanvas& canvas, const std::string& name, int id, const Eigen::Vector3d& low,
                 const Eigen::Vector3d& high, const Colour& colour);

/// Text that faces the camera.
Marker metricText(const MetricCanvas& canvas, const std::string& name, int id, const Eigen::Vector3d& place,
                  const std::string& text, double height, const Colour& colour);

/// By how much ellipsoids are enlarged so that one of `sigma` [m] can be seen in a scene: 1, 2, 5, 10, 20, 50
/// and so on; what it was before, while that still serves (0 = there was none).
double enlargementFor(double sigma, double size, double before);

/// A length [m] as a person would say it: "4 mm", "6 cm", "1.2 m", "3.4 km".
std::string readableLength(double length);

}  // namespace sightline_ros
