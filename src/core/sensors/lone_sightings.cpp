#include "sightline/core/sensors/lone_sightings.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace sightline::core {
namespace {

constexpr double kEven = 1.5;             // largest ratio of intervals in a row
constexpr double kFarOff = 100.0;         // factor on the variance from which the stated one is not believed
constexpr double kLargestScatter = 0.01;  // [rad] that the sightings may scatter: false ones scatter farther
constexpr double kMedian = 1.386;         // of chi^2 with two degrees of freedom

/// Squared distance of a sighting from the line through the two before it, over its covariance.
template <typename Look>
double distanceSquared(const Look& first, const Look& second, const Look& third) {
  const double ahead = seconds(third.time - second.time) / seconds(second.time - first.time);
  Eigen::Matrix<double, 3, 2> across;  // of the plane that touches the sphere at the second
  across.col(0) = second.direction.unitOrthogonal();
  across.col(1) = second.direction.cross(across.col(0));
  const Eigen::Vector2d offset = across.transpose() * (third.direction - second.direction +
                                                       ahead * (first.direction - second.direction));
  const Eigen::Matrix3d sum =
      third.covariance + (1.0 + ahead) * (1.0 + ahead) * second.covariance + ahead * ahead * first.covariance;
  const Eigen::Matrix2d S = across.transpose() * sum * across;
  return offset.dot(S.inverse() * offset);
}

}  // namespace

std::optional<double> LoneSightings::take(const Scan& scan) {  // (S-96)
  if (scan.sightings.size() != 1) {
    looks_ = 0;
    return std::nullopt;
  }
  const Look look{scan.time, scan.sightings.front().direction, scan.sightings.front().covariance};
  if (looks_ > 0) {
    const double h = seconds(look.time - last_[1].time);
    const double before = looks_ > 1 ? seconds(last_[1].time - last_[0].time) : h;
    if (!(h > 0.0) || h > kEven * before || before > kEven * h) looks_ = 0;
  }
  if (looks_ >= 2)
    distances_squared_[static_cast<std::size_t>((looks_ - 2) % kNeeded)] =
        distanceSquared(last_[0], last_[1], look);
  last_ = {last_[1], look};
  ++looks_;
  if (looks_ < kNeeded + 2) return std::nullopt;
  const auto factor = suspicion();
  if (factor) looks_ = 0;
  return factor;
}

std::optional<double> LoneSightings::suspicion() const {  // (S-96)
  const int compared = std::min(looks_ - 2, kNeeded);
  if (compared < 1) return std::nullopt;
  std::array<double, kNeeded> sorted = distances_squared_;
  const auto middle = sorted.begin() + compared / 2;
  std::nth_element(sorted.begin(), middle, sorted.begin() + compared);
  const double factor = *middle / kMedian;
  const double sigma = std::sqrt(factor * last_[1].covariance.trace() / 2.0);
  if (!std::isfinite(factor) || factor < kFarOff || sigma > kLargestScatter) return std::nullopt;
  return factor;
}

}  // namespace sightline::core
