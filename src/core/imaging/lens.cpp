#include "sightline/core/imaging/lens.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kFarthest = 1e15;      // tangent of an angle off the axis; beyond, it is 90 degrees
constexpr int kSolveSteps = 200;        // bisection alone needs 53 and the exponent
constexpr int kNewtonSteps = 12;        // of one step along the way from the centre
constexpr double kFirstStep = 0.125;    // of that way
constexpr double kShortestStep = 1e-6;  // of that way: shorter ones end at the fold
constexpr double kHit = 1e-14;          // miss of a point in the image, relative to 1 and its radius
constexpr int kSamples = 32;            // along the way, for the sign of the determinant

double valueOf(const std::vector<double>& c, double x) {
  double value = 0.0;
  for (std::size_t i = c.size(); i-- > 0;) value = value * x + c[i];
  return value;
}

std::vector<double> derivativeOf(const std::vector<double>& c) {
  std::vector<double> d;
  for (std::size_t i = 1; i < c.size(); ++i) d.push_back(static_cast<double>(i) * c[i]);
  return d;
}

std::vector<double> product(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> c(a.size() + b.size() - 1, 0.0);
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) c[i + j] += a[i] * b[j];
  return c;
}

/// The change of sign of a continuous function between `low` and `high`, to the last digit.
double bisect(const std::vector<double>& c, double low, double high) {
  const bool low_is_negative = valueOf(c, low) < 0.0;
  for (;;) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return middle;
    (valueOf(c, middle) < 0.0) == low_is_negative ? low = middle : high = middle;
  }
}

double firstOf(const std::vector<double>& roots) {
  return roots.empty() ? kInfinite : roots.front();
}

}  // namespace

std::vector<double> positiveRoots(const std::vector<double>& coefficients) {
  std::vector<double> c = coefficients;
  while (!c.empty() && c.back() == 0.0) c.pop_back();
  if (c.size() < 2) return {};
  double bound = 0.0;  // Cauchy's: no root is larger
  for (const double value : c) bound = std::max(bound, std::abs(value / c.back()));
  // Between two neighbouring extremes there is at most one root.
  std::vector<double> borders = {0.0};
  for (const double extreme : positiveRoots(derivativeOf(c))) borders.push_back(extreme);
  borders.push_back(std::min(1.0 + bound, std::max(1e100, 2.0 * borders.back())));
  std::vector<double> roots;
  for (std::size_t i = 0; i + 1 < borders.size(); ++i) {
    if ((valueOf(c, borders[i]) < 0.0) != (valueOf(c, borders[i + 1]) < 0.0)) {
      roots.push_back(bisect(c, borders[i], borders[i + 1]));
    }
  }
  return roots;
}

Lens Lens::perspective(std::vector<double> coefficients) {
  return {Kind::perspective, std::move(coefficients)};
}

Lens Lens::equidistant(std::vector<double> coefficients) {
  return {Kind::equidistant, std::move(coefficients)};
}

Lens::Lens(Kind kind, std::vector<double> coefficients)
    : kind_(kind), coefficients_(std::move(coefficients)) {
  if (kind_ == Kind::perspective && (k(12) != 0.0 || k(13) != 0.0)) {  // (S-101), tilt
    const double cx = std::cos(k(12)), sx = std::sin(k(12)), cy = std::cos(k(13)), sy = std::sin(k(13));
    Eigen::Matrix3d about_x, about_y, onto_plane;
    about_x << 1.0, 0.0, 0.0, 0.0, cx, sx, 0.0, -sx, cx;
    about_y << cy, 0.0, -sy, 0.0, 1.0, 0.0, sy, 0.0, cy;
    const Eigen::Matrix3d R = about_y * about_x;
    onto_plane << R(2, 2), 0.0, -R(0, 2), 0.0, R(2, 2), -R(1, 2), 0.0, 0.0, 1.0;
    tilt_ = onto_plane * R;
  }
  findEdge();
}

/// Where the image's radius stops growing: at the first root of its slope (S-101), (S-102), or at a pole.
void Lens::findEdge() {
  double first = kInfinite;  // in squares of what is off the axis
  if (kind_ == Kind::equidistant) {
    first = firstOf(positiveRoots({1.0, 3.0 * k(0), 5.0 * k(1), 7.0 * k(2), 9.0 * k(3)}));
    edge_off_axis_ = std::min(std::sqrt(first), kPi);
    edge_angle_ = edge_off_axis_;
  } else {
    const std::vector<double> above = {1.0, k(0), k(1), k(4)}, below = {1.0, k(5), k(6), k(7)};
    const std::vector<double> s = {0.0, 2.0};
    std::vector<double> slope = product(above, below);
    const std::vector<double> grows = product(s, product(derivativeOf(above), below));
    const std::vector<double> shrinks = product(s, product(above, derivativeOf(below)));
    for (std::size_t i = 0; i < slope.size(); ++i) slope[i] += grows[i] - shrinks[i];
    first = std::min(firstOf(positiveRoots(slope)), firstOf(positiveRoots(below)));
    edge_off_axis_ = std::sqrt(first);
    edge_angle_ = std::atan(edge_off_axis_);
  }
  edge_radius_ = edge_off_axis_ < kInfinite ? radius(edge_off_axis_) : kInfinite;
  if (!std::isfinite(edge_radius_)) edge_radius_ = kInfinite;
}

