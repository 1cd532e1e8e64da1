#pragma once

#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/estimators/estimator.h"
#include "sightline/core/model/kinematics.h"

/// What interacting multiple models have in common, whatever the models are.
namespace sightline::core {

constexpr int kMaxModes = 16;

/// One number for each mode; never more than kMaxModes, so that nothing is allocated.
using ModeArray = Eigen::Array<double, Eigen::Dynamic, 1, 0, kMaxModes, 1>;

/// Probabilities of models that take turns by chance: now and then a mode is drawn anew, each in proportion
/// to its attraction. With equal attractions a mode stays for `h` seconds with probability exp(-h / dwell)
/// and leaves for each of the others alike.
class ModeChain {
 public:
  /// `attraction`: 1 to kMaxModes numbers > 0, in proportion to the probabilities at first and to those of
  /// being drawn; `dwell` mean time in one mode [s], > 0; `least_drawn`: see ownShares, in [0, 1).
  ModeChain(const ModeArray& attraction, double dwell, double least_drawn = 0.0);

  /// The probabilities by the sightings so far; they sum to one and none is below 1e-12.
  const ModeArray& probabilities() const { return probabilities_; }

  /// The probabilities `h` seconds later.
  ModeArray predicted(double h) const;

  /// The chain `h` seconds later, when nothing has been seen by then.
  ModeChain after(double h) const;

  /// Where a mode that is in force `h` seconds later comes from, by Bayes' rule: with this probability from
  /// itself, because none was drawn; for the rest from any, as they are probable now. Interaction is then a
  /// mixture of a model's own belief with that of all, which needs to be made only once. A rest below
  /// `least_drawn` counts as none: merged step after step into one normal distribution, improbable changes of
  /// the model would be process noise that the calmest of them does not have.
  ModeArray ownShares(double h) const;

  /// Goes `h` seconds on and takes the log likelihood of a sighting under each mode.
  void update(double h, const ModeArray& log_likelihoods);

 private:
  double drawnProbability(double h) const;

  double dwell_;
  double least_drawn_;
  ModeArray attraction_;  // sums to one
  ModeArray probabilities_;
};

/// The probabilities without those of the least probable modes that sum to at most `left_out`, below one;
/// they sum to one again. Rates of an agile target, improbable as they are, would make the covariance of a
/// mixture by themselves: what is left out is described no worse by a covariance without them.
ModeArray likelyShares(const ModeArray& probabilities, double left_out);

/// Mean and covariance of a mixture (S-6). `weights`: an array that sums to one; a weight of zero leaves its
/// motion out.
template <int N, typename Weights>
Motion<N> mixture(const Weights& weights, const Motion<N>* motions) {
  Motion<N> mixed;
  for (Eigen::Index i = 0; i < weights.size(); ++i) mixed.mean += weights(i) * motions[i].mean;
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    if (!(weights(i) > 0.0)) continue;
    const Eigen::Matrix<double, N, 1> offset = motions[i].mean - mixed.mean;
    mixed.covariance += weights(i) * motions[i].covariance;
    mixed.covariance.noalias() += (weights(i) * offset) * offset.transpose();
  }
  mixed.covariance = symmetric(mixed.covariance);
  return mixed;
}

/// The same mixture undecided, its parts with a weight alone.
template <int N, typename Weights>
std::vector<Hypothesis> hypothesesOf(const Weights& weights, const Motion<N>* motions) {
  std::vector<Hypothesis> hypotheses;
  for (Eigen::Index i = 0; i < weights.size(); ++i)
    if (weights(i) > 0.0) hypotheses.push_back({weights(i), motions[i].angularState()});
  return hypotheses;
}

/// Mean and covariance of a mixture of two: `share`, in [0, 1], of `own`, for the rest `other`.
template <int N>
Motion<N> mixture(double share, const Motion<N>& own, const Motion<N>& other) {
  Motion<N> mixed;
  const Eigen::Matrix<double, N, 1> offset = own.mean - other.mean;
  mixed.mean = other.mean + share * offset;
  mixed.covariance = share * own.covariance + (1.0 - share) * other.covariance;
  mixed.covariance.noalias() += (share * (1.0 - share) * offset) * offset.transpose();
  return mixed;
}

}  // namespace sightline::core
