#include "sightline/core/positions/station_alignment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr int kMostStations = 64;
constexpr std::size_t kMostSeries = 4096;  // of a target and two stations
constexpr double kLongestGap = 2.0;        // [s] between samples of one series
constexpr double kClip = 3.0;              // standard deviations from which samples count less
constexpr double kSolveInterval = 1.0;     // [s] of data, for which a solution stands
constexpr int kTurns = 3;                  // of finding the variance of what is left
constexpr double kPriorWeight = 4.0;       // samples that the stated variance counts for

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

bool StationAlignment::tells(int station) const {
  return knows(station) && kStates * (station + 1) <= solution_.size();
}

void StationAlignment::makeRoomFor(int station) {
  if (station >= stations()) {
    const Eigen::Index before = sums_[0].information.rows(), after = kStates * (station + 1);
    is_seen_.resize(static_cast<std::size_t>(station) + 1, false);
    for (Sums& sums : sums_) {
      sums.information.conservativeResize(after, after);
      sums.vector.conservativeResize(after);
      sums.information.bottomRows(after - before).setZero();
      sums.information.rightCols(after - before).setZero();
      sums.vector.tail(after - before).setZero();
    }
  }
  is_seen_[static_cast<std::size_t>(station)] = true;
}

void StationAlignment::take(Time time, const LocalView& view_a, const LocalView& view_b,
                            double share) {  // (P-14)
  const int a = view_a.key.station, b = view_b.key.station;
  const Ray &ray_a = view_a.ray, &ray_b = view_b.ray;
  if (a < 0 || b < 0 || a == b || a >= kMostStations || b >= kMostStations || !(share > 0.0)) return;
  if (!ray_a.motion || !ray_b.motion) return;
  if (!solved_ || seconds(time - *solved_) >= kSolveInterval) {
    if (solved_) solve();
    solved_ = time;
  }
  const auto test = planeTest(ray_a, ray_b);
  if (!test || !test->isAhead()) return;
  const Eigen::Vector3d d = (ray_b.origin - ray_a.origin).normalized();
  const Eigen::Vector3d by_a = ray_b.direction.cross(d), by_b = d.cross(ray_a.direction);
  // A direction stamped late is an older one; one seen turned by theta is u + theta x u.
  Sample sample{time, test->offset, test->variance, {}};
  // Both clocks late by the same change nothing. Their noisy rates do not say so, and the noise has to do
  // with that of the offset: what is common is left out.
  const double late = 0.5 * (by_a.dot(ray_a.motion->rate) - by_b.dot(ray_b.motion->rate));
  sample.h(0) = -late;
  sample.h.segment<3>(1) = ray_a.direction.cross(by_a).transpose();
  sample.h(kStates) = late;
  sample.h.segment<3>(kStates + 1) = ray_b.direction.cross(by_b).transpose();
  const std::pair<ViewKey, ViewKey> series{view_a.key, view_b.key};
  auto found = last_.find(series);
  if (found == last_.end()) {
    if (last_.size() >= kMostSeries) {  // those that have ended
      for (auto it = last_.begin(); it != last_.end();)
        it = seconds(time - it->second.time) > kLongestGap ? last_.erase(it) : std::next(it);
    }
    if (last_.size() < kMostSeries) last_[series] = sample;
    return;
  }
  const Sample before = found->second;
  const double h = seconds(time - before.time);
  if (!(h > 0.0)) return;
  found->second = sample;
  if (h > kLongestGap) return;
  makeRoomFor(a);
  makeRoomFor(b);
  const Eigen::Index places[2] = {kStates * a, kStates * b};
  const double weight = std::min(share, 1.0) * credibility(sample, a, b);
  count_ += weight;
  for (std::size_t i = 0; i < kTimes.size(); ++i) {  // what is new in the sample, of a Gauss-Markov error
    Sums& sums = sums_[i];
    const double phi = std::exp(-h / kTimes[i]);
    const double fresh = std::sqrt(1.0 - phi * phi);
    const double sigma = fresh * std::sqrt(sample.variance);
    const double kept = phi * std::sqrt(sample.variance / before.variance);
    const double y = (sample.offset - kept * before.offset) / sigma;
    const Eigen::Matrix<double, 1, 2 * kStates> g = (sample.h - kept * before.h) / sigma;
    sums.squares += weight * y * y;
    sums.log_determinant += weight * 2.0 * std::log(fresh);
    for (int j = 0; j < 2; ++j) {
      sums.vector.segment<kStates>(places[j]) += weight * y * g.segment<kStates>(kStates * j).transpose();
      for (int k = 0; k < 2; ++k)
        sums.information.block<kStates, kStates>(places[j], places[k]) +=
            weight * g.segment<kStates>(kStates * j).transpose() * g.segment<kStates>(kStates * k);
    }
  }
}

/// Weight of a sample by how far it is from what is expected: wrong correspondence for an instant, or a local
/// track that has just begun, must not count for much (Huber 1964).
double StationAlignment::credibility(const Sample& sample, int a, int b) const {
  Eigen::Matrix<double, 2 * kStates, 1> x = Eigen::Matrix<double, 2 * kStates, 1>::Zero();
  Eigen::Matrix<double, 2 * kStates, 2 * kStates> P = x * x.transpose();
  const bool is_known = solution_.size() >= kStates * (std::max(a, b) + 1);
  const Eigen::Index places[2] = {kStates * a, kStates * b};
  for (int i = 0; i < 2; ++i) {
    P.diagonal().segment<kStates>(kStates * i) << params_.clock_sigma * params_.clock_sigma,
        Eigen::Vector3d::Constant(params_.orientation_sigma * params_.orientation_sigma);
    if (!is_known) continue;
    x.segment<kStates>(kStates * i) = solution_.segment<kStates>(places[i]);
    for (int j = 0; j < 2; ++j)
      P.block<kStates, kStates>(kStates * i, kStates * j) =
          covariance_.block<kStates, kStates>(places[i], places[j]);
  }
  const double residual = sample.offset - sample.h.dot(x);
  const double variance = scale_ * sample.variance + sample.h * P * sample.h.transpose();
  const double ratio = kClip * kClip * variance / (residual * residual);
  return ratio < 1.0 ? ratio * ratio : 1.0;
}