bool Lens::isRadial() const {
  if (kind_ == Kind::equidistant) return true;
  for (const std::size_t i : {2, 3, 8, 9, 10, 11}) {
    if (k(i) != 0.0) return false;
  }
  return true;
}

double Lens::radius(double off_axis) const {
  const double s = off_axis * off_axis;
  if (kind_ == Kind::equidistant) {  // (S-102)
    return off_axis * (1.0 + s * (k(0) + s * (k(1) + s * (k(2) + s * k(3)))));
  }
  return off_axis * (1.0 + s * (k(0) + s * (k(1) + s * k(4)))) /
         (1.0 + s * (k(5) + s * (k(6) + s * k(7))));  // (S-101)
}

double Lens::radiusSlope(double off_axis) const {
  const double s = off_axis * off_axis;
  if (kind_ == Kind::equidistant) {
    return 1.0 + s * (3.0 * k(0) + s * (5.0 * k(1) + s * (7.0 * k(2) + s * 9.0 * k(3))));
  }
  const double above = 1.0 + s * (k(0) + s * (k(1) + s * k(4)));
  const double below = 1.0 + s * (k(5) + s * (k(6) + s * k(7)));
  const double above_slope = k(0) + s * (2.0 * k(1) + s * 3.0 * k(4));
  const double below_slope = k(5) + s * (2.0 * k(6) + s * 3.0 * k(7));
  return (above + 2.0 * s * above_slope) / below - 2.0 * s * above * below_slope / (below * below);
}

/// (S-103): the radius grows up to the edge, so that there is one solution; Newton's steps within a bracket.
std::optional<double> Lens::offAxisAt(double image_radius) const {
  if (!(image_radius <= edge_radius_)) return std::nullopt;
  double low = 0.0, high = std::min(edge_off_axis_, std::max(2.0 * image_radius, 1.0));
  while (high < edge_off_axis_ && radius(high) < image_radius) {
    low = high;
    high = std::min(2.0 * high, edge_off_axis_);
    if (high > kFarthest) return std::nullopt;
  }
  double guess = std::clamp(image_radius, low, high);
  for (int step = 0; step < kSolveSteps; ++step) {
    const double miss = radius(guess) - image_radius;
    miss > 0.0 ? high = guess : low = guess;
    double next = guess - miss / radiusSlope(guess);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const bool is_there = std::abs(next - guess) <= kEpsilon * std::abs(next);
    guess = next;
    if (is_there) break;
  }
  return guess;
}

std::optional<Eigen::Vector2d> Lens::project(const Eigen::Vector3d& direction) const {
  if (!direction.allFinite() || direction.isZero(0.0)) return std::nullopt;
  if (kind_ == Kind::equidistant) {
    const double across = std::hypot(direction.x(), direction.y());
    const double angle = std::atan2(across, direction.z());
    if (angle > edge_off_axis_) return std::nullopt;
    if (across == 0.0) return Eigen::Vector2d::Zero();
    return Eigen::Vector2d(radius(angle) / across * direction.head<2>());
  }
  if (!(direction.z() > 0.0)) return std::nullopt;
  const Eigen::Vector2d point = direction.head<2>() / direction.z();
  if (isRadial() ? point.norm() > edge_off_axis_ : !isBeforeFold(point)) return std::nullopt;
  return tilt(distort(point).image).image;
}

std::optional<LensRay> Lens::rayAt(const Eigen::Vector2d& image) const {
  if (!(image.stableNorm() <= kFarthest)) return std::nullopt;
  if (kind_ == Kind::equidistant) {
    const auto off_axis = offAxisAt(image.norm());
    if (!off_axis) return std::nullopt;
    return fisheyeRay(image, *off_axis);
  }
  const Eigen::Vector3d straight = tilt_.inverse() * image.homogeneous();
  if (!(straight.z() > 0.0)) return std::nullopt;
  const Eigen::Vector2d upright = straight.hnormalized();
  Eigen::Vector2d point = upright;
  if (isRadial()) {
    const double image_radius = upright.norm();
    const auto off_axis = offAxisAt(image_radius);
    if (!off_axis) return std::nullopt;
    if (image_radius > 0.0) point = upright * (*off_axis / image_radius);
  } else {
    const auto followed = follow(upright);
    if (!followed) return std::nullopt;
    point = *followed;
  }
  const Eigen::Matrix2d J = tilt(upright).jacobian * distort(point).jacobian;
  if (!(J.determinant() > 0.0)) return std::nullopt;
  LensRay ray;
  ray.direction = point.homogeneous();
  ray.jacobian.topRows<2>() = J.inverse();
  return ray;
}

