#include "sightline/core/sensors/clock_offset.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Cholesky>

namespace sightline::core {
namespace {

constexpr double kKnownRate = 4.0;     // squared rate over its variance from which a target counts as moving
constexpr double kLeastNumbers = 100;  // innovations before an offset is given
constexpr double kLargestError = 1.0;  // standard error beyond which an offset is not determined [s]

}  // namespace

void ClockWatch::take(Time time, const Eigen::Vector2d& nu, const Eigen::Matrix2d& R,
                      const AngularState& expected) {
  const double kept = std::exp(-seconds(time - last_) / memory_);
  information_ *= kept;
  noise_ *= kept * kept;
  vector_ *= kept;
  squares_ *= kept;
  numbers_ *= kept;
  last_ = time;
  for (int channel = 0; channel < 2; ++channel) {
    const double rate = expected.mean(channel + 2);
    const double rate_variance = expected.covariance(channel + 2, channel + 2);
    const double weight = 1.0 / (expected.covariance(channel, channel) + R(channel, channel));
    const bool moves = rate * rate > kKnownRate * rate_variance;
    Eigen::Vector3d row = Eigen::Vector3d::Zero();
    row(0) = moves ? rate : 0.0;
    row(channel + 1) = 1.0;
    information_ += weight * row * row.transpose();  // (S-55)
    noise_ += weight * row * row.transpose();
    vector_ += weight * row * nu(channel);
    if (moves) {  // (S-55): what the correlated errors of the track's rate and position add on average
      information_(0, 0) -= weight * rate_variance;
      vector_(0) += weight * expected.covariance(channel, channel + 2);
    }
    squares_ += weight * nu(channel) * nu(channel);
    numbers_ += 1.0;
  }
}

std::optional<ClockOffset> ClockWatch::against() const {
  if (numbers_ < kLeastNumbers) return std::nullopt;
  const Eigen::LDLT<Eigen::Matrix3d> ldlt(information_);
  if (ldlt.info() != Eigen::Success || !(ldlt.vectorD().minCoeff() > 0.0)) return std::nullopt;
  const Eigen::Vector3d offsets = ldlt.solve(vector_);  // (S-55)
  const Eigen::Matrix3d half = ldlt.solve(noise_);
  const Eigen::Matrix3d covariance = ldlt.solve(half.transpose());
  const double unexplained = std::max(1.0, (squares_ - offsets.dot(vector_)) / numbers_);
  const double variance = unexplained * covariance(0, 0);
  if (!(variance > 0.0) || !(variance < kLargestError * kLargestError)) return std::nullopt;
  return ClockOffset{offsets(0), std::sqrt(variance)};
}

std::vector<ClockFinding> wrongClocks(const std::vector<std::optional<ClockOffset>>& against,
                                      const ClockOffsetParams& params) {
  std::vector<std::size_t> trusted;
  for (std::size_t i = 0; i < against.size(); ++i) {
    if (against[i]) trusted.push_back(i);
  }
  const bool undecided = trusted.size() == 2;
  std::vector<ClockFinding> findings;
  while (trusted.size() >= 2) {
    double weights = 0.0, weighted = 0.0;
    for (const std::size_t i : trusted) {
      const double weight = 1.0 / (against[i]->sigma * against[i]->sigma);
      weights += weight;
      weighted += weight * against[i]->behind;
    }
    ClockFinding worst;
    double most = 0.0;
    for (const std::size_t i : trusted) {
      const double weight = 1.0 / (against[i]->sigma * against[i]->sigma);
      const double others = weights - weight;
      ClockFinding finding{i, {}, undecided};
      // (S-56)
      finding.offset.behind = against[i]->behind - (weighted - weight * against[i]->behind) / others;
      finding.offset.sigma = std::sqrt(1.0 / weight + 1.0 / others);
      const double significance = std::abs(finding.offset.behind) / finding.offset.sigma;
      if (significance <= most) continue;
      most = significance;
      worst = finding;
    }
    if (most < params.significance || std::abs(worst.offset.behind) < params.least) break;
    // Of the last two either may be wrong: when others were found wrong before, these are left alone.
    if (trusted.size() == 2 && !undecided) break;
    findings.push_back(worst);
    trusted.erase(std::find(trusted.begin(), trusted.end(), worst.sensor));
    if (undecided) {
      findings.push_back({trusted[0], {-worst.offset.behind, worst.offset.sigma}, true});
      break;
    }
  }
  return findings;
}

}  // namespace sightline::core
