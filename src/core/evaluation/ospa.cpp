#include "sightline/core/evaluation/ospa.h"

#include <algorithm>
#include <cmath>

namespace sightline::core {

Ospa ospa(const std::vector<Eigen::Vector3d>& estimates, const std::vector<Eigen::Vector3d>& truths,
          const GospaParams& params) {
  return ospa(gospa(estimates, truths, params), params);
}

Ospa ospa(const Gospa& gospa, const GospaParams& params) {
  const int larger = gospa.assigned + std::max(gospa.missed, gospa.extra);
  if (larger == 0) return {};
  const double p = params.order, at_cutoff = std::pow(params.cutoff, p);
  const int far = std::min(gospa.missed, gospa.extra);  // pairs further apart than the cutoff
  const int more = std::abs(gospa.missed - gospa.extra);
  const double localisation = (std::pow(gospa.localisation, p) + at_cutoff * far) / larger;
  const double cardinality = at_cutoff * more / larger;
  return {std::pow(localisation + cardinality, 1.0 / p), std::pow(localisation, 1.0 / p),
          std::pow(cardinality, 1.0 / p)};
}

}  // namespace sightline::core
