#include "sightline/core/model/tracklet.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "sightline/core/model/chart.h"

namespace sightline::core {
namespace {

constexpr double kStandsOut = 9.2;        // chi^2 of two degrees of freedom that noise exceeds once in 100
constexpr double kDependence = 0.05;      // largest correlation between tracklets that counts as none
constexpr double kLeastSpread = 1e-9;     // of times, relative to their span, that tells them apart
constexpr double kLeastCondition = 1e-8;  // determinant of a 2x2 information, relative to its diagonal

/// A sighting in the coordinates of its span.
struct Point {
  double time = 0.0;            // from the middle of the span, in halves of it
  Eigen::Vector2d position;     // [rad]
  Eigen::Matrix2d information;  // [1/rad^2]
  double weight = 0.0;          // root of its determinant
};

/// A span of sightings in the plane that touches the sphere in their midst.
struct Piece {
  Chart chart;
  Time middle{};
  double half = 0.0;  // of the span [s]
  std::vector<Point> points;
};

std::optional<Piece> pieceOf(const Tracklet* first, const Tracklet* last) {
  Piece piece;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Tracklet* it = first; it != last; ++it) sum += it->sighting.direction;
  if (!(sum.norm() > 0.0)) return std::nullopt;
  piece.chart = Chart::centredOn(sum.normalized());
  piece.half = 0.5 * seconds((last - 1)->time - first->time);
  if (!(piece.half > 0.0)) return std::nullopt;
  piece.middle = first->time + durationOf(piece.half);
  for (const Tracklet* it = first; it != last; ++it) {
    Point point;
    point.time = seconds(it->time - piece.middle) / piece.half;
    point.position = piece.chart.coordinatesOf(it->sighting.direction);
    const Eigen::Matrix2d R = piece.chart.covarianceOf(it->sighting);
    if (!(R.determinant() > kLeastCondition * R(0, 0) * R(1, 1))) return std::nullopt;
    point.information = symmetric(R.inverse());
    point.weight = 1.0 / std::sqrt(R.determinant());
    piece.points.push_back(point);
  }
  return piece;
}

/// The polynomials that are orthogonal over the points' weights in time: p_(k+1)(t) = (t - a_k) p_k(t) - b_k
/// p_(k-1)(t).
struct Orthogonal {
  Eigen::VectorXd a, b;

