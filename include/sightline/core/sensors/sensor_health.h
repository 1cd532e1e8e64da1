#pragma once

#include <array>
#include <optional>
#include <tuple>

#include <Eigen/Core>

#include "sightline/core/model/time.h"

namespace sightline::core {

enum class SensorVerdict {
  healthy,
  noisy,  ///< its noise has grown: used with a larger variance
  biased  ///< it is off to one side: not used
};

/// How a sensor's sightings are used.
struct SensorUse {
  bool is_excluded = false;
  double noise_scale = 1.0;  ///< factor on the stated variances of sightings that are used, > 0

  bool isAsStated() const { return !is_excluded && noise_scale == 1.0; }
};

/// How an alarm is interpreted.
enum class HealthForm {
  specified,  ///< noise or bias by the sum that gave the alarm
  refined  ///< noise or bias by the likelihood (S-52) of what came since the change; its size from that alone
};

/// Change detection on the innovations of one sensor: CUSUM tests (Page 1954), (S-49) to (S-53). Numbers
/// without unit are log likelihood ratios, or factors on the stated variance; a sigma is that of the
/// innovation. At thresholds of 12 healthy sensors of 33 Hz gave 0.7 false alarms an hour; 14 adds 20 ms to
/// the delay.
struct SensorHealthParams {
  HealthForm form = HealthForm::refined;
  double noise_threshold = 14.0;    ///< evidence at which the noise counts as grown, > 0
  double noise_ratio = 4.0;         ///< of the variance that is tested for, > 1
  double largest_evidence = 6.0;    ///< that one sighting may count for in a channel, > 0
  double bias_threshold = 14.0;     ///< of the cumulated sums of the mean, > 0
  double bias_slack = 0.5;          ///< half the bias that is tested for [sigma], > 0
  double largest_innovation = 3.0;  ///< to which an innovation is cut in the sums of the mean [sigma], > 0
  double memory = 0.6;              ///< time constant of the sizes [s], > 0
  double largest_scale = 400.0;     ///< that one sighting may count for in the size of the noise, > 1
  double least_scale = 4.0;         ///< of the variance at the alarm, >= 1
  double noise_release = 1.5;       ///< scale of the variance below which the sensor has recovered, > 1
  double bias_release = 0.35;       ///< mean innovation below which it has [sigma], > 0
  double least_exclusion = 1.0;     ///< that an exclusion lasts [s], >= 0

  friend bool operator==(const SensorHealthParams& a, const SensorHealthParams& b) {
    return std::tie(a.form, a.noise_threshold, a.noise_ratio, a.largest_evidence, a.bias_threshold,
                    a.bias_slack, a.largest_innovation, a.memory, a.largest_scale, a.least_scale,
                    a.noise_release, a.bias_release, a.least_exclusion) ==
           std::tie(b.form, b.noise_threshold, b.noise_ratio, b.largest_evidence, b.bias_threshold,
                    b.bias_slack, b.largest_innovation, b.memory, b.largest_scale, b.least_scale,
                    b.noise_release, b.bias_release, b.least_exclusion);
  }
};

/// One number for each channel that a sensor measures: one or two, nothing is allocated.
using PerChannel = Eigen::Array<double, Eigen::Dynamic, 1, 0, 2, 1>;

/// A sighting of a sensor against what the track expected without it.
struct Innovation {
  PerChannel nu;         ///< sighting - prediction [rad]
  PerChannel predicted;  ///< variance of the prediction, P [rad^2], >= 0
  PerChannel stated;     ///< variance that the sensor states, R [rad^2], > 0
  /// Mean innovation of the other sensors that see the track, lately [rad]: the error of the track itself,
  /// where it does not follow the target. Empty = not known.
  PerChannel shared = PerChannel();
};

/// A change of a sensor's verdict.
struct HealthChange {
  Time time{};                                     ///< when it was noticed
  Time began{};                                    ///< of the first sighting that indicated it
  SensorVerdict verdict = SensorVerdict::healthy;  ///< from now on; healthy = it has recovered
  double scale = 1.0;                              ///< of the variance
  PerChannel bias;                                 ///< mean innovation [sigma]
};

/// The watch over one sensor. Plain state: copies are independent, equal input gives equal bits.
class SensorHealth {
 public:
  /// A cumulated sum (Page 1954) that starts anew whenever it falls to zero, and the innovations since it was
  /// more than a little.
  struct CumulatedSum {
    double value = 0.0;
    Time began{};  ///< of the present excursion: its first sighting
    double sightings = 0.0;
    PerChannel u, squares;  ///< sums of the innovations [sigma] and of their squares
    double ratio = 0.0;     ///< sum of the variances over the stated ones, mean of the channels

