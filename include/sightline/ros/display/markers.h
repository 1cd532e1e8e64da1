#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include <Eigen/Core>

#include <ros/duration.h>
#include <sightline/Gate.h>
#include <sightline/Track.h>
#include <visualization_msgs/Marker.h>
#include <visualization_msgs/MarkerArray.h>

#include "sightline/core/model/sphere.h"
#include "sightline/ros/display/display_colours.h"
#include "sightline/ros/display/sphere_shapes.h"

/// Messages as markers on a sphere round the platform. Pure: nothing is kept, no clock is read. Widths,
/// heights and diameters are angles [rad] as seen from the sphere's centre, so that a picture does not depend
/// on the radius. Markers carry time 0: the newest transform serves.
namespace sightline_ros {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

/// Where markers are drawn.
struct Canvas {
  std::string frame = "platform_enu";  ///< its origin is the sphere's centre
  double radius = 10.0;                ///< [m]
  ros::Duration lifetime{1.0};         ///< after which a marker that is not repeated vanishes; 0 = never
};

/// A marker of a type of visualization_msgs/Marker with nothing in it, in the colour of the grid.
Marker emptyMarker(const Canvas& canvas, const std::string& name, int type);

// Empty sheets to draw on: one marker for all things of a kind, so that no thing outlives its report.
Marker lineSheet(const Canvas& canvas, const std::string& name, double width);
Marker dotSheet(const Canvas& canvas, const std::string& name, double diameter);
Marker patchSheet(const Canvas& canvas, const std::string& name);

/// A sheet as it is published: with the action DELETE when nothing was drawn on it.
Marker finished(Marker sheet);

/// A curve, one colour.
void drawLine(Marker& lines, const Canvas& canvas, const Directions& line, const Colour& colour);

/// A curve that gets visible towards its end.
void drawFadingLine(Marker& lines, const Canvas& canvas, const Directions& line, const Colour& colour);

void drawDot(Marker& dots, const Canvas& canvas, const Eigen::Vector3d& direction, const Colour& colour);

/// A cross of two arcs along azimuth and elevation, each 2 `arm` [rad] long.
void drawCross(Marker& lines, const Canvas& canvas, const Eigen::Vector2d& angles, double arm,
               const Colour& colour);

/// The 2-sigma ellipse of a state's position, true to the sphere at any elevation.
void drawUncertainty(Marker& lines, const Canvas& canvas, const sightline::core::AngularState& state,
                     const Colour& colour);

/// Where the state goes within `horizon` [s] at constant angular rates, with its growing 2-sigma ellipse at
/// four instants. Near the zenith the motion goes on through it.
void drawPrediction(Marker& lines, const Canvas& canvas, const sightline::core::AngularState& state,
                    double horizon, const Colour& colour);

/// The paper's rectangle of a gate; nullopt when it is not finite.
std::optional<AngleRectangle> rectangleOf(const sightline::Gate& gate);

/// A rectangle's surface.
void drawPatch(Marker& patches, const Canvas& canvas, const AngleRectangle& rectangle, const Colour& colour);

/// Text that faces the camera, its lower edge's middle at `direction`.
Marker textMarker(const Canvas& canvas, const std::string& name, int id, const Eigen::Vector3d& direction,
                  const std::string& text, double height, const Colour& colour);

/// An angle [rad] in the unit a person would choose, with two digits or more: "1.7 deg", "3.4 mrad", "12
/// urad".
/// With a `scale` [rad] in the unit of that angle, so that the two can be compared.
std::string readableAngle(double angle, std::optional<double> scale = std::nullopt);

/// The track in words: id, status, sigma (the larger half axis of the 1-sigma ellipse), sources by
/// name when they are one or two, else their number.
std::string labelOf(const sightline::Track& track);

/// What happened in a confirmed track's gate: `claimed` says that its last sighting went to another track.
GateOutcome outcomeOf(const sightline::Track& track, bool claimed);

/// The sphere: lines every 30 degrees of azimuth and elevation, horizon stressed, labels in degrees. Lives
/// for ever.
MarkerArray gridMarkers(Canvas canvas);

/// What a sensor can see: |azimuth| <= half_width.x, |elevation| <= half_width.y in the sensor's frame.
struct FieldOfView {
  std::string sensor;
  std::string frame;                                     ///< x forward along the boresight
  Eigen::Vector2d half_width = Eigen::Vector2d::Zero();  ///< [rad]
};

/// One of several sensors whose fields of view may coincide.
struct Place {
  std::size_t index = 0;
  std::size_t count = 1;  ///< > index
};

/// Its outline with the sensor's name, in the sensor's frame: turns with it. Lives for ever. The outlines are
/// dashed and the names stacked so that those of sensors with the same view can all be seen.
MarkerArray fieldOfViewMarkers(Canvas canvas, const FieldOfView& view, const Place& place,
                               const Colour& colour);

}  // namespace sightline_ros
