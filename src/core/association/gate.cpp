#include "sightline/core/association/gate.h"

#include <algorithm>
#include <cmath>

#include "sightline/core/model/chi_square.h"

namespace sightline::core {

double gateThreshold(const GateParams& params) {  // (S-19)
  return chiSquareQuantile2(params.probability);
}

Gate gateOf(const AngularState& prediction, const Eigen::Matrix2d& R, const GateParams& params,
            double scale) {  // (S-3)
  const double threshold = gateThreshold(params);
  const double least_variance = params.min_half_width * params.min_half_width / threshold;
  Gate gate;
  gate.centre = prediction.angles();
  gate.covariance = scale * (prediction.anglesCovariance() + R);  // (S-3)
  for (int channel = 0; channel < 2; ++channel) {
    gate.covariance(channel, channel) = std::max(gate.covariance(channel, channel), least_variance);
    gate.half_width(channel) =
        std::min(std::sqrt(threshold * gate.covariance(channel, channel)), params.max_half_width);
  }
  return gate;
}

double distanceSquared(const Gate& gate, const Eigen::Vector2d& innovation) {
  const Eigen::Matrix2d& S = gate.covariance;
  const double determinant = S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0);
  return (S(1, 1) * innovation.x() * innovation.x() - (S(0, 1) + S(1, 0)) * innovation.x() * innovation.y() +
          S(0, 0) * innovation.y() * innovation.y()) /
         determinant;
}

bool isInside(const Gate& gate, const Eigen::Vector2d& innovation, const GateParams& params) {  // (S-3)
  const bool in_rectangle = (innovation.cwiseAbs().array() <= gate.half_width.array()).all();
  if (params.shape == GateShape::rectangle) return in_rectangle;
  return in_rectangle && distanceSquared(gate, innovation) <= gateThreshold(params);
}

}  // namespace sightline::core
