#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace sightline::core {

/// The ray that falls on a point of the image.
struct LensRay {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< of any length; x right, y down, z along the axis
  Eigen::Matrix<double, 3, 2> jacobian = Eigen::Matrix<double, 3, 2>::Zero();  ///< d direction / d image
};

/// Where a lens images a direction, and which direction it images at a point. The image is that at a focal
/// length of 1, with the axis at (0, 0): (pixel - principal point) / focal length.
///
/// A polynomial of distortion bends back somewhere: two directions then have one image, and outside of the
/// image of that fold nothing is imaged at all. The lens ends at its fold.
class Lens {
 public:
  /// Perspective lens with the distortion of Brown and Conrady (S-101). Coefficients, of which the last ones
  /// may be left out: k1, k2, p1, p2, k3, k4, k5, k6 (radial, the last three below the line), s1, s2, s3, s4
  /// (thin prism), tilt about x and y [rad]. Up to 14.
  static Lens perspective(std::vector<double> coefficients);

  /// Fisheye lens whose image radius is a polynomial of the angle off the axis, up to 180 degrees (S-102).
  /// Coefficients k1, k2, k3, k4, of which the last ones may be left out.
  static Lens equidistant(std::vector<double> coefficients);

  /// The image of a direction of any length; nullopt when it has none: beyond the fold, or behind a
  /// perspective lens.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& direction) const;

  /// The ray that falls on a point of the image, to the last digits (S-103); nullopt when none does.
  std::optional<LensRay> rayAt(const Eigen::Vector2d& image) const;

  /// Off the axis, at which the lens ends [rad]: its fold, 90 degrees (perspective) or 180 (equidistant). The
  /// shifts of tangential, prism and tilt terms are left out here.
  double edgeAngle() const { return edge_angle_; }

  /// Radius of the image of that edge [focal lengths]; infinite for a perspective lens without a fold.
  double edgeRadius() const { return edge_radius_; }

 private:
  enum class Kind { perspective, equidistant };

  /// A point of the undistorted image with its distorted one and d distorted / d undistorted.
  struct Distorted {
    Eigen::Vector2d image = Eigen::Vector2d::Zero();
    Eigen::Matrix2d jacobian = Eigen::Matrix2d::Identity();
  };

  Lens(Kind kind, std::vector<double> coefficients);

  void findEdge();
  double k(std::size_t i) const { return i < coefficients_.size() ? coefficients_[i] : 0.0; }
  bool isRadial() const;
  double radius(double off_axis) const;  // of the image
  double radiusSlope(double off_axis) const;
  std::optional<double> offAxisAt(double radius) const;
  Distorted distort(const Eigen::Vector2d& point) const;
  Distorted tilt(const Eigen::Vector2d& point) const;
  std::optional<Eigen::Vector2d> follow(const Eigen::Vector2d& image) const;
  bool isBeforeFold(const Eigen::Vector2d& point) const;
  LensRay fisheyeRay(const Eigen::Vector2d& image, double off_axis) const;

  Kind kind_;
  std::vector<double> coefficients_;
  // What "off the axis" is measured in: the tangent of the angle (perspective), or the angle (equidistant).
  double edge_off_axis_ = 0.0;
  double edge_angle_ = 0.0, edge_radius_ = 0.0;
  Eigen::Matrix3d tilt_ = Eigen::Matrix3d::Identity();  // of the sensor's plane, as a homography
};

/// Positive real roots of a polynomial c[0] + c[1] x + ... where it changes sign, in ascending order.
std::vector<double> positiveRoots(const std::vector<double>& coefficients);

}  // namespace sightline::core
