#pragma once

#include <array>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "sightline/core/time.h"

namespace sightline::core {

enum class SensorVerdict {
  healthy,
  noisy,  ///< its noise has grown: used with a larger variance
  biased  ///< it is off to one side: not used
};

/// Change detection on the innovations of one sensor (section 5.1). Numbers without unit are in sigmas of the
/// innovation or in units of its log likelihood.
struct SensorHealthParams {
  double noise_threshold = 12.0;  ///< log likelihood ratio at which the noise counts as grown, > 0
  double noise_ratio = 4.0;       ///< of the variance that is tested for, over the stated one, > 1
  double largest_evidence = 6.0;  ///< log likelihood ratio that one sighting may count for in a channel, > 0
  double bias_threshold = 12.0;   ///< of the mean's cumulated sums, > 0
  double bias_slack = 0.5;        ///< half the bias that is tested for [sigma], > 0
  double largest_innovation = 3.0;  ///< to which an innovation is cut in the sums of the mean [sigma], > 0
  double memory = 0.6;              ///< time constant of the sizes [s], > 0
  double largest_scale = 400.0;     ///< that the variance may be found grown by, > 1
  double least_scale = 4.0;         ///< of the variance at the alarm, >= 1
  double noise_release = 1.5;       ///< scale of the variance below which the sensor has recovered, > 1
  double bias_release = 0.35;       ///< mean innovation below which it has [sigma], > 0
  double least_exclusion = 1.0;     ///< that an exclusion lasts [s], >= 0
};

/// One number for each channel that a sensor measures: one or two, nothing is allocated.
using PerChannel = Eigen::Array<double, Eigen::Dynamic, 1, 0, 2, 1>;

/// A sighting of a sensor against what the track expected.
struct Innovation {
  PerChannel nu;         ///< sighting - prediction [rad]
  PerChannel predicted;  ///< variance of the prediction, P [rad^2], >= 0
  PerChannel stated;     ///< variance that the sensor states, R [rad^2], > 0
};

/// A change of a sensor's verdict.
struct HealthChange {
  Time time{};                                     ///< when it was noticed
  Time began{};                                    ///< of the first sighting that spoke for it
  SensorVerdict verdict = SensorVerdict::healthy;  ///< from now on; healthy = it has recovered
  double scale = 1.0;                              ///< of the variance, over the stated one
  PerChannel bias;                                 ///< mean innovation over the stated sigma
};

/// The watch over one sensor. Plain state: copies are independent, equal input gives equal bits.
class SensorHealth {
 public:
  /// Watches from `since` on. `channels`: 1 or 2. Throws std::invalid_argument for parameters out of range.
  explicit SensorHealth(const SensorHealthParams& params, Time since, int channels = 2);

  /// Takes the innovation of a sighting; times do not go back. Says when the verdict changes.
  std::optional<HealthChange> add(Time time, const Innovation& innovation);

  SensorVerdict verdict() const { return verdict_; }

  /// Factor on the stated variance with which the sensor is to be used: 1, or >= 1 where its noise has
  /// grown, infinity where it is not to be used.
  double noiseScale() const;

  /// The last change; none before the first.
  const std::optional<HealthChange>& lastChange() const { return last_change_; }

  /// A cumulated sum that starts anew whenever it falls to zero.
  struct CumulatedSum {
    double value = 0.0;
    Time began{};  ///< of the present excursion: its first sighting

    void add(double evidence, Time time);
  };
  const CumulatedSum& noiseSum() const { return noise_; }                          ///< g
  const CumulatedSum& biasAboveSum(int channel) const { return above_[channel]; }  ///< g+
  const CumulatedSum& biasBelowSum(int channel) const { return below_[channel]; }  ///< g-
  double scale() const { return scale_; }           ///< v: variance over the stated one, running mean
  const PerChannel& bias() const { return mean_; }  ///< m: running mean of the cut innovations [sigma]

 private:
  void cumulate(Time time, const Innovation& innovation, const PerChannel& u);
  void average(Time time, const Innovation& innovation, const PerChannel& u);
  std::optional<HealthChange> judge(Time time);
  std::optional<HealthChange> alarm(Time time);
  bool hasRecovered(Time time) const;
  HealthChange change(Time time, Time began, SensorVerdict verdict);

  SensorHealthParams params_;
  Time last_;
  SensorVerdict verdict_ = SensorVerdict::healthy;
  std::optional<HealthChange> last_change_;
  CumulatedSum noise_;
  std::array<CumulatedSum, 2> above_, below_;  // by channel
  double scale_ = 1.0;
  PerChannel mean_;
};

}  // namespace sightline::core
