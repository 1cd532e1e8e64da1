#include "sightline/core/positions/stations/station_alignment.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr int kMostAligned = 64;
constexpr std::size_t kMostSeries = 4096;  // of a target and two stations
constexpr double kLongestSilence = 60.0;   // [s] of a series, after which it may make room
constexpr double kTrackMemory = 0.5;       // [s] for which errors of a local track stay
constexpr double kRateSigmas = 3.0;        // of a rate, above which it tells of a clock
constexpr double kClip = 3.0;              // standard deviations from which samples count less
constexpr double kSolveInterval = 1.0;     // [s] of data, for which a solution stands
constexpr double kPriorWeight = 4.0;       // samples that the stated variance counts for
constexpr double kLeastTold = 1e-6;        // information over that of the priors, that counts as none

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
    const Eigen::Index before = information_.rows(), after = kStates * (station + 1);
    is_seen_.resize(static_cast<std::size_t>(station) + 1, false);
    for (Eigen::MatrixXd* matrix : {&information_, &considered_}) {
      matrix->conservativeResize(after, after);
      matrix->bottomRows(after - before).setZero();
      matrix->rightCols(after - before).setZero();
    }
    vector_.conservativeResize(after);
    vector_.tail(after - before).setZero();
  }
  is_seen_[static_cast<std::size_t>(station)] = true;
}