  /// Of degree `degree` or less, at `time`.
  double at(double time, Eigen::Index degree) const {
    double before = 0.0, p = 1.0;
    for (Eigen::Index k = 0; k < degree; ++k) {
      const double next = (time - a(k)) * p - b(k) * before;
      before = p;
      p = next;
    }
    return p;
  }
};

/// Up to degree `degree`; less when there are no more different times than that.
Orthogonal orthogonalOver(const std::vector<Point>& points, int degree) {  // (S-60)
  Orthogonal polynomials{Eigen::VectorXd::Zero(degree), Eigen::VectorXd::Zero(degree)};
  double norm_before = 0.0;
  for (Eigen::Index k = 0; k < degree; ++k) {
    double norm = 0.0, moment = 0.0;
    for (const Point& point : points) {
      const double p = polynomials.at(point.time, k);
      norm += point.weight * p * p;
      moment += point.weight * point.time * p * p;
    }
    if (k > 0 && !(norm > kLeastSpread * norm_before)) {
      polynomials.a.conservativeResize(k);
      polynomials.b.conservativeResize(k);
      break;
    }
    polynomials.a(k) = moment / norm;
    polynomials.b(k) = k > 0 ? norm / norm_before : 0.0;
    norm_before = norm;
  }
  return polynomials;
}

/// The zeros of the last of them: Gauss's nodes, as the eigenvalues of the Jacobi matrix.
Eigen::VectorXd gaussNodes(const Orthogonal& polynomials) {  // (S-60)
  const Eigen::Index m = polynomials.a.size();
  if (m == 1) return polynomials.a;
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(polynomials.a, polynomials.b.tail(m - 1).cwiseSqrt(), Eigen::EigenvaluesOnly);
  return solver.eigenvalues();
}

/// The j-th of the polynomials that are one at one node and zero at the others.
double lagrange(const Eigen::VectorXd& nodes, Eigen::Index j, double time) {  // (S-61)
  double value = 1.0;
  for (Eigen::Index k = 0; k < nodes.size(); ++k) {
    if (k != j) value *= (time - nodes(k)) / (nodes(j) - nodes(k));
  }
  return value;
}

/// Whether the path's coefficient of the degree that is left out stands out of the noise.
bool isBent(const std::vector<Point>& points, const Orthogonal& polynomials) {  // (S-61)
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d evidence = Eigen::Vector2d::Zero();
  for (const Point& point : points) {
    const double p = polynomials.at(point.time, polynomials.a.size());
    information += p * p * point.information;
    evidence += p * (point.information * point.position);
  }
  const Eigen::LLT<Eigen::Matrix2d> factor(information);
  if (factor.info() != Eigen::Success) return false;  // as many times as nodes: nothing is left out
  return factor.matrixL().solve(evidence).squaredNorm() > kStandsOut;
}

/// The path's values at the nodes, by generalised least squares.
struct Values {
  Eigen::VectorXd mean;        // (2 coordinates) at each node
  Eigen::MatrixXd covariance;  // [rad^2]
};

std::optional<Values> fit(const std::vector<Point>& points, const Eigen::VectorXd& nodes) {  // (S-61)
  const Eigen::Index m = nodes.size();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(2 * m, 2 * m);
  Eigen::VectorXd evidence = Eigen::VectorXd::Zero(2 * m);
  for (const Point& point : points) {
    for (Eigen::Index j = 0; j < m; ++j) {
      const Eigen::Matrix2d share = lagrange(nodes, j, point.time) * point.information;
      evidence.segment<2>(2 * j) += share * point.position;
      for (Eigen::Index k = 0; k < m; ++k)
        information.block<2, 2>(2 * j, 2 * k) += lagrange(nodes, k, point.time) * share;
    }
  }
  const Eigen::LDLT<Eigen::MatrixXd> factor(information);
  if (factor.info() != Eigen::Success || !factor.isPositive()) return std::nullopt;
  return Values{factor.solve(evidence), factor.solve(Eigen::MatrixXd::Identity(2 * m, 2 * m))};
}

bool areIndependent(const Values& values) {
  for (Eigen::Index row = 0; row < values.mean.size(); ++row) {
    for (Eigen::Index column = 0; column < row / 2 * 2; ++column) {
      const double scale = std::sqrt(values.covariance(row, row) * values.covariance(column, column));
      if (!(std::abs(values.covariance(row, column)) <= kDependence * scale)) return false;
    }
  }
  return true;
}

std::vector<Tracklet> trackletsAt(const Eigen::VectorXd& nodes, const Values& values, const Piece& piece,
                                  const Tracklet* first, double sightings) {
  std::vector<Tracklet> tracklets;
  double sureness = 0.0;
  for (Eigen::Index j = 0; j < nodes.size(); ++j) {
    const Eigen::Matrix2d R = symmetric(values.covariance.block<2, 2>(2 * j, 2 * j));
    Tracklet tracklet;
    tracklet.time = piece.middle + durationOf(nodes(j) * piece.half);
    tracklet.sensor = first->sensor;
    tracklet.ifov = first->ifov;
    tracklet.sighting =
        rotate(sightingOf(values.mean.segment<2>(2 * j), R), piece.chart.R_chart_tracking().transpose());
    tracklet.sightings = 1.0 / std::sqrt(R.determinant());
    sureness += tracklet.sightings;
    tracklets.push_back(std::move(tracklet));
  }
  for (Tracklet& tracklet : tracklets) tracklet.sightings *= sightings / sureness;
  return tracklets;
}

/// The nodes that stand for these sightings; nothing when they do not.
std::optional<std::vector<Tracklet>> condense(const Tracklet* first, const Tracklet* last, int nodes) {
  const auto piece = pieceOf(first, last);
  if (!piece) return std::nullopt;
  const Orthogonal polynomials = orthogonalOver(piece->points, nodes);
  if (isBent(piece->points, polynomials)) return std::nullopt;
  const Eigen::VectorXd times = gaussNodes(polynomials);
  const auto values = fit(piece->points, times);
  if (!values || !areIndependent(*values)) return std::nullopt;
  double sightings = 0.0;
  for (const Tracklet* it = first; it != last; ++it) sightings += it->sightings;
  return trackletsAt(times, *values, *piece, first, sightings);
}

void condenseOrHalve(const Tracklet* first, const Tracklet* last, int nodes, std::vector<Tracklet>& out) {
  const std::ptrdiff_t count = last - first;
  if (count > nodes) {
    if (auto tracklets = condense(first, last, nodes)) {
      std::move(tracklets->begin(), tracklets->end(), std::back_inserter(out));
      return;
    }
    condenseOrHalve(first, first + count / 2, nodes, out);
    condenseOrHalve(first + count / 2, last, nodes, out);
    return;
  }
  out.insert(out.end(), first, last);
}

}  // namespace

std::vector<Tracklet> compress(const std::vector<Tracklet>& sightings, const CompressionParams& params) {
  if (!(params.span > 0.0) || sightings.empty()) return sightings;
  // Equal parts of the whole, none longer than a span.
  const double whole = seconds(sightings.back().time - sightings.front().time);
  const double parts = std::max(1.0, std::ceil(whole / params.span - 1e-9));
  std::vector<Tracklet> out;
  const Tracklet* const end = sightings.data() + sightings.size();
  const Tracklet* first = sightings.data();
  for (double part = 1.0; first != end; ++part) {
    // Parts without sightings are passed over at once: a pause can have very many of them.
    if (whole > 0.0)
      part = std::max(part, std::floor(seconds(first->time - sightings.front().time) / whole * parts));
    const Time until = sightings.front().time + durationOf(part * whole / parts);
    const Tracklet* last = first;
    while (last != end && (last->time < until || part >= parts)) ++last;
    condenseOrHalve(first, last, params.nodes, out);
    first = last;
  }
  return out;
}

}  // namespace sightline::core