LensRay Lens::fisheyeRay(const Eigen::Vector2d& image, double off_axis) const {
  const double image_radius = image.norm();
  const Eigen::Vector2d outward =
      image_radius > 0.0 ? Eigen::Vector2d(image / image_radius) : Eigen::Vector2d::UnitX();
  const Eigen::Vector2d round(-outward.y(), outward.x());
  LensRay ray;
  ray.direction << std::sin(off_axis) * outward, std::cos(off_axis);
  Eigen::Vector3d along, across;  // of the unit sphere: away from the axis, and round it
  along << std::cos(off_axis) * outward, -std::sin(off_axis);
  across << round, 0.0;
  // At the fold the slope is 0, and a pixel there says nothing of the angle: the variance is huge, not
  // infinite.
  const double slope = std::max(radiusSlope(off_axis), kEpsilon);
  const double stretch = image_radius > 0.0 ? std::sin(off_axis) / image_radius : 1.0;
  ray.jacobian = along * outward.transpose() / slope + stretch * across * round.transpose();
  return ray;
}

/// (S-101), but for the tilt.
Lens::Distorted Lens::distort(const Eigen::Vector2d& point) const {
  const double x = point.x(), y = point.y(), s = point.squaredNorm();
  const double above = 1.0 + s * (k(0) + s * (k(1) + s * k(4)));
  const double below = 1.0 + s * (k(5) + s * (k(6) + s * k(7)));
  const double above_slope = k(0) + s * (2.0 * k(1) + s * 3.0 * k(4));
  const double below_slope = k(5) + s * (2.0 * k(6) + s * 3.0 * k(7));
  const double g = above / below, g_slope = (above_slope - g * below_slope) / below;
  const double p1 = k(2), p2 = k(3);
  const Eigen::Vector2d shift(2.0 * p1 * x * y + p2 * (s + 2.0 * x * x) + s * (k(8) + s * k(9)),
                              p1 * (s + 2.0 * y * y) + 2.0 * p2 * x * y + s * (k(10) + s * k(11)));
  Distorted out;
  out.image = g * point + shift;
  out.jacobian = g * Eigen::Matrix2d::Identity() + 2.0 * g_slope * point * point.transpose();
  const Eigen::Vector2d prism(k(8) + 2.0 * s * k(9), k(10) + 2.0 * s * k(11));
  out.jacobian += 2.0 * prism * point.transpose();
  Eigen::Matrix2d tangential;
  tangential << p1 * y + 3.0 * p2 * x, p1 * x + p2 * y, p1 * x + p2 * y, 3.0 * p1 * y + p2 * x;
  out.jacobian += 2.0 * tangential;
  return out;
}

Lens::Distorted Lens::tilt(const Eigen::Vector2d& point) const {
  const Eigen::Vector3d p = tilt_ * point.homogeneous();
  Distorted out;
  out.image = p.hnormalized();
  out.jacobian = (tilt_.topLeftCorner<2, 2>() - out.image * tilt_.bottomLeftCorner<1, 2>()) / p.z();
  return out;
}

/// (S-103): from the centre, where image and undistorted image agree, in steps that Newton's method mends.
/// The determinant stays positive all the way, so that the way does not cross the fold.
std::optional<Eigen::Vector2d> Lens::follow(const Eigen::Vector2d& image) const {
  const double hit = kHit * (1.0 + image.norm());
  Eigen::Vector2d here = Eigen::Vector2d::Zero();
  double way = 0.0, step = kFirstStep;
  while (way < 1.0) {
    if (step < kShortestStep) return std::nullopt;
    const double next_way = std::min(way + step, 1.0);
    const Eigen::Vector2d wanted = next_way * image;
    Eigen::Vector2d there = here;
    double last_miss = kInfinite;
    bool is_hit = false, is_lost = false;
    for (int i = 0; i < kNewtonSteps && !is_hit && !is_lost; ++i) {
      const Distorted distorted = distort(there);
      const Eigen::Vector2d miss = wanted - distorted.image;
      is_lost = !(distorted.jacobian.determinant() > 0.0) || !(miss.norm() < last_miss);
      // What no longer gets better has all the digits there are.
      is_hit = miss.norm() <= hit || (is_lost && last_miss <= 100.0 * hit);
      if (is_hit || is_lost) break;
      last_miss = miss.norm();
      there += distorted.jacobian.inverse() * miss;
    }
    if (is_hit && isBeforeFold(there)) {
      here = there;
      way = next_way;
      step *= 2.0;
    } else {
      step *= 0.5;
    }
  }
  return here;
}

bool Lens::isBeforeFold(const Eigen::Vector2d& point) const {
  for (int i = 1; i <= kSamples; ++i) {
    const Eigen::Matrix2d J = distort(point * (static_cast<double>(i) / kSamples)).jacobian;
    if (!(J.determinant() > 0.0) || !(J.trace() > 0.0)) return false;
  }
  return true;
}

}  // namespace sightline::core
