#include "sightline/core/evaluation/gospa.h"

#include <cmath>
#include <limits>

#include "sightline/core/association/assignment.h"
#include "sightline/core/model/sphere.h"

namespace sightline::core {

Gospa gospa(const std::vector<Eigen::Vector3d>& estimates, const std::vector<Eigen::Vector3d>& truths,
            const GospaParams& params) {
  const double p = params.order,
               alone = std::pow(params.cutoff, p);  // a miss and a false one together cost c^p
  // A pair further apart than c costs no less than its members alone, and a chord is shorter than its arc.
  Eigen::MatrixXd cost =
      Eigen::MatrixXd::Constant(estimates.size(), truths.size(), std::numeric_limits<double>::infinity());
  for (Eigen::Index i = 0; i < cost.rows(); ++i) {
    for (Eigen::Index j = 0; j < cost.cols(); ++j) {
      if ((estimates[i] - truths[j]).squaredNorm() > params.cutoff * params.cutoff) continue;
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
  pairs_.add(std::pow(gospa.localisation, params_.order));
  assigned_ += static_cast<std::uint64_t>(gospa.assigned);
}

double GospaMeans::localisation() const {
  if (assigned_ == 0) return std::numeric_limits<double>::quiet_NaN();
  const double sum = pairs_.mean() * static_cast<double>(pairs_.count());
  return std::pow(sum / static_cast<double>(assigned_), 1.0 / params_.order);
}

double GospaMeans::localisationCost() const {
  return std::pow(pairs_.mean(), 1.0 / params_.order);
}

double GospaMeans::missedCost() const {
  return costOf(missed_.mean());
}

double GospaMeans::extraCost() const {
  return costOf(extra_.mean());
}

double GospaMeans::costOf(double count) const {
  return params_.cutoff * std::pow(0.5 * count, 1.0 / params_.order);
}

double GospaMeans::rms() const {
  const double alone = 0.5 * std::pow(params_.cutoff, params_.order);
  return std::pow(pairs_.mean() + alone * (missed_.mean() + extra_.mean()), 1.0 / params_.order);
}

}  // namespace sightline::core
