#include "sightline/core/positions/rays.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

using Matrix23d = Eigen::Matrix<double, 2, 3>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double kLeastSine = 1e-7;       // [1] sine of the parallax below which two rays count as parallel
constexpr int kMostIterations = 50;       // of Gauss-Newton; it takes three to six on rays that agree
constexpr double kStepTolerance = 1e-10;  // of a step relative to the range
constexpr double kLeastPivot = 1e-14;     // of the information, relative to its largest

/// Covariance across the ray, over the basis `B`.
Eigen::Matrix2d acrossCovariance(const Matrix23d& B, const Eigen::Matrix3d& C) {
  return symmetric(B * C * B.transpose());
}

bool isPositiveDefinite(const Eigen::Matrix2d& C) {
  return C.allFinite() && C(0, 0) > 0.0 && C.determinant() > 0.0;
}

bool isUsable(const Ray& ray) {
  if (!isDetermined(ray)) return false;
  if (!ray.motion) return true;
  const Matrix23d B = acrossBasis(ray.direction);
  return ray.motion->rate.allFinite() && ray.motion->origin_velocity.allFinite() &&
         isPositiveDefinite(acrossCovariance(B, ray.motion->covariance));
}

/// The points of two lines nearest to each other, as distances along them.
struct Perpendicular {
  double sine_squared = 0.0, along_a = 0.0, along_b = 0.0;
};

Perpendicular commonPerpendicular(const Ray& a, const Ray& b) {
  const Eigen::Vector3d between = b.origin - a.origin;
  const Eigen::Vector3d normal = a.direction.cross(b.direction);
  Perpendicular p;
  p.sine_squared = normal.squaredNorm();
  if (p.sine_squared < kLeastSine * kLeastSine) return p;
  p.along_a = between.cross(b.direction).dot(normal) / p.sine_squared;
  p.along_b = between.cross(a.direction).dot(normal) / p.sine_squared;
  return p;
}

/// Mean of the midpoints of all pairs that cross ahead, those of large parallax counting most.
struct Start {
  CrossingVerdict verdict = CrossingVerdict::parallel;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
};

Start startOf(const std::vector<Ray>& rays) {
  Start start;
  double weights = 0.0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    for (std::size_t j = i + 1; j < rays.size(); ++j) {
      const Perpendicular p = commonPerpendicular(rays[i], rays[j]);
      if (p.sine_squared < kLeastSine * kLeastSine) continue;
      if (!(p.along_a > 0.0 && p.along_b > 0.0)) {
        if (weights == 0.0) start.verdict = CrossingVerdict::behind;
        continue;
      }
      const double weight = p.sine_squared / (p.along_a * p.along_a + p.along_b * p.along_b);
      start.point +=
          weight * 0.5 *
          (rays[i].origin + p.along_a * rays[i].direction + rays[j].origin + p.along_b * rays[j].direction);
      weights += weight;
      start.verdict = CrossingVerdict::crossing;
    }
  }
  if (weights > 0.0) start.point /= weights;
  return start;
}

/// Information of the rays about (point, velocity), gradient and loss, linearised at a point and velocity.
struct Normal {
  Matrix6d N = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  double loss = 0.0;
  bool is_ahead = true;
};

Normal normalAt(const std::vector<Ray>& rays, const Vector6d& x, bool with_rates) {
  Normal normal;
  const Eigen::Vector3d point = x.head<3>(), velocity = x.tail<3>();
  for (const Ray& ray : rays) {
    const auto seen = innovationOf(ray, point);
    if (!seen) {
      normal.is_ahead = false;
      return normal;
    }
    const Eigen::LLT<Eigen::Matrix2d> llt(seen->R);
    Eigen::Matrix<double, 2, 6> H = Eigen::Matrix<double, 2, 6>::Zero();
    H.leftCols<3>() = seen->H;
    normal.N += H.transpose() * llt.solve(H);
    normal.g += H.transpose() * llt.solve(seen->residual);
    normal.loss += seen->residual.dot(llt.solve(seen->residual));
    if (!with_rates || !ray.motion) continue;

    // B w = B (v - v_s)/rho (P-2); it answers to the point by the range and by the line of sight's turn.
    const Eigen::Vector3d v = (point - ray.origin) / seen->range;
    const Matrix23d B = acrossBasis(v);
    const Eigen::Vector3d relative = velocity - ray.motion->origin_velocity;
    const Eigen::Vector2d expected = B * relative / seen->range;
    const Eigen::Vector2d residual = B * ray.motion->rate - expected;
    H.leftCols<3>() = -(relative.dot(v) / seen->range * B + expected * v.transpose()) / seen->range;
    H.rightCols<3>() = B / seen->range;
    const Eigen::LLT<Eigen::Matrix2d> rate_llt(acrossCovariance(B, ray.motion->covariance));
    normal.N += H.transpose() * rate_llt.solve(H);
    normal.g += H.transpose() * rate_llt.solve(residual);
    normal.loss += residual.dot(rate_llt.solve(residual));
  }
  return normal;
}