void StationAlignment::take(Time time, const LocalView& view_a, const LocalView& view_b,
                            double share) {  // (P-14)
  const int a = view_a.key.station, b = view_b.key.station;
  const Ray &ray_a = view_a.ray, &ray_b = view_b.ray;
  if (a < 0 || b < 0 || a == b || a >= kMostAligned || b >= kMostAligned || !(share > 0.0)) return;
  if (!ray_a.motion || !ray_b.motion) return;
  if (!solved_ || seconds(time - *solved_) >= kSolveInterval) {
    if (solved_) solve();
    solved_ = time;
  }
  const auto test = planeTest(ray_a, ray_b);
  if (!test || !test->isAhead()) return;
  const Eigen::Vector3d d = (ray_b.origin - ray_a.origin).normalized();
  const Eigen::Vector3d by_a = ray_b.direction.cross(d), by_b = d.cross(ray_a.direction);
  // A direction stamped late is an older one; one seen turned by theta is u + theta x u. Both clocks late by
  // the same change nothing, which the noise of the rates would hide: what is common is left out.
  const double late = 0.5 * (by_a.dot(ray_a.motion->rate) - by_b.dot(ray_b.motion->rate));
  const double late_variance =
      0.25 * (by_a.dot(ray_a.motion->covariance * by_a) + by_b.dot(ray_b.motion->covariance * by_b));
  const bool tells_clocks = late * late > kRateSigmas * kRateSigmas * late_variance;
  Sample sample;
  sample.offset = test->offset;
  sample.variance = test->variance;
  sample.h(0) = tells_clocks ? -late : 0.0;
  sample.h.segment<3>(1) = ray_a.direction.cross(by_a);
  sample.h(kStates) = -sample.h(0);
  sample.h.segment<3>(kStates + 1) = ray_b.direction.cross(by_b);

  const std::pair<ViewKey, ViewKey> key{view_a.key, view_b.key};
  auto found = series_.find(key);
  if (found == series_.end()) {
    if (series_.size() >= kMostSeries) {  // those that have ended
      for (auto it = series_.begin(); it != series_.end();)
        it = seconds(time - it->second.time) > kLongestSilence ? series_.erase(it) : std::next(it);
    }
    if (series_.size() >= kMostSeries) return;
    found = series_.emplace(key, Series{time, PairVector::Zero(), PairVector::Zero()}).first;
  }
  makeRoomFor(a);
  makeRoomFor(b);
  Series& series = found->second;
  const double h = std::max(seconds(time - series.time), 0.0);
  series.time = time;
  const double credible = credibility(sample, a, b), each = std::min(share, 1.0);
  const auto acrossPart = [](const Eigen::Vector3d& by, const Eigen::Vector3d& u) {
    return by.squaredNorm() - std::pow(by.dot(u), 2);
  };
  const double slow_variance =
      std::min(sample.variance, view_a.slow.variance * acrossPart(by_a, ray_a.direction) +
                                    view_b.slow.variance * acrossPart(by_b, ray_b.direction));
  const double slow_time = std::max(view_a.slow.time_constant, view_b.slow.time_constant);
  const PairVector one = credible / sample.variance * sample.h;
  const PairVector by_tracks = std::sqrt(sample.variance - slow_variance) * one,
                   by_slow = std::sqrt(slow_variance) * one;
  series.by_tracks *= std::exp(-h / kTrackMemory);
  series.by_slow *= std::exp(-h / slow_time);
  Eigen::Matrix<double, 2 * kStates, 2 * kStates> crossed =
      by_tracks * series.by_tracks.transpose() + by_slow * series.by_slow.transpose();
  crossed = (crossed + crossed.transpose()).eval() + by_tracks * by_tracks.transpose() +
            by_slow * by_slow.transpose();
  series.by_tracks += by_tracks;
  series.by_slow += by_slow;
  count_ += each * credible;
  squares_ += each * credible * sample.offset * sample.offset / sample.variance;
  const Eigen::Index places[2] = {kStates * a, kStates * b};
  for (int j = 0; j < 2; ++j) {
    const int at_j = kStates * j;
    vector_.segment<kStates>(places[j]) += each * sample.offset * one.segment<kStates>(at_j);
    for (int k = 0; k < 2; ++k) {
      const int at_k = kStates * k;
      information_.block<kStates, kStates>(places[j], places[k]) +=
          each * one.segment<kStates>(at_j) * sample.h.segment<kStates>(at_k).transpose();
      considered_.block<kStates, kStates>(places[j], places[k]) +=
          each * crossed.block<kStates, kStates>(at_j, at_k);
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
  const double variance = scale_ * sample.variance + sample.h.dot(P * sample.h);
  const double ratio = kClip * kClip * variance / (residual * residual);
  return ratio < 1.0 ? ratio * ratio : 1.0;
}

void StationAlignment::forget(double h) {
  if (!(h > 0.0)) return;
  const double kept = std::exp(-h / params_.memory);
  information_ *= kept;
  considered_ *= kept;
  vector_ *= kept;
  squares_ *= kept;
  count_ *= kept;
  unsolved_for_ += h;
  if (unsolved_for_ >= kSolveInterval) solve();
}

void StationAlignment::solve() {
  unsolved_for_ = 0.0;
  const Eigen::Index n = information_.rows();
  if (n == 0) return;
  const Eigen::VectorXd sigma = priors();
  const Equations found = equations();
  Eigen::MatrixXd precision = sigma.asDiagonal() * found.information * sigma.asDiagonal();
  precision.diagonal().array() += 1.0;
  covariance_ =
      sigma.asDiagonal() * precision.ldlt().solve(Eigen::MatrixXd::Identity(n, n)) * sigma.asDiagonal();
  solution_ = covariance_ * found.vector;
  // Errors larger than the rays state; smaller ones may be what the path alone does not tell.
  const double rest =
      std::max(squares_ - 2.0 * solution_.dot(vector_) + solution_.dot(information_ * solution_), 0.0);
  scale_ = std::max((rest + kPriorWeight) / (count_ + kPriorWeight), 1.0);
}

/// Standard deviations of all unknowns before anything is known.
Eigen::VectorXd StationAlignment::priors() const {
  Eigen::VectorXd sigma(information_.rows());
  for (Eigen::Index i = 0; i < sigma.size(); ++i)
    sigma(i) = i % kStates == 0 ? params_.clock_sigma : params_.orientation_sigma;
  return sigma;
}

StationAlignment::Equations StationAlignment::equations() const {
  // Scaled by the priors: all unknowns are then of the order of one. With information L and covariance M of
  // the vector b, that of the estimate L^-1 b is L^-1 M L^-1. What is not told by L has no part in M either.
  const Eigen::VectorXd sigma = priors();
  const Eigen::MatrixXd L = sigma.asDiagonal() * information_ * sigma.asDiagonal();
  Eigen::MatrixXd M = sigma.asDiagonal() * considered_ * sigma.asDiagonal();
  M.diagonal().array() += kLeastTold;
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(M);
  const Eigen::VectorXd weight = sigma.cwiseInverse();
  const Eigen::MatrixXd left = L * ldlt.solve(L) / (2.0 * scale_);
  Equations equations;
  equations.information = weight.asDiagonal() * (left + left.transpose()) * weight.asDiagonal();
  equations.vector = weight.asDiagonal() * (L * ldlt.solve(sigma.asDiagonal() * vector_)) / scale_;
  return equations;
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
