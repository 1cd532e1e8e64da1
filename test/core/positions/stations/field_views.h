#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/positions/local_view.h"

/// Four stations round a field, what they see, and what may be wrong with one, for tests.
namespace sightline::test {

constexpr double kViewSigma = 5e-4;  // [rad]
constexpr double kRateSigma = 2e-3;  // [rad/s]
const std::vector<Eigen::Vector3d> kOrigins{{0, 0, 0}, {100, 0, 2}, {90, 110, 5}, {-30, 90, 1}};

inline core::LocalView viewOf(std::size_t station, int target, const core::Ray& ray) {
  return {{static_cast<int>(station), static_cast<std::uint32_t>(target + 1)}, ray, {}};
}

struct Fault {
  double clock = 0.0;  // stamps later than they should be [s]
  Eigen::Vector3d turned = Eigen::Vector3d::Zero();
};

}  // namespace sightline::test