/// Solution and inverse of the leading `size` rows, nullopt when they are not determined.
struct Solution {
  Vector6d step = Vector6d::Zero();
  Matrix6d covariance = Matrix6d::Zero();
};

std::optional<Solution> solve(const Normal& normal, int size) {
  // Scaled to a unit diagonal: metres and metres per second, near and far, are no matter then.
  const Eigen::VectorXd diagonal = normal.N.diagonal().head(size);
  if (!(diagonal.minCoeff() > 0.0) || !diagonal.allFinite()) return std::nullopt;
  const Eigen::VectorXd scale = diagonal.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * normal.N.topLeftCorner(size, size) * scale.asDiagonal();
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(scaled);
  if (ldlt.info() != Eigen::Success || !(ldlt.vectorD().minCoeff() > kLeastPivot)) return std::nullopt;
  Solution solution;
  solution.step.head(size) = scale.asDiagonal() * ldlt.solve(scale.asDiagonal() * normal.g.head(size));
  const Eigen::MatrixXd inverse = ldlt.solve(Eigen::MatrixXd::Identity(size, size));
  solution.covariance.topLeftCorner(size, size) =
      symmetric(scale.asDiagonal() * inverse * scale.asDiagonal());
  return solution;
}

double distanceToNearestOrigin(const std::vector<Ray>& rays, const Eigen::Vector3d& point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Ray& ray : rays) nearest = std::min(nearest, (point - ray.origin).norm());
  return nearest;
}

double largestParallax(const std::vector<Ray>& rays, const Eigen::Vector3d& point) {
  double largest = 0.0;
  for (std::size_t i = 0; i < rays.size(); ++i)
    for (std::size_t j = i + 1; j < rays.size(); ++j)
      largest = std::max(largest, angleBetween(point - rays[i].origin, point - rays[j].origin));
  return largest;
}

/// Gauss-Newton on the leading `size` of (point, velocity); the step is halved while it raises the loss.
struct Descent {
  CrossingVerdict verdict = CrossingVerdict::crossing;
  Solution solution;
  double loss = 0.0;
};

Descent descend(const std::vector<Ray>& rays, int size, Vector6d& x) {
  Descent descent;
  Normal normal = normalAt(rays, x, size == 6);
  if (!normal.is_ahead) {
    descent.verdict = CrossingVerdict::behind;
    return descent;
  }
  for (int step = 0; step < kMostIterations; ++step) {
    const auto solution = solve(normal, size);
    if (!solution) {
      descent.verdict = CrossingVerdict::parallel;
      return descent;
    }
    descent.solution = *solution;
    descent.loss = normal.loss;
    const double tolerance = kStepTolerance * distanceToNearestOrigin(rays, x.head<3>());
    Vector6d move = solution->step;
    Normal next = normalAt(rays, x + move, size == 6);
    for (int halving = 0; halving < 30; ++halving) {
      if (next.is_ahead && next.loss <= normal.loss * (1.0 + 1e-12) + 1e-18) break;
      move *= 0.5;
      next = normalAt(rays, x + move, size == 6);
    }
    const bool is_better = next.is_ahead && next.loss <= normal.loss * (1.0 + 1e-12) + 1e-18;
    if (is_better) {
      x += move;
      normal = next;
      descent.loss = next.loss;
    }
    if (move.head<3>().norm() <= tolerance || !is_better) {
      if (const auto last = solve(normal, size)) descent.solution = *last;
      return descent;
    }
  }
  descent.verdict = CrossingVerdict::not_converged;
  return descent;
}

}  // namespace

bool isDetermined(const Ray& ray) {
  if (!ray.origin.allFinite() || !ray.direction.allFinite() || !ray.covariance.allFinite()) return false;
  if (std::abs(ray.direction.squaredNorm() - 1.0) > 1e-6) return false;
  return isPositiveDefinite(acrossCovariance(acrossBasis(ray.direction), ray.covariance));
}

