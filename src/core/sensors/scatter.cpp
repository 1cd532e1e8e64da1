#include "sightline/core/sensors/scatter.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "sightline/core/model/chi_square.h"
#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr std::size_t kLeastSamples = 20;
constexpr double kHighest = 1.3;  // elevation beyond which the azimuth is no coordinate of a plane [rad]

}  // namespace

void Scatter::add(Chain& chain, Time time, const Eigen::Vector2d& angles, const Eigen::Matrix2d& covariance) {
  auto& points = chain.points_;
  const bool is_comparable = std::abs(angles.y()) <= kHighest;
  if (!is_comparable || (chain.count_ > 0 && time <= points[3].time)) chain.count_ = 0;
  if (!is_comparable) return;
  std::move(points.begin() + 1, points.end(), points.begin());
  points[3] = {time, angles, covariance};
  chain.count_ = std::min(chain.count_ + 1, 4);
  if (chain.count_ < 4 || seconds(points[3].time - points[0].time) > longest_) return;
  if (const auto distance = distanceSquared(points)) distances_.add(*distance);
}

std::optional<double> Scatter::distanceSquared(const std::array<Chain::Point, 4>& points) {
  Eigen::Vector2d difference = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  const double unit = seconds(points[3].time - points[0].time);  // of time, which cancels
  for (std::size_t i = 0; i < points.size(); ++i) {
    double product = 1.0;
    for (std::size_t j = 0; j < points.size(); ++j)
      product *= i == j ? 1.0 : seconds(points[i].time - points[j].time) / unit;
    difference += angleDifference(points[i].angles, points[3].angles) / product;  // (S-57)
    covariance += points[i].covariance / (product * product);
  }
  const Eigen::LLT<Eigen::Matrix2d> llt(covariance);
  if (llt.info() != Eigen::Success) return std::nullopt;
  return difference.dot(llt.solve(difference));
}

std::optional<double> Scatter::ratio() const {
  if (distances_.size() < kLeastSamples) return std::nullopt;
  return std::sqrt(*distances_.quantile(0.5) / kChiSquareMedian2);  // (S-57)
}

}  // namespace sightline::core