    void add(double evidence, Time time, const PerChannel& u_now, double ratio_now);
    void note(const PerChannel& u_now, double ratio_now);
    void forget(double share);
  };

  /// Watches from `since` on. `channels`: 1 or 2. Throws std::invalid_argument for parameters out of range.
  explicit SensorHealth(const SensorHealthParams& params, Time since, int channels = 2);

  /// Takes the innovation of a sighting; times do not go back. Several of one time (of several tracks) count
  /// together as one for the sizes.
  void take(Time time, const Innovation& innovation);

  /// The change of the verdict by what was taken up to `time`; none when the verdict stays.
  std::optional<HealthChange> judge(Time time);

  /// Both.
  std::optional<HealthChange> add(Time time, const Innovation& innovation);

  /// Judges by the thresholds of these from now on; what has been summed up stays.
  void setThresholds(const SensorHealthParams& params);

  /// Starts anew, as for a sensor of which nothing is known.
  void forget(Time time);

  /// Withdraws the present verdict: no other sensor is left to compare with.
  HealthChange release(Time time);

  SensorVerdict verdict() const { return verdict_; }

  /// How the sensor is to be used: with a noise scale >= 1 where its noise has grown, not at all where it is
  /// biased.
  SensorUse use() const;

  /// The last change; none before the first.
  const std::optional<HealthChange>& lastChange() const { return last_change_; }

  /// Mean innovation since the last change, while the sensor is not healthy [sigma].
  PerChannel biasSinceChange() const;

  const CumulatedSum& noiseSum() const { return noise_; }                          ///< g
  const CumulatedSum& biasAboveSum(int channel) const { return above_[channel]; }  ///< g+
  const CumulatedSum& biasBelowSum(int channel) const { return below_[channel]; }  ///< g-
  double scale() const { return scale_; }           ///< v: variance over the stated one, running mean
  const PerChannel& bias() const { return mean_; }  ///< m: running mean of the cut innovations [sigma]

 private:
  void cumulate(Time time, const Innovation& innovation, const PerChannel& u, double ratio);
  void average(Time time, const PerChannel& u, double ratio);
  const CumulatedSum& largestBiasSum() const;
  std::optional<HealthChange> alarm(Time time);
  std::optional<HealthChange> reconsider(Time time);
  bool hasRecovered(Time time) const;
  HealthChange change(Time time, Time began, SensorVerdict verdict);

  SensorHealthParams params_;
  SensorVerdict verdict_ = SensorVerdict::healthy;
  std::optional<HealthChange> last_change_;
  CumulatedSum noise_;
  std::array<CumulatedSum, 2> above_, below_;  // by channel
  CumulatedSum since_change_;                  // while it is not healthy, of the last `memory`
  double scale_ = 1.0;
  PerChannel mean_;

  // Of the instant under way: the sizes before it and what it has brought.
  Time last_;
  double share_ = 0.0;
  double scale_before_ = 1.0;
  PerChannel mean_before_;
  int innovations_ = 0;
  double ratio_sum_ = 0.0;
  PerChannel u_sum_;
};

}  // namespace sightline::core