void StationAlignment::forget(double h) {
  if (!(h > 0.0)) return;
  const double kept = std::exp(-h / params_.memory);
  for (Sums& sums : sums_) {
    sums.information *= kept;
    sums.vector *= kept;
    sums.squares *= kept;
    sums.log_determinant *= kept;
  }
  count_ *= kept;
  unsolved_for_ += h;
  if (unsolved_for_ >= kSolveInterval) solve();
}

void StationAlignment::solve() {
  unsolved_for_ = 0.0;
  const Eigen::Index n = sums_[0].information.rows();
  if (n == 0) return;
  // Scaled by the priors: all unknowns are then of the order of one.
  Eigen::VectorXd sigma(n);
  for (Eigen::Index i = 0; i < n; ++i)
    sigma(i) = i % kStates == 0 ? params_.clock_sigma : params_.orientation_sigma;
  const double told = std::min(static_cast<double>(n), 0.5 * count_);  // parameters, at most
  double best = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < kTimes.size(); ++i) {
    const Sums& sums = sums_[i];
    const Eigen::MatrixXd scaled = sigma.asDiagonal() * sums.information * sigma.asDiagonal();
    const Eigen::VectorXd vector = sigma.asDiagonal() * sums.vector;
    double scale = 1.0;
    for (int turn = 0; turn < kTurns; ++turn) {
      Eigen::MatrixXd precision = scaled / scale;
      precision.diagonal().array() += 1.0;
      const Eigen::VectorXd x = precision.ldlt().solve(vector) / scale;
      const double rest = std::max(sums.squares - 2.0 * x.dot(vector) + x.dot(scaled * x), 0.0);
      scale = (rest + kPriorWeight) / (count_ - told + kPriorWeight);
    }
    const double likelihood = -0.5 * ((count_ + kPriorWeight) * std::log(scale) + sums.log_determinant);
    if (!(likelihood > best)) continue;
    best = likelihood;
    best_ = i;
    scale_ = scale;
  }
  Eigen::MatrixXd precision = sigma.asDiagonal() * sums_[best_].information * sigma.asDiagonal();
  precision /= scale_;
  precision.diagonal().array() += 1.0;
  covariance_ =
      sigma.asDiagonal() * precision.ldlt().solve(Eigen::MatrixXd::Identity(n, n)) * sigma.asDiagonal();
  solution_ = covariance_ * sums_[best_].vector / scale_;
}

StationAlignment::Equations StationAlignment::equations() const {
  return {sums_[best_].information / scale_, sums_[best_].vector / scale_, kTimes[best_], scale_};
}

StationAlignment::Marginal StationAlignment::marginalOf(int station) const {
  Marginal marginal;
  marginal.covariance.diagonal() << params_.clock_sigma * params_.clock_sigma,
      Eigen::Vector3d::Constant(params_.orientation_sigma * params_.orientation_sigma);
  if (!tells(station)) return marginal;
  marginal.mean = solution_.segment<kStates>(kStates * station);
  marginal.covariance = covariance_.block<kStates, kStates>(kStates * station, kStates * station);
  return marginal;
}

std::optional<StationAlignmentEstimate> StationAlignment::of(int station,
                                                             const std::vector<bool>& is_wrong) const {
  if (!tells(station)) return std::nullopt;
  // Against the mean of the stations that are known: a common offset cannot be told.
  const auto counts = [&](int other) {
    const auto i = static_cast<std::size_t>(other);
    return tells(other) && !(i < is_wrong.size() && is_wrong[i]);
  };
  StationAlignmentEstimate estimate;
  Eigen::VectorXd against = Eigen::VectorXd::Zero(solution_.size());
  double count = 0.0;
  for (int other = 0; other < stations(); ++other)
    if (counts(other)) count += 1.0;
  for (int other = 0; other < stations(); ++other)
    if (counts(other)) against(kStates * other) = -1.0 / count;
  against(kStates * station) += 1.0;
  estimate.clock = against.dot(solution_);
  estimate.clock_sigma = std::sqrt(std::max(against.dot(covariance_ * against), 0.0));
  estimate.orientation = solution_.segment<3>(kStates * station + 1);
  estimate.orientation_sigma =
      covariance_.diagonal().segment<3>(kStates * station + 1).cwiseMax(0.0).cwiseSqrt();
  return estimate;
}

std::optional<StationAlignment::ClockDifference> StationAlignment::clockDifference(int a, int b) const {
  if (!tells(a) || !tells(b) || a == b) return std::nullopt;
  ClockDifference clock;
  clock.difference = solution_(kStates * b) - solution_(kStates * a);
  const double variance = covariance_(kStates * a, kStates * a) + covariance_(kStates * b, kStates * b) -
                          2.0 * covariance_(kStates * a, kStates * b);
  clock.sigma = std::sqrt(std::max(variance, 0.0));
  return clock;
}

}  // namespace sightline::core
