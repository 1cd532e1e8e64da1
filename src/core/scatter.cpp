#include "sightline/core/scatter.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "sightline/core/sphere.h"

namespace sightline::core {
namespace {

constexpr std::size_t kLeastSamples = 20;
constexpr double kMedianOfTwo = 1.386294361119891;  // of chi squared with two degrees of freedom: 2 ln 2
constexpr double kHighest = 1.3;  // elevation beyond which azimuths are no plane's coordinate [rad]

}  // namespace

void Scatter::add(Time time, const Eigen::Vector2d& angles, const Eigen::Matrix2d& covariance) {
  if (std::abs(angles.y()) > kHighest || (count_ > 0 && time <= last_[3].time)) return breakOff();
  std::move(last_.begin() + 1, last_.end(), last_.begin());
  last_[3] = {time, angles, covariance};
  count_ = std::min(count_ + 1, 4);
  if (count_ < 4 || seconds(last_[3].time - last_[0].time) > longest_) return;
  if (const auto distance = distanceSquared()) distances_.add(*distance);
}

std::optional<double> Scatter::distanceSquared() const {
  Eigen::Vector2d difference = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  const double unit = seconds(last_[3].time - last_[0].time);  // of time, which cancels
  for (std::size_t i = 0; i < last_.size(); ++i) {
    double product = 1.0;
    for (std::size_t j = 0; j < last_.size(); ++j)
      product *= i == j ? 1.0 : seconds(last_[i].time - last_[j].time) / unit;
    difference += angleDifference(last_[i].angles, last_[3].angles) / product;
    covariance += last_[i].covariance / (product * product);
  }
  const Eigen::LLT<Eigen::Matrix2d> llt(covariance);
  if (llt.info() != Eigen::Success) return std::nullopt;
  return difference.dot(llt.solve(difference));
}

std::optional<double> Scatter::ratio() const {
  if (distances_.size() < kLeastSamples) return std::nullopt;
  return std::sqrt(*distances_.quantile(0.5) / kMedianOfTwo);
}

}  // namespace sightline::core
