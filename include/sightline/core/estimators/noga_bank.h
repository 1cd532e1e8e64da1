#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/estimators/estimator.h"
#include "sightline/core/estimators/mode_chain.h"
#include "sightline/core/estimators/noga_models.h"
#include "sightline/core/estimators/noise_learning.h"

namespace sightline::core {

/// The angle that stands for 1 rad of the response models, squared [rad^2], in each channel.
struct BankAmplitude {
  Eigen::Vector2d squared = Eigen::Vector2d::Ones();
  bool follows_noise = false;  ///< in proportion to the noise that each model has learnt
};

/// Of sightings that are not the target's (S-28).
struct SoftGate {
  double outlier_share = 0.0;  ///< in [0, 1)
  double outlier_width = 4.0;  ///< over which they lie at least, in amplitudes, > 0
};

/// The beliefs of NOGA's response models side by side. What is done to one of them is done to all: in blocks
/// of four models, one number of each in an array, which the processor's vector instructions take at once.
///
/// Times are in seconds, angles in the chart [rad]. `is_coupled`: whether the covariances of the azimuth's
/// state with the elevation's are kept; they count as zero otherwise.
class ResponseBank {
 public:
  /// Of 1 to kMaxModes models; each believes in zero, without doubt, and in the noise as stated.
  explicit ResponseBank(int models) : models_(models) {}

  int models() const { return models_; }
  ResponseBelief belief(int model) const;
  void setBelief(int model, const ResponseBelief& belief);

  /// Mean and covariance of the mixture of all (S-6). `weights`: one for each model, they sum to one.
  ResponseBelief mixture(const ModeArray& weights, bool is_coupled) const;

  /// Position and rates of that mixture; models differ in both channels together, so that it is coupled.
  AngularState motion(const ModeArray& weights) const;

  /// The mean of what they believe of the noise.
  Eigen::Vector2d noise(const ModeArray& weights) const;

  /// What each believes of it in a channel; one number for each model.
  ModeArray noiseOf(int channel) const;

  /// Each belief becomes a mixture (S-6): its own by its share in `own`, for the rest `all`.
  void interact(const ModeArray& own, const ResponseBelief& all, bool is_coupled);

  /// Each belief `h` units of time of `unit` seconds later, or earlier, by its model (S-8), (S-17), (S-29).
  void step(const std::vector<ResponseModel>& models, double h, double unit, const BankAmplitude& amplitude,
            bool is_coupled);

  /// Adds to a model's belief what white acceleration of spectral density `density` [rad^2/s^3] in both
  /// channels has done to it in the last `h` seconds.
  void addWhiteAcceleration(int model, double density, double h);

  /// The reduction (20)-(23) of each belief with a sighting, within the soft gate, and what a certain one
  /// tells of the noise (S-11). Returns the log likelihood of each model.
  ModeArray reduce(const Measurement& measurement, const SoftGate& gate, const NoiseLearning& learning,
                   const BankAmplitude& amplitude, bool is_coupled);

 private:
  static constexpr int kLanes = 4;  // models in a block
  static_assert(kMaxModes % kLanes == 0, "blocks are full");
  using Lanes = Eigen::Array<double, kLanes, 1>;

  /// A symmetric matrix of order four for each model of a block: its upper triangle, by rows.
  struct SymmetricLanes {
    static constexpr int kPlace[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
    Lanes values[10];
    Lanes& operator()(int i, int j) { return values[kPlace[i][j]]; }
    const Lanes& operator()(int i, int j) const { return values[kPlace[i][j]]; }
  };
  struct Channel {
    Lanes mean[4];
    SymmetricLanes covariance;
    Lanes noise;  // variance of the sightings over the stated one
  };
  struct Block {
    Block();
    Channel channel[2];
    Lanes cross[4][4];  // the azimuth's state with the elevation's
  };
  struct Transition;  // of one channel
  struct Innovation;  // of both channels

  template <int N>
  ResponseBelief mix(const ModeArray& weights, bool is_coupled) const;
  int blocks() const { return (models_ + kLanes - 1) / kLanes; }
  static Lanes lanesOf(const ModeArray& array, int block);
  static Lanes squaredAmplitude(const Block& block, int channel, const BankAmplitude& amplitude);
  static void scaleTime(Block& block, double unit, bool is_coupled);
  void findTransitions(int block, const std::vector<ResponseModel>& models, double h,
                       Transition* transitions) const;
  static void advance(Channel& channel, const Transition& transition, const Lanes& amplitude_squared);
  static void advanceCross(Block& block, const Transition& azimuth, const Transition& elevation);
  static Lanes takenShare(const Lanes& log_likelihood, const Lanes& outlier_density, const SoftGate& gate,
                          Lanes& log_mixture);
  static void reduceApart(Block& block, const Innovation& innovation);
  static void reduceTogether(Block& block, const Innovation& innovation);
  static void learnNoise(Block& block, const Innovation& innovation, const NoiseLearning& learning,
                         bool is_coupled);

  int models_;
  std::array<Block, kMaxModes / kLanes> blocks_;
};

}  // namespace sightline::core
