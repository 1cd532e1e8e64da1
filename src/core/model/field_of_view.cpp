#include "sightline/core/model/field_of_view.h"

#include <cmath>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kRim = 1e-12;  // [rad]: rounding of a direction on the rim

}  // namespace

bool FieldOfView::holds(const Eigen::Vector3d& direction_tracking) const {
  const Eigen::Vector2d off_boresight = anglesOf(R_sensor_tracking * direction_tracking).cwiseAbs();
  return (off_boresight.array() <= half_widths.array() + kRim).all();
}

double FieldOfView::solidAngle() const {  // (S-20)
  return 4.0 * half_widths.x() * std::sin(half_widths.y());
}

}  // namespace sightline::core
