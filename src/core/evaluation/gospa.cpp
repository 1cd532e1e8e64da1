#include "sightline/core/evaluation/gospa.h"

#include <cmath>
#include <limits>

#include "sightline/core/association/assignment.h"
#include "sightline/core/model/sphere.h"

namespace sightline::core {

Gospa gospaOfDistances(const Eigen::MatrixXd& distances, const GospaParams& params) {
  const double p = params.order,
               alone = std::pow(params.cutoff, p);  // a miss and a false one together cost c^p
  const Eigen::MatrixXd cost = distances.unaryExpr([p](double distance) { return std::pow(distance, p); });
  Gospa result;
  double pairs_sum = 0.0;
  const std::vector<int> truth_of = assign(cost, alone);
  for (Eigen::Index i = 0; i < cost.rows(); ++i) {
    const int truth = truth_of[static_cast<std::size_t>(i)];
    if (truth < 0) continue;
    pairs_sum += cost(i, truth);
    ++result.assigned;
  }
  result.extra = static_cast<int>(cost.rows()) - result.assigned;
  result.missed = static_cast<int>(cost.cols()) - result.assigned;
  result.localisation = std::pow(pairs_sum, 1.0 / p);
  result.distance = std::pow(pairs_sum + 0.5 * alone * (result.missed + result.extra), 1.0 / p);
  return result;
}

Gospa gospa(const std::vector<Eigen::Vector3d>& estimates, const std::vector<Eigen::Vector3d>& truths,
            const GospaParams& params) {
  // A pair further apart than c costs no less than its members alone, and a chord is shorter than its arc.
  Eigen::MatrixXd distances = Eigen::MatrixXd::Constant(estimates.size(), truths.size(), kForbidden);
  for (Eigen::Index i = 0; i < distances.rows(); ++i) {
    for (Eigen::Index j = 0; j < distances.cols(); ++j) {
      if ((estimates[i] - truths[j]).squaredNorm() > params.cutoff * params.cutoff) continue;
      distances(i, j) = angleBetween(estimates[i], truths[j]);
    }
  }
  return gospaOfDistances(distances, params);
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
