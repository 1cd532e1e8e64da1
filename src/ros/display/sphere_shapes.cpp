#include "sightline/ros/display/sphere_shapes.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "sightline/core/model/sphere.h"

namespace sightline_ros {
namespace {

constexpr double kPoleDistance = 1e-9;  // as in core::anglesJacobian
constexpr int kMaxPatchSteps = 24;

/// The rectangle's lower and upper corner (azimuth, elevation) [rad]; azimuths not wrapped.
struct Corners {
  Eigen::Vector2d low, high;
};

Corners cornersOf(const AngleRectangle& rectangle) {
  const double half_azimuth = std::clamp(rectangle.half_width.x(), 0.0, sightline::core::kPi);
  const double half_elevation = std::max(rectangle.half_width.y(), 0.0);
  const Eigen::Vector2d& c = rectangle.centre;
  return {{c.x() - half_azimuth,
           std::clamp(c.y() - half_elevation, -sightline::core::kPi / 2.0, sightline::core::kPi / 2.0)},
          {c.x() + half_azimuth,
           std::clamp(c.y() + half_elevation, -sightline::core::kPi / 2.0, sightline::core::kPi / 2.0)}};
}

int stepsOf(double length, double step) {
  return std::max(1, static_cast<int>(std::ceil(std::abs(length) / step)));
}

void append(Directions& line, const Directions& more) {
  line.insert(line.end(), more.begin(), more.end());
}

}  // namespace

Eigen::Matrix<double, 3, 2> tangentBasis(const Eigen::Vector2d& angles) {
  const double ca = std::cos(angles.x()), sa = std::sin(angles.x());
  const double ce = std::cos(angles.y()), se = std::sin(angles.y());
  Eigen::Matrix<double, 3, 2> basis;
  basis << -sa, -se * ca,  //
      ca, -se * sa,        //
      0.0, ce;
  return basis;
}

Eigen::Vector3d walk(const Eigen::Vector2d& angles, const Eigen::Vector2d& tangent) {
  const double length = tangent.norm();
  Eigen::Vector3d start = sightline::core::directionOf(angles);
  if (length == 0.0) return start;
  return std::cos(length) * start + (std::sin(length) / length) * (tangentBasis(angles) * tangent);
}

Eigen::Vector2d tangentTo(const Eigen::Vector2d& angles, const Eigen::Vector3d& direction) {
  const Eigen::Vector2d sideways = tangentBasis(angles).transpose() * direction;
  const double forward = sightline::core::directionOf(angles).dot(direction);
  const double length = sideways.norm();
  if (length == 0.0)
    return forward >= 0.0 ? Eigen::Vector2d(0.0, 0.0) : Eigen::Vector2d(0.0, sightline::core::kPi);
  return sideways * (std::atan2(length, forward) / length);
}

Eigen::Matrix2d tangentCovariance(const Eigen::Vector2d& angles, const Eigen::Matrix2d& covariance) {
  const Eigen::Vector2d scale(std::max(std::abs(std::cos(angles.y())), kPoleDistance), 1.0);
  return sightline::core::symmetric(scale.asDiagonal() * covariance * scale.asDiagonal());
}

Eigen::Vector2d semiAxes(const Eigen::Matrix2d& covariance) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
  eigen.computeDirect(covariance, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().reverse();
}

Directions ellipseOutline(const Eigen::Vector2d& angles, const Eigen::Matrix2d& tangent_covariance,
                          double sigmas, int corners) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
  eigen.computeDirect(tangent_covariance);
  const Eigen::Vector2d half_axes =
      (sigmas * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt()).cwiseMin(sightline::core::kPi / 2.0);
  Directions outline;
  outline.reserve(static_cast<std::size_t>(corners) + 1);
  for (int i = 0; i <= corners; ++i) {
    const double turn = 2.0 * sightline::core::kPi * (i % corners) / corners;
    const Eigen::Vector2d along_axes(half_axes.x() * std::cos(turn), half_axes.y() * std::sin(turn));
    outline.push_back(walk(angles, eigen.eigenvectors() * along_axes));
  }
  return outline;
}

Directions circleOutline(const Eigen::Vector2d& angles, double radius, int corners) {
  return ellipseOutline(angles, radius * radius * Eigen::Matrix2d::Identity(), 1.0, corners);
}

Directions gridLine(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double step) {
  const int steps = stepsOf((to - from).cwiseAbs().maxCoeff(), step);
  Directions line;
  line.reserve(static_cast<std::size_t>(steps) + 1);
  for (int i = 0; i <= steps; ++i) {
    line.push_back(sightline::core::directionOf(from + (to - from) * (static_cast<double>(i) / steps)));
  }
  return line;
}

Directions rectangleOutline(const AngleRectangle& rectangle, double step) {
  const auto [low, high] = cornersOf(rectangle);
  const Eigen::Vector2d right_low(high.x(), low.y()), left_high(low.x(), high.y());
  Directions outline = gridLine(low, right_low, step);
  append(outline, gridLine(right_low, high, step));
  append(outline, gridLine(high, left_high, step));
  append(outline, gridLine(left_high, low, step));
  return outline;
}

Directions rectanglePatch(const AngleRectangle& rectangle, double step) {
  const auto [low, high] = cornersOf(rectangle);
  const Eigen::Vector2d size = high - low;
  const int columns = std::min(stepsOf(size.x(), step), kMaxPatchSteps);
  const int rows = std::min(stepsOf(size.y(), step), kMaxPatchSteps);
  const auto corner = [&, low = low](int column, int row) {
    return sightline::core::directionOf(low +
                                        Eigen::Vector2d(size.x() * column / columns, size.y() * row / rows));
  };
  Directions triangles;
  triangles.reserve(6 * static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for (int column = 0; column < columns; ++column) {
    for (int row = 0; row < rows; ++row) {
      const Eigen::Vector3d a = corner(column, row), b = corner(column + 1, row);
      const Eigen::Vector3d c = corner(column + 1, row + 1), d = corner(column, row + 1);
      for (const Eigen::Vector3d& vertex : {a, b, c, a, c, d}) triangles.push_back(vertex);
    }
  }
  return triangles;
}

}  // namespace sightline_ros
