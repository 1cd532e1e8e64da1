#include "sightline/core/positions/position_start.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace sightline::core {
namespace {

constexpr double kRateSigma = 0.5;  // of velocity and acceleration at the start, over the range [1/s, 1/s^2]
constexpr double kStartChiSquare = 9.0;  // per degree of freedom; of the rays with which a target starts

}  // namespace

void PositionStart::wait(const StationMeasurement& m) {
  int kept = 0;
  for (int i = count_ == kMostWaiting ? 1 : 0; i < count_; ++i) {
    if (seconds(m.time - waiting_[static_cast<std::size_t>(i)].time) > window_) continue;
    if (kept != i) waiting_[static_cast<std::size_t>(kept)] = waiting_[static_cast<std::size_t>(i)];
    ++kept;
  }
  waiting_[static_cast<std::size_t>(kept)] = m;
  count_ = kept + 1;
}

std::optional<Time> PositionStart::newest() const {
  if (count_ == 0) return std::nullopt;
  return waiting_[static_cast<std::size_t>(count_ - 1)].time;
}

/// Direction and rate of a station at a time, from its waiting measurements: a straight line.
std::optional<Ray> PositionStart::rayAt(int station, Time now) const {
  double s0 = 0.0, s1 = 0.0, s2 = 0.0;
  Eigen::Vector3d y0 = Eigen::Vector3d::Zero(), y1 = Eigen::Vector3d::Zero();
  const StationMeasurement* newest = nullptr;
  for (int i = 0; i < count_; ++i) {
    const StationMeasurement& m = waiting_[static_cast<std::size_t>(i)];
    if (m.station != station) continue;
    const double t = seconds(m.time - now) - m.age, w = 2.0 / m.ray.covariance.trace();
    s0 += w;
    s1 += w * t;
    s2 += w * t * t;
    y0 += w * m.ray.direction;
    y1 += w * t * m.ray.direction;
    newest = &m;
  }
  const double D = s0 * s2 - s1 * s1;
  if (!newest || !(D > 1e-9 * s0 * s2)) return std::nullopt;
  Ray ray;
  ray.origin = newest->ray.origin;
  ray.direction = ((s2 * y0 - s1 * y1) / D).normalized();
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - ray.direction * ray.direction.transpose();
  RayMotion motion;
  motion.rate = across * ((s0 * y1 - s1 * y0) / D);
  // White noise through the fit, the slow error on the direction, and of the rate what it may have changed
  // by over the window, for want of better as much as itself.
  const double slow_rate = 2.0 * newest->slow.variance / (newest->slow.time_constant * window_);
  ray.covariance = (s2 / D + newest->slow.variance) * across;
  motion.covariance = (s0 / D + slow_rate + 0.25 * motion.rate.squaredNorm()) * across;
  if (newest->ray.motion) motion.origin_velocity = newest->ray.motion->origin_velocity;
  ray.motion = motion;
  return ray;
}

std::optional<PositionBelief> PositionStart::startAt(Time now) const {
  const auto waiting_end = waiting_.begin() + count_;
  if (std::all_of(waiting_.begin(), waiting_end,
                  [this](const StationMeasurement& m) { return m.station == waiting_[0].station; })) {
    return std::nullopt;
  }
  std::vector<Ray> rays;
  std::vector<int> stations;
  for (int i = 0; i < count_; ++i) {
    const int station = waiting_[static_cast<std::size_t>(i)].station;
    if (std::find(stations.begin(), stations.end(), station) != stations.end()) continue;
    stations.push_back(station);
    if (const auto ray = rayAt(station, now)) rays.push_back(*ray);
  }
  if (rays.size() < 2) return std::nullopt;
  const Crossing crossing = intersect(rays);
  if (crossing.verdict != CrossingVerdict::crossing || !crossing.at.velocity) return std::nullopt;
  const Intersection& at = crossing.at;
  const bool is_good =
      at.relative_sigma < max_relative_sigma_ && at.chi_square < kStartChiSquare * at.degrees;
  if (!is_good) return std::nullopt;
  double range = std::numeric_limits<double>::infinity();
  for (const Ray& ray : rays) range = std::min(range, (at.point - ray.origin).norm());
  PositionBelief belief;
  belief.mean.head<3>() = at.point;
  belief.mean.segment<3>(3) = *at.velocity;
  belief.covariance.topLeftCorner<6, 6>() = at.joint_covariance;
  belief.covariance.diagonal().tail<3>().setConstant(kRateSigma * kRateSigma * range * range);
  return belief;
}

}  // namespace sightline::core
