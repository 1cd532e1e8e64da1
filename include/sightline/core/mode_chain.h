#pragma once

#include <cmath>

#include <Eigen/Core>

#include "sightline/core/kinematics.h"

/// What interacting multiple models have in common, whatever the models are.
namespace sightline::core {

constexpr int kMaxModes = 8;

/// One number for each mode; never more than kMaxModes, so that nothing is allocated.
using ModeArray = Eigen::Array<double, Eigen::Dynamic, 1, 0, kMaxModes, 1>;
using ModeMatrix = Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxModes, kMaxModes>;

/// Probabilities of models that take turns by chance: a mode stays for `h` seconds with probability exp(-h /
/// dwell), and leaves for each of the others alike.
class ModeChain {
 public:
  /// `modes` from 1 to kMaxModes, equally probable at first; `dwell` mean time in one mode [s], > 0.
  ModeChain(int modes, double dwell);

  /// The probabilities by the sightings so far; they sum to one and none is below 1e-12.
  const ModeArray& probabilities() const { return probabilities_; }

  /// The probabilities `h` seconds later.
  ModeArray predicted(double h) const;

  /// Column j: the probability of each mode now, given that mode j will be in force `h` seconds later.
  ModeMatrix mixing(double h) const;

  /// Goes `h` seconds on and takes the log likelihood of a sighting under each mode.
  void update(double h, const ModeArray& log_likelihoods);

 private:
  /// Probability of staying in a mode, and of leaving it for a certain other one.
  struct Transition {
    double stay, leave;
  };
  Transition transition(double h) const;

  double dwell_;
  ModeArray probabilities_;
};

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

}  // namespace sightline::core
