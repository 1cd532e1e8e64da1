#pragma once

#include <memory>
#include <optional>
#include <tuple>
#include <vector>

#include "sightline/core/estimators/bank_step.h"
#include "sightline/core/estimators/estimator.h"
#include "sightline/core/estimators/mode_chain.h"
#include "sightline/core/estimators/noga_bank.h"
#include "sightline/core/estimators/noga_models.h"
#include "sightline/core/estimators/noise_learning.h"
#include "sightline/core/estimators/rate_prior.h"
#include "sightline/core/estimators/revisit_time.h"
#include "sightline/core/estimators/sighting_noise.h"

namespace sightline::core {

/// Amplitude over the sightings' sigma where the amplitude is not given.
constexpr double kSigmasOfAmplitude = 10.0;

struct NogaConsistentParams {
  /// 1 to kMaxModes models, chosen on the scenarios of section 7.1 and on recordings of fireballs and a
  /// drone: straight flight from dead calm to hard turns at the scale of the sensor; harmonic motion, calm
  /// and lively, with the seed of fast oscillation (section 4.3); manoeuvres that fade. Harmonic motion
  /// attracts, as it pays for its parameters late; its seed does not, as two or three sightings may look like
  /// an oscillation.
  std::vector<ResponseModel> models = defaultResponseModels();
  double amplitude =
      0.0;  ///< that 1 rad of the bank stands for [rad]; 0 = ten sigmas of the sightings: free of scale
  double initial_rate_sigma = 0.0;  ///< of each rate at first [rad/s], >= 0; 0 = not known (InitialRate)
  double dwell = 60.0;              ///< mean time between changes of the model [units of time], > 0
  double outlier_share = 0.01;      ///< of sightings that are not the target's, in [0, 1)
  double outlier_width = 4.0;       ///< over which they lie, in amplitudes, > 0
  double least_drawn = 1e-3;        ///< below which models do not interact (ModeChain), in [0, 1)
  double left_out = 0.01;           ///< of the models' probability in what is published, in [0, 1)
  NoiseLearningParams noise;        ///< what the sightings' noise really is

  friend bool operator==(const NogaConsistentParams& a, const NogaConsistentParams& b) {
    return std::tie(a.models, a.amplitude, a.initial_rate_sigma, a.dwell, a.outlier_share, a.outlier_width,
                    a.least_drawn, a.left_out, a.noise) ==
           std::tie(b.models, b.amplitude, b.initial_rate_sigma, b.dwell, b.outlier_share, b.outlier_width,
                    b.least_drawn, b.left_out, b.noise);
  }
};

/// The settings of section 4.3 to the letter: six models for an amplitude of 1 rad, the sightings' noise as
/// stated.
NogaConsistentParams bankOfSection43();

/// NOGA, form `consistent` (section 4.3): the uncertainty reduction (20)-(23) run as a recursion, with the
/// process noise and the coefficient of the auto-regression among the parameters, in a bank of interacting
/// response models with one mode chain for azimuth and elevation.
///
/// With parameters a = (state, process noise), C_a = blkdiag(P, Q), S = H [F, I] and C_p = 0 the reduction
/// followed by the propagation is the Kalman recursion; it is carried out in that form (a test holds the two
/// equal). The channels stay apart, as cheap as two small filters, until a sighting couples them.
///
/// Times in the settings are in units of time (RevisitTime), seconds for most sensors; of slower ones the
/// most agile straight model of a bank that is free of scale expects targets that pass by (S-97). Each model
/// learns the scale of the sightings' noise for itself (S-11), channel by channel: a model that explains the
/// innovations by calm sightings and a lively target competes with one that explains them by the opposite.
class NogaConsistentEstimator final : public Estimator {
 public:
  /// Throws std::invalid_argument for a parameter out of range.
  explicit NogaConsistentEstimator(const NogaConsistentParams& params);
  NogaConsistentEstimator(const NogaConsistentEstimator&) = default;

  std::unique_ptr<Estimator> clone() const override;
  void update(const Measurement& measurement) override { take(measurement, nullptr); }
  std::optional<AngularState> stateAt(Time time) const override;
  std::vector<Hypothesis> hypothesesAt(Time time) const override;
  bool knowsRates() const override { return !rate_.isOpen(); }
  Eigen::Vector2d noiseScale() const override;
  void learnNoise(bool enabled) override;
  void rotate(const Eigen::Matrix3d& R_new_old) override;

  /// The same as `update`. Returns the step to this sighting, with which a smoother comes back; nullopt when
  /// the sighting is the first, or comes so late that the estimator starts anew.
  std::optional<BankStep> updateWithStep(const Measurement& measurement);

  /// Whether a sighting at `time` comes so late after the last one that the estimator would start anew.
  bool startsAnewAt(Time time) const;

  /// What each model believes of the target at the last sighting.
  const ResponseBank& bank() const { return bank_; }

  /// How far the noise has been learnt by then.
  const NoiseLearning& noiseLearning() const { return noise_learning_; }

  /// Probability of the models that may be left out of what is published.
  double leftOut() const { return params_.left_out; }

  /// Whether covariances of azimuth with elevation are kept.
  bool isCoupled() const { return is_coupled_; }

  /// Which model is in force then.
  const ModeChain& chain() const { return chain_; }

  /// Probability of each model by the sightings so far.
  const ModeArray& probabilities() const { return chain_.probabilities(); }

 private:
  /// What was expected last: predicting a sighting, weighing it and taking it ask for the same. A copy
  /// begins without.
  class Expectation {
   public:
    Expectation() = default;
    Expectation(const Expectation&) {}
    Expectation& operator=(const Expectation&) = delete;
    bool isFor(double h) const { return h_ == h; }
    const ResponseBank& bank() const { return *bank_; }
    ResponseBank& begin(double h, const ResponseBank& from) {
      if (bank_)
        *bank_ = from;
      else
        bank_ = std::make_unique<ResponseBank>(from);
      h_ = h;
      return *bank_;
    }
    void forget() { h_.reset(); }

   private:
    std::optional<double> h_;  // time ahead of the last sighting [s]
    std::unique_ptr<ResponseBank> bank_;
  };

  int modes() const { return static_cast<int>(params_.models.size()); }
  BankAmplitude amplitude() const;
  double passing(double h) const;
  void take(const Measurement& measurement, std::optional<BankStep>* step);
  void start(const Measurement& measurement);
  void setUnknown(double h);
  const ResponseBank& expected(double h) const;

  NogaConsistentParams params_;
  ModeChain chain_;
  std::optional<Time> time_;  // of the last sighting
  ResponseBank bank_;         // then, by each model
  SightingNoise sighting_noise_;
  RevisitTime revisit_;
  InitialRate rate_;
  NoiseLearning noise_learning_;
  bool is_second_look_ = false;  // the sighting is the second of a target whose rates nobody knew
  mutable Expectation ahead_;
  bool is_coupled_ = false;  // whether covariances of azimuth with elevation are kept
};

}  // namespace sightline::core