double largestSigma(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(eigen.eigenvalues()(2), 0.0));
}

Matrix23d acrossBasis(const Eigen::Vector3d& direction) {
  // The shortest rotation that takes +z to the direction, applied to x and y.
  const double x = direction.x(), y = direction.y(), z = direction.z();
  Matrix23d B;
  if (z < -1.0 + 1e-12) {
    B << 1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
    return B;
  }
  const double f = 1.0 / (1.0 + z);
  B << 1.0 - f * x * x, -f * x * y, -x, -f * x * y, 1.0 - f * y * y, -y;
  return B;
}

std::optional<RayInnovation> innovationOf(const Ray& ray, const Eigen::Vector3d& point) {  // (P-1)
  const Eigen::Vector3d r = point - ray.origin;
  const double range = r.norm();
  if (!(range > 0.0) || !std::isfinite(range)) return std::nullopt;
  const Eigen::Vector3d v = r / range;
  const double cosine = ray.direction.dot(v);
  if (!(cosine > 0.0)) return std::nullopt;
  const Matrix23d B = acrossBasis(v);
  RayInnovation innovation;
  innovation.residual = B * ray.direction / cosine;
  innovation.H = B / range;
  innovation.R = acrossCovariance(B, ray.covariance);
  innovation.range = range;
  return innovation;
}

std::optional<double> distanceSquared(const Ray& ray, const Eigen::Matrix<double, 6, 1>& state,
                                      const Eigen::Matrix<double, 6, 6>& covariance, bool with_rate) {
  const Eigen::Vector3d point = state.head<3>(), velocity = state.tail<3>();
  const auto seen = innovationOf(ray, point);
  if (!seen) return std::nullopt;
  const Eigen::Vector3d v = (point - ray.origin) / seen->range;
  const Eigen::Matrix<double, 2, 3> B = acrossBasis(v);
  Eigen::Matrix<double, 4, 6> H = Eigen::Matrix<double, 4, 6>::Zero();
  Eigen::Vector4d residual = Eigen::Vector4d::Zero();
  Eigen::Matrix4d R = Eigen::Matrix4d::Identity();
  H.topLeftCorner<2, 3>() = seen->H;
  residual.head<2>() = seen->residual;
  R.topLeftCorner<2, 2>() = seen->R;
  if (with_rate && ray.motion) {
    const Eigen::Vector3d relative = velocity - ray.motion->origin_velocity;
    const Eigen::Vector2d expected = B * relative / seen->range;
    H.bottomLeftCorner<2, 3>() =
        -(relative.dot(v) / seen->range * B + expected * v.transpose()) / seen->range;
    H.bottomRightCorner<2, 3>() = B / seen->range;
    residual.tail<2>() = B * ray.motion->rate - expected;
    R.bottomRightCorner<2, 2>() = symmetric(B * ray.motion->covariance * B.transpose());
  }
  const Eigen::Matrix4d S = symmetric(H * covariance * H.transpose()) + R;
  return residual.dot(S.llt().solve(residual));
}

Refusal refusalOf(CrossingVerdict verdict) {
  switch (verdict) {
    case CrossingVerdict::crossing:
      return {};
    case CrossingVerdict::too_few:
      return {"one ray only", "a point needs rays of two stations"};
    case CrossingVerdict::bad_ray:
      return {"invalid ray",
              "origin, direction (a unit vector) and a covariance in rad^2 that is positive "
              "definite across it are required"};
    case CrossingVerdict::parallel:
      return {"no parallax", "the rays are parallel: the stations must stand farther apart"};
    case CrossingVerdict::behind:
      return {"behind", "the rays cross behind a station: they are not of one target"};
    case CrossingVerdict::not_converged:
      return {"no agreement", "the rays contradict each other: they are not of one target"};
  }
  return {"unknown", ""};
}

