#include "sightline/ros/display/magnifier.h"

#include <cmath>
#include <cstdio>

namespace sightline_ros {
namespace {

constexpr double kNeededBelow = 0.01;  // [rad]
constexpr double kDistance = 0.8;      // of the inset's centre from the target, beyond its label [rad]

/// The largest of 1, 2, 5, 10, ... that is not above `value`.
double roundDown(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  const double mantissa = value / decade;
  return decade * (mantissa >= 5.0 ? 5.0 : mantissa >= 2.0 ? 2.0 : 1.0);
}

}  // namespace

bool Magnifier::isNeededFor(double two_sigma) {
  return two_sigma < kNeededBelow;
}

double Magnifier::factorFor(double two_sigma, double previous) {
  const double filled = two_sigma * previous / kRadius;
  if (filled >= 0.1 && filled <= 0.7) return previous;
  return roundDown(0.35 * kRadius / two_sigma);
}

Magnifier::Magnifier(const Eigen::Vector2d& target, const Eigen::Vector2d& side, double factor)
    : target_(target), centre_(sightline::core::anglesOf(walk(target, kDistance * side))), factor_(factor) {}

Eigen::Vector2d Magnifier::place(const Eigen::Vector3d& direction, const Eigen::Vector2d& target_then) const {
  const Eigen::Vector2d offset = tangentTo(target_then, direction);
  const Eigen::Vector2d magnified = factor_ * offset;
  // Beyond half a turn a walk would come round again.
  const double length = magnified.norm();
  return sightline::core::anglesOf(walk(centre_, length > 3.0 ? 3.0 / length * magnified : magnified));
}

bool Magnifier::shows(const Eigen::Vector2d& place) const {
  return sightline::core::angleBetween(sightline::core::directionOf(place),
                                       sightline::core::directionOf(centre_)) <= kRadius;
}

Eigen::Matrix2d Magnifier::magnified(const Eigen::Vector2d& angles, const Eigen::Matrix2d& covariance) const {
  return factor_ * factor_ * tangentCovariance(angles, covariance);
}

void Magnifier::drawEllipse(Marker& lines, const Canvas& canvas, const Eigen::Vector2d& place,
                            const Eigen::Matrix2d& covariance, const Colour& colour) const {
  const Directions outline = ellipseOutline(place, covariance, 2.0);
  for (std::size_t i = 0; i + 1 < outline.size(); ++i) {
    if (!shows(sightline::core::anglesOf(outline[i]))) continue;
    drawLine(lines, canvas, {outline[i], outline[i + 1]}, colour);
  }
}

void Magnifier::drawRim(Marker& lines, const Canvas& canvas, const Colour& colour) const {
  drawLine(lines, canvas, circleOutline(centre_, kRadius), colour);
  const Eigen::Vector2d to_target = tangentTo(centre_, sightline::core::directionOf(target_));
  drawLine(lines, canvas,
           {walk(centre_, kRadius / to_target.norm() * to_target), sightline::core::directionOf(target_)},
           colour);
}

Marker Magnifier::label(const Canvas& canvas, const Colour& colour) const {
  char factor[32];
  std::snprintf(factor, sizeof(factor), "x %.0f", factor_);
  const std::string text = std::string(factor) + ", radius " + readableAngle(kRadius / factor_);
  const Eigen::Vector2d away = -tangentTo(centre_, sightline::core::directionOf(target_)).normalized();
  return textMarker(canvas, "magnification", 0, walk(centre_, (kRadius + 0.06) * away), text, 0.045, colour);
}

}  // namespace sightline_ros
