#pragma once

#include <tuple>

#include <Eigen/Core>

#include "sightline/core/model/sphere.h"
#include "sightline/core/model/track.h"

namespace sightline::core {

/// The shape of the accepted region.
enum class GateShape {
  ellipse,    ///< Mahalanobis: innovation^T S^-1 innovation <= threshold
  rectangle,  ///< the paper's, channel by channel: innovation_i^2 <= threshold S_ii; it holds the ellipse
};

struct GateParams {
  double probability =
      0.9995;  ///< that a sighting of the target falls into the ellipse, if S is right, in (0, 1)
  GateShape shape = GateShape::ellipse;
  double min_half_width = 0.0;        ///< of the rectangle [rad], >= 0: S is enlarged to reach it
  double max_half_width = kPi / 2.0;  ///< of the rectangle [rad], > 0: nothing beyond is accepted

  friend bool operator==(const GateParams& a, const GateParams& b) {
    return std::tie(a.probability, a.shape, a.min_half_width, a.max_half_width) ==
           std::tie(b.probability, b.shape, b.min_half_width, b.max_half_width);
  }
};

/// Largest accepted distance squared: the quantile of chi^2 with two degrees of freedom, -2 ln(1 -
/// probability).
double gateThreshold(const GateParams& params);

/// Gate (S-3) of a predicted motion for a sighting with covariance R [rad^2]: S = scale * (P + R), enlarged
/// to the minimum; half widths sqrt(threshold S_ii), at most the maximum. `scale` >= 1 is the track's
/// innovation scale.
Gate gateOf(const AngularState& prediction, const Eigen::Matrix2d& R, const GateParams& params,
            double scale = 1.0);

/// innovation^T S^-1 innovation of a gate.
double distanceSquared(const Gate& gate, const Eigen::Vector2d& innovation);

/// Whether an innovation is inside the gate.
bool isInside(const Gate& gate, const Eigen::Vector2d& innovation, const GateParams& params);

}  // namespace sightline::core