Crossing intersect(const std::vector<Ray>& rays) {  // (P-2)
  Crossing crossing;
  if (rays.size() < 2) return crossing;
  if (!std::all_of(rays.begin(), rays.end(), [](const Ray& ray) { return isUsable(ray); })) {
    crossing.verdict = CrossingVerdict::bad_ray;
    return crossing;
  }
  const Start start = startOf(rays);
  crossing.verdict = start.verdict;
  if (start.verdict != CrossingVerdict::crossing) return crossing;

  Vector6d x = Vector6d::Zero();
  x.head<3>() = start.point;
  const Descent of_point = descend(rays, 3, x);
  crossing.verdict = of_point.verdict;
  if (of_point.verdict != CrossingVerdict::crossing) return crossing;

  Intersection& at = crossing.at;
  const auto rates = std::count_if(rays.begin(), rays.end(), [](const Ray& ray) { return !!ray.motion; });
  at.chi_square = of_point.loss;
  at.degrees = 2 * static_cast<int>(rays.size()) - 3;
  at.joint_covariance = of_point.solution.covariance;
  if (rates >= 2) {
    Vector6d with_velocity = x;
    const Descent of_both = descend(rays, 6, with_velocity);
    if (of_both.verdict == CrossingVerdict::crossing) {
      x = with_velocity;
      at.velocity = x.tail<3>();
      at.chi_square = of_both.loss;
      at.degrees += 2 * static_cast<int>(rates) - 3;
      at.joint_covariance = of_both.solution.covariance;
    }
  }
  at.point = x.head<3>();
  at.covariance = at.joint_covariance.topLeftCorner<3, 3>();
  at.parallax = largestParallax(rays, at.point);
  at.relative_sigma = largestSigma(at.covariance) / distanceToNearestOrigin(rays, at.point);
  return crossing;
}

double PlaneTest::distanceSquared() const {
  double distance = offset * offset / variance;
  if (offset_rate) distance += *offset_rate * *offset_rate / rate_variance;
  return distance;
}

std::optional<PlaneTest> planeTest(const Ray& a, const Ray& b, double least_baseline) {  // (P-3)
  const Eigen::Vector3d between = b.origin - a.origin;
  const double baseline = between.norm();
  if (!(baseline >= least_baseline) || !(baseline > 0.0)) return std::nullopt;
  const Perpendicular p = commonPerpendicular(a, b);
  if (p.sine_squared < kLeastSine * kLeastSine) return std::nullopt;
  const Eigen::Vector3d d = between / baseline;
  const Eigen::Vector3d &u_a = a.direction, &u_b = b.direction;

  PlaneTest test;
  test.range_a = p.along_a;
  test.range_b = p.along_b;
  test.parallax = angleBetween(u_a, u_b);
  test.offset = d.dot(u_a.cross(u_b));
  const Eigen::Vector3d by_a = u_b.cross(d), by_b = d.cross(u_a);
  test.variance = by_a.dot(a.covariance * by_a) + by_b.dot(b.covariance * by_b);
  if (!(test.variance > 0.0)) return std::nullopt;
  if (!a.motion || !b.motion) return test;

  // d tau/dt = d' . (u_a x u_b) + d . (w_a x u_b) + d . (u_a x w_b); it answers to both rates as tau to the
  // directions, and to the directions by the rates.
  const Eigen::Vector3d &w_a = a.motion->rate, &w_b = b.motion->rate;
  const Eigen::Vector3d apart = b.motion->origin_velocity - a.motion->origin_velocity;
  const Eigen::Vector3d d_rate = (apart - d * d.dot(apart)) / baseline;
  test.offset_rate = d_rate.dot(u_a.cross(u_b)) + d.dot(w_a.cross(u_b)) + d.dot(u_a.cross(w_b));
  const Eigen::Vector3d rate_by_a = w_b.cross(d) + u_b.cross(d_rate);
  const Eigen::Vector3d rate_by_b = d.cross(w_a) + d_rate.cross(u_a);
  test.rate_variance = by_a.dot(a.motion->covariance * by_a) + by_b.dot(b.motion->covariance * by_b) +
                       rate_by_a.dot(a.covariance * rate_by_a) + rate_by_b.dot(b.covariance * rate_by_b);
  if (!(test.rate_variance > 0.0)) test.offset_rate.reset();
  return test;
}

PlaneAngle planeAngle(const Ray& ray, const Eigen::Vector3d& axis) {  // (P-3)
  const Matrix23d B = acrossBasis(axis);
  const Eigen::Vector2d across = B * ray.direction;
  const double sine_squared = across.squaredNorm();
  PlaneAngle plane;
  plane.angle = std::atan2(across.y(), across.x());
  if (!(sine_squared > kLeastSine * kLeastSine)) {
    plane.variance = std::numeric_limits<double>::infinity();
    return plane;
  }
  const Eigen::Vector3d by_direction =
      (across.x() * B.row(1) - across.y() * B.row(0)).transpose() / sine_squared;
  plane.variance = by_direction.dot(ray.covariance * by_direction);
  return plane;
}

}  // namespace sightline::core
