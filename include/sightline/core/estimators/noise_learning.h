#pragma once

#include <algorithm>
#include <cmath>
#include <tuple>
#include <type_traits>

#include <Eigen/Core>

namespace sightline::core {

/// How the scale of the sightings' noise is learnt.
struct NoiseLearningParams {
  bool enabled = true;      ///< false: the stated covariances are taken at their word
  double memory = 1.5;      ///< over which the sightings count [s], > 0
  double trust = 2.0;       ///< sightings that the stated covariance counts for at first, > 0
  double min_scale = 1e-3;  ///< least variance over the stated one, in (0, 1]
  double max_scale = 1e2;   ///< largest, >= 1

  friend bool operator==(const NoiseLearningParams& a, const NoiseLearningParams& b) {
    return std::tie(a.enabled, a.memory, a.trust, a.min_scale, a.max_scale) ==
           std::tie(b.enabled, b.memory, b.trust, b.min_scale, b.max_scale);
  }
};

/// The variance s^2 of the sightings' white noise over the stated one, integrated out (S-11): an inverse
/// gamma distribution whose mean each competing model of the motion keeps for itself and for each channel,
/// while its weight, which is kept here, is common to all. A model of gain q / R has the same gain at every
/// s^2, so that learning s^2 scales its covariances and leaves its estimate as it is.
class NoiseLearning {
 public:
  /// Throws std::invalid_argument for a parameter out of range.
  explicit NoiseLearning(const NoiseLearningParams& params);

  /// Whether it learns from now on. It begins anew; the scales are their owner's.
  void enable(bool enabled);

  /// `h` seconds go by: what has been learnt counts less.
  void fade(double h);

  /// A sighting comes `h` seconds after the last one. The first few tell of the rate alone.
  void next(double h);

  /// What has been learnt counts for twice so many innovations of one channel.
  double weight() const { return weight_; }

  /// What the last innovation added to the sum of which scale times weight is the result, given the scale
  /// before and after: half the squared innovation over what it would be at a scale of one.
  double evidence(double before, double after) const {
    return std::max(weight_ * after - (weight_ - kOneSighting) * before, 0.0);
  }

  /// The weight of one innovation, as `weight` counts it.
  static constexpr double weightOfOne() { return kOneSighting; }

  /// The share that is left of a weight after `h` seconds.
  double faded(double h) const { return std::exp(-h / params_.memory); }

  /// Log density of one channel's innovation by what was known before it (after `next`), given its square
  /// over S and log S: Student's t, or the normal one where nothing is learnt. `Number`: double, or an array
  /// of them, of one model each.
  template <typename Number>
  Number logDensity(const Number& distance_squared, const Number& log_S) const {
    using std::log1p;
    if (!params_.enabled) return -0.5 * (distance_squared + log_S + kLog2Pi);
    const double weight = counts_ ? weight_ - kOneSighting : weight_;  // before it
    return -0.5 * (log_S + kLog2Pi) - (weight + 0.5) * log1p(Number(distance_squared / (2.0 * weight)));
  }

  /// Whether innovations tell of the noise already.
  bool isLearning() const { return params_.enabled && counts_; }

  /// The scale after a sighting, given the one before and the squared innovation over S with it.
  template <typename Number>
  Number learnt(const Number& scale, const Number& distance_squared) const {  // (S-11)
    if (!isLearning()) return scale;
    const Number seen = scale * ((weight_ - kOneSighting) + kOneSighting * distance_squared) / weight_;
    if constexpr (std::is_arithmetic_v<Number>)
      return std::clamp(seen, params_.min_scale, params_.max_scale);
    else
      return seen.max(params_.min_scale).min(params_.max_scale);
  }

 private:
  static constexpr double kLog2Pi = 1.8378770664093454836;
  static constexpr int kSightingsOfTheRate = 3;  // whose innovations are those of a motion not known yet
  static constexpr double kOneSighting = 0.5;    // weight of a channel's innovation

  NoiseLearningParams params_;
  double weight_;  // a of the inverse gamma distribution of one channel
  int sightings_ = 0;
  bool counts_ = false;  // whether the innovation of the last sighting counts, and is in the weight
};

}  // namespace sightline::core
