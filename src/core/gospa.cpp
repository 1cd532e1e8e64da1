#include "sightline/core/gospa.h"

#include <cmath>
#include <limits>

#include "sightline/core/assignment.h"
#include "sightline/core/sphere.h"

namespace sightline::core {

Gospa gospa(const std::vector<Eigen::Vector3d>& estimates, const std::vector<Eigen::Vector3d>& truths,
            const GospaParams& params) {
  const double p = params.order,
               alone = std::pow(params.cutoff, p);  // a miss and a false one together cost c^p
  Eigen::MatrixXd cost(estimates.size(), truths.size());
  for (Eigen::Index i = 0; i < cost.rows(); ++i) {
    for (Eigen::Index j = 0; j < cost.cols(); ++j) {
      cost(i, j) = std::pow(angleBetween(estimates[i], truths[j]), p);
    }
  }

  Gospa result;
  double pairs_sum = 0.0;
  const std::vector<int> truth_of = assign(cost, alone);
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    if (truth_of[i] < 0) continue;
    pairs_sum += cost(i, truth_of[i]);
    ++result.assigned;
  }
  result.extra = static_cast<int>(estimates.size()) - result.assigned;
  result.missed = static_cast<int>(truths.size()) - result.assigned;
  result.localisation = std::pow(pairs_sum, 1.0 / p);
  result.distance = std::pow(pairs_sum + 0.5 * alone * (result.missed + result.extra), 1.0 / p);
  return result;
}

void GospaMeans::add(const Gospa& gospa) {
  distance_.add(gospa.distance);
  missed_.add(gospa.missed);
  extra_.add(gospa.extra);
  pairs_sum_ += std::pow(gospa.localisation, params_.order);
  pairs_ += static_cast<std::uint64_t>(gospa.assigned);
}

double GospaMeans::localisation() const {
  if (pairs_ == 0) return std::numeric_limits<double>::quiet_NaN();
  return std::pow(pairs_sum_ / static_cast<double>(pairs_), 1.0 / params_.order);
}

}  // namespace sightline::core
