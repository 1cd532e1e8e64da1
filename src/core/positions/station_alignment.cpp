#include "sightline/core/positions/station_alignment.h"

#include <cmath>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr int kMostAligned = 64;

}  // namespace

StationAlignment::StationAlignment(const StationAlignmentParams& params) : params_(params) {
  if (!(params.clock_sigma > 0.0 && params.orientation_sigma > 0.0 && params.memory > 0.0)) {
    throw std::invalid_argument(
        "StationAlignmentParams: clock_sigma > 0 s, orientation_sigma > 0 rad and memory > 0 s are required");
  }
}

bool StationAlignment::knows(int station) const {
  return station >= 0 && station < stations() && is_seen_[static_cast<std::size_t>(station)];
}

void StationAlignment::makeRoomFor(int station) {
  if (station >= stations()) {
    const Eigen::Index before = information_.rows(), after = kStates * (station + 1);
    is_seen_.resize(static_cast<std::size_t>(station) + 1, false);
    information_.conservativeResize(after, after);
    vector_.conservativeResize(after);
    information_.bottomRows(after - before).setZero();
    information_.rightCols(after - before).setZero();
    vector_.tail(after - before).setZero();
  }
  is_seen_[static_cast<std::size_t>(station)] = true;
}

void StationAlignment::take(int a, const Ray& ray_a, int b, const Ray& ray_b, double share) {  // (P-14)
  if (a < 0 || b < 0 || a == b || a >= kMostAligned || b >= kMostAligned || !(share > 0.0)) return;
  if (!ray_a.motion || !ray_b.motion) return;
  const auto test = planeTest(ray_a, ray_b);
  if (!test || !test->isAhead()) return;
  makeRoomFor(a);
  makeRoomFor(b);
  const Eigen::Vector3d d = (ray_b.origin - ray_a.origin).normalized();
  const Eigen::Vector3d by_a = ray_b.direction.cross(d), by_b = d.cross(ray_a.direction);
  // A direction stamped late is an older one; one seen turned by theta is u + theta x u.
  Eigen::Matrix<double, 1, 2 * kStates> h;
  h(0) = -by_a.dot(ray_a.motion->rate);
  h.segment<3>(1) = ray_a.direction.cross(by_a).transpose();
  h(kStates) = -by_b.dot(ray_b.motion->rate);
  h.segment<3>(kStates + 1) = ray_b.direction.cross(by_b).transpose();
  const double weight = std::min(share, 1.0) / test->variance;
  const Eigen::Index places[2] = {kStates * a, kStates * b};
  for (int i = 0; i < 2; ++i) {
    vector_.segment<kStates>(places[i]) +=
        weight * test->offset * h.segment<kStates>(kStates * i).transpose();
    for (int j = 0; j < 2; ++j) {
      information_.block<kStates, kStates>(places[i], places[j]) +=
          weight * h.segment<kStates>(kStates * i).transpose() * h.segment<kStates>(kStates * j);
    }
  }
  is_solved_ = false;
}

void StationAlignment::forget(double h) {
  if (!(h > 0.0)) return;
  const double kept = std::exp(-h / params_.memory);
  information_ *= kept;
  vector_ *= kept;
  is_solved_ = false;
}

void StationAlignment::solve() const {
  if (is_solved_) return;
  const Eigen::Index n = information_.rows();
  // Scaled by the priors: all unknowns are then of the order of one.
  Eigen::VectorXd sigma(n);
  for (Eigen::Index i = 0; i < n; ++i)
    sigma(i) = i % kStates == 0 ? params_.clock_sigma : params_.orientation_sigma;
  Eigen::MatrixXd scaled = sigma.asDiagonal() * information_ * sigma.asDiagonal();
  scaled.diagonal().array() += 1.0;
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(scaled);
  solution_ = sigma.asDiagonal() * ldlt.solve(sigma.asDiagonal() * vector_);
  covariance_ = sigma.asDiagonal() * ldlt.solve(Eigen::MatrixXd::Identity(n, n)) * sigma.asDiagonal();
  is_solved_ = true;
}

std::optional<StationAlignmentEstimate> StationAlignment::of(int station) const {
  if (!knows(station)) return std::nullopt;
  solve();
  // Against the mean of the stations that are known: a common offset cannot be told.
  StationAlignmentEstimate estimate;
  Eigen::VectorXd against = Eigen::VectorXd::Zero(solution_.size());
  double count = 0.0;
  for (int other = 0; other < stations(); ++other)
    if (knows(other)) count += 1.0;
  for (int other = 0; other < stations(); ++other)
    if (knows(other)) against(kStates * other) = -1.0 / count;
  against(kStates * station) += 1.0;
  estimate.clock = against.dot(solution_);
  estimate.clock_sigma = std::sqrt(std::max(against.dot(covariance_ * against), 0.0));
  estimate.orientation = solution_.segment<3>(kStates * station + 1);
  estimate.orientation_sigma =
      covariance_.diagonal().segment<3>(kStates * station + 1).cwiseMax(0.0).cwiseSqrt();
  return estimate;
}

std::optional<StationAlignment::ClockDifference> StationAlignment::clockDifference(int a, int b) const {
  if (!knows(a) || !knows(b) || a == b) return std::nullopt;
  solve();
  ClockDifference clock;
  clock.difference = solution_(kStates * b) - solution_(kStates * a);
  const double variance = covariance_(kStates * a, kStates * a) + covariance_(kStates * b, kStates * b) -
                          2.0 * covariance_(kStates * a, kStates * b);
  clock.sigma = std::sqrt(std::max(variance, 0.0));
  return clock;
}

}  // namespace sightline::core
