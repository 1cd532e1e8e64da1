#include "sightline/core/smoothing/bank_smoothing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "sightline/core/model/kinematics.h"
#include "sightline/core/smoothing/step_back.h"

namespace sightline::core {
namespace {

constexpr double kLeastWeight = 5e-4;  // of a model that is still followed back
constexpr double kLongStep = 0.2;      // [units of time]
constexpr int kIterations = 4;         // of a long step that is not linear
constexpr double kLeastDrawn = 1e-3;   // probability of having been drawn that is looked into
constexpr double kLeastSource = 1e-3;  // of a model before, from which one may have been drawn

/// The covariances of a belief for other sizes of its errors: each channel's angles `growth` times as large;
/// kappa is no angle.
void scaleErrors(ResponseBelief& belief, const Eigen::Vector2d& growth, bool is_coupled) {
  Eigen::Vector4d scale[2];
  for (int c = 0; c < 2; ++c) {
    scale[c] << growth(c), growth(c), growth(c), 1.0;
    belief.covariance[c].array() *= (scale[c] * scale[c].transpose()).array();
  }
  if (is_coupled) belief.cross.array() *= (scale[0] * scale[1].transpose()).array();
}

/// Goes over from seconds to units of time of `unit` seconds.
void scaleTime(ResponseBelief& belief, double unit, bool is_coupled) {
  if (unit == 1.0) return;
  const Eigen::Vector4d scale(1.0, unit, unit * unit, unit * unit);
  const Eigen::Matrix4d both = scale * scale.transpose();
  for (int c = 0; c < 2; ++c) {
    belief.mean[c].array() *= scale.array();
    belief.covariance[c].array() *= both.array();
  }
  if (is_coupled) belief.cross.array() *= both.array();
}

/// Mean and covariance of a mixture of two: `share` of `own`, for the rest `other` (S-6).
ResponseBelief mixtureOf(double share, const ResponseBelief& own, const ResponseBelief& other,
                         bool is_coupled) {
  if (share >= 1.0) return own;
  const double rest = 1.0 - share;
  ResponseBelief mixed;
  Eigen::Vector4d offset[2];
  for (int c = 0; c < 2; ++c) {
    offset[c] = own.mean[c] - other.mean[c];
    mixed.mean[c] = other.mean[c] + share * offset[c];
    mixed.covariance[c] = share * own.covariance[c] + rest * other.covariance[c];
    mixed.covariance[c].noalias() += share * rest * offset[c] * offset[c].transpose();
  }
  if (is_coupled) {
    mixed.cross = share * own.cross + rest * other.cross;
    mixed.cross.noalias() += share * rest * offset[0] * offset[1].transpose();
  }
  mixed.noise = share * own.noise + rest * other.noise;
  return mixed;
}

/// Both channels' states, one after the other.
Normal<8> bothOf(const ResponseBelief& belief) {
  Normal<8> both;
  both.mean << belief.mean[0], belief.mean[1];
  both.covariance << belief.covariance[0], belief.cross, belief.cross.transpose(), belief.covariance[1];
  return both;
}

void setBoth(ResponseBelief& belief, const Normal<8>& both) {
  for (int c = 0; c < 2; ++c) {
    belief.mean[c] = both.mean.segment<4>(4 * c);
    belief.covariance[c] = both.covariance.block<4, 4>(4 * c, 4 * c);
  }
  belief.cross = both.covariance.topRightCorner<4, 4>();
}

/// What later sightings say to one model at the end of a step, apart for each channel or together, and the
/// way back from there.
class WayBack {
 public:
  /// `passing`: density of the model's further white acceleration [rad^2/s^3].
  WayBack(const ResponseModel& model, const BankStep& step, double passing)
      : model_(&model), step_(&step), passing_(passing) {}

  /// `before`: what the model believed at the beginning, after the models had interacted; `smoothed`: what it
  /// believes at the end, by all sightings. Returns whether there is a way back.
  bool find(ResponseBelief before, ResponseBelief smoothed) {
    scaleErrors(smoothed, before.noise.cwiseQuotient(smoothed.noise).cwiseSqrt(), step_->is_coupled);
    scaleTime(smoothed, step_->unit, step_->is_coupled);
    scaleTime(before, step_->unit, step_->is_coupled);
    if (step_->is_coupled)
      return findLater(bothSteps(before), bothOf(before).covariance, bothOf(smoothed), both_);
    for (int c = 0; c < 2; ++c) {
      if (!findLater(stepOf(before, c), before.covariance[c],
                     Normal<4>{smoothed.mean[c], smoothed.covariance[c]}, one_[c]))
        return false;
    }
    return true;
  }

  /// A belief at the beginning, given that and the model. Returns the logarithm of the evidence.
  double take(ResponseBelief& belief, bool want_belief = true) const {
    scaleTime(belief, step_->unit, step_->is_coupled);
    double evidence = 0.0;
    if (step_->is_coupled) {
      Normal<8> both = bothOf(belief);
      evidence = stepBack(both, bothSteps(belief), both_, want_belief);
      setBoth(belief, both);
    } else {
      for (int c = 0; c < 2; ++c) {
        const Normal<4> before{belief.mean[c], belief.covariance[c]};
        Normal<4> one = before;
        double found = stepBack(one, stepOf(belief, c), one_[c], want_belief);
        for (int again = 0; again < iterations() && found > kNever; ++again) {
          const Step<4> step = stepAbout(one.mean, belief, c);
          one = before;
          found = stepBack(one, step, one_[c], true);
        }
        evidence += found;
        belief.mean[c] = one.mean;
        belief.covariance[c] = one.covariance;
      }
    }
    scaleTime(belief, 1.0 / step_->unit, step_->is_coupled);
    return evidence;
  }

 private:
  /// In units of time. Of most models the step is the same for every state.
  Step<4> stepOf(const ResponseBelief& belief, int c) const {
    const Eigen::Vector4d& mean = belief.mean[c];
    if (!is_known_ || model_->kind == ResponseModel::Kind::harmonic) {
      transition_ = transitionOf(*model_, mean, step_->units());
      is_known_ = true;
    }
    const double noise = step_->amplitude.follows_noise ? belief.noise(c) : 1.0;
    Step<4> step;
    step.F = transition_.F;
    step.Q = transition_.Q;
    step.Q.topLeftCorner<3, 3>() *= step_->amplitude.squared(c) * noise;
    if (passing_ > 0.0) {
      const double per_unit = passing_ * step_->unit * step_->unit * step_->unit;
      step.Q.topLeftCorner<2, 2>() += whiteAccelerationNoise(step_->units(), per_unit);
    }
    step.mean.head<3>().noalias() = step.F.topLeftCorner<3, 3>() * mean.head<3>();
    step.mean(3) = transition_.mean(3);
    return step;
  }

  /// How often a step is linearised again about what was found: over a gap a harmonic is far from linear.
  int iterations() const {
    const bool is_long = step_->units() > kLongStep;
    return is_long && model_->kind == ResponseModel::Kind::harmonic ? kIterations : 0;
  }

  /// The step, linearised about another state than the belief's.
  Step<4> stepAbout(const Eigen::Vector4d& state, const ResponseBelief& belief, int c) const {
    ResponseBelief there = belief;
    there.mean[c] = state;
    Step<4> step = stepOf(there, c);
    step.mean += step.F * (belief.mean[c] - state);
    return step;
  }

  Step<8> bothSteps(const ResponseBelief& belief) const {
    const Step<4> azimuth = stepOf(belief, 0), elevation = stepOf(belief, 1);
    const Eigen::Matrix4d none = Eigen::Matrix4d::Zero();
    Step<8> both;
    both.mean << azimuth.mean, elevation.mean;
    both.F << azimuth.F, none, none, elevation.F;
    both.Q << azimuth.Q, none, none, elevation.Q;
    return both;
  }

  const ResponseModel* model_;
  const BankStep* step_;
  double passing_;
  mutable Transition transition_;
  mutable bool is_known_ = false;
  Later<4> one_[2];
  Later<8> both_;
};

/// How the learning of the noise stands after the sighting at the end of a step.
NoiseLearning learningAfter(const BankStep& step) {
  NoiseLearning learning = step.learning;
  learning.next(step.units());
  return learning;
}

}  // namespace

SmoothedBank nothingLater(const NogaConsistentEstimator& estimator) {
  SmoothedBank smoothed;
  smoothed.bank = estimator.bank();
  smoothed.weights = estimator.probabilities();
  for (int c = 0; c < 2; ++c) {
    smoothed.noise[c] = estimator.bank().noiseOf(c);
    smoothed.later_noise[c] = ModeArray::Zero(smoothed.weights.size());
  }
  smoothed.noise_weight = estimator.noiseLearning().weight();
  smoothed.is_coupled = estimator.isCoupled();
  smoothed.left_out = estimator.leftOut();
  return smoothed;
}

SmoothedBank smoothedBack(const BankStep& step, const std::vector<ResponseModel>& models,
                          const SmoothedBank& later) {  // (S-145)
  const Eigen::Index count = later.weights.size();
  const ModeArray& before = step.chain.probabilities();
  const ModeArray own = step.chain.ownShares(step.units());
  const ResponseBelief all = step.from.mixture(before, step.is_coupled);
  SmoothedBank back;
  back.bank = step.from;
  back.weights = ModeArray::Zero(count);
  back.is_coupled = step.is_coupled;
  back.left_out = later.left_out;
  back.noise_weight = step.learning.weight();
  const NoiseLearning learning = learningAfter(step);
  const double faded = learning.faded(step.units());
  ModeArray evidence[2] = {ModeArray::Zero(count), ModeArray::Zero(count)};
  for (int c = 0; c < 2; ++c) back.noise[c] = step.from.noiseOf(c);

  back.later_weight =
      faded * (later.later_weight + (learning.isLearning() ? NoiseLearning::weightOfOne() : 0.0));

  const int agilest = agilestStraight(models);
  // Of each model that is in force at the end: whether it had been before, or was drawn within the step.
  double drawn = 0.0, most = 0.0;
  std::optional<WayBack> way_of_drawn;
  Eigen::Vector2d evidence_of_drawn = Eigen::Vector2d::Zero();
  for (Eigen::Index j = 0; j < count; ++j) {
    if (later.weights(j) < kLeastWeight) continue;
    const int model = static_cast<int>(j);
    ResponseBelief belief = step.from.belief(model);
    const ResponseBelief mixed = mixtureOf(own(j), belief, all, step.is_coupled);
    for (int c = 0; c < 2; ++c) {
      const double seen = learning.isLearning() ? learning.evidence(mixed.noise(c), later.noise[c](j)) : 0.0;
      evidence[c](j) = faded * (later.later_noise[c](j) + seen);
    }
    WayBack way(models[static_cast<std::size_t>(j)], step, model == agilest ? step.passing : 0.0);
    double stays = 0.0;
    if (way.find(mixed, later.bank.belief(model))) {
      const double log_own = way.take(belief);
      stays = log_own > kNever ? own(j) : 0.0;
      if (stays > 0.0 && 1.0 - own(j) > kLeastDrawn) {
        ResponseBelief any = all;
        const double log_drawn = way.take(any, false);
        stays = own(j) / (own(j) + (1.0 - own(j)) * std::exp(std::min(log_drawn - log_own, 700.0)));
      }
    }
    back.weights(j) = later.weights(j) * stays;
    back.bank.setBelief(model, belief);
    const double changes = later.weights(j) - back.weights(j);
    drawn += changes;
    if (changes <= most) continue;
    most = changes;
    way_of_drawn = way;
    evidence_of_drawn << evidence[0](j), evidence[1](j);
  }

  // From which it was drawn: by the likeliest of those that were.
  if (drawn > kLeastDrawn && way_of_drawn) {
    ModeArray log_came = ModeArray::Constant(count, kNever);
    ResponseBank came = step.from;
    for (Eigen::Index i = 0; i < count; ++i) {
      if (before(i) < kLeastSource) continue;
      ResponseBelief belief = step.from.belief(static_cast<int>(i));
      const double log_evidence = way_of_drawn->take(belief);
      if (log_evidence <= kNever) continue;
      log_came(i) = std::log(before(i)) + log_evidence;
      came.setBelief(static_cast<int>(i), belief);
    }
    ModeArray weights = (log_came - log_came.maxCoeff()).exp();
    weights *= drawn / weights.sum();
    for (Eigen::Index i = 0; i < count; ++i) {
      if (weights(i) > back.weights(i)) {
        back.bank.setBelief(static_cast<int>(i), came.belief(static_cast<int>(i)));
        for (int c = 0; c < 2; ++c) evidence[c](i) = evidence_of_drawn(c);
      }
      back.weights(i) += weights(i);
    }
  }
  back.weights = (back.weights < kLeastWeight).select(0.0, back.weights);
  back.weights /= back.weights.sum();
  for (int c = 0; c < 2; ++c) back.later_noise[c] = evidence[c];
  return back;
}

BankStep remainderOf(const BankStep& step, const std::vector<ResponseModel>& models, double h) {
  const double units = h / step.unit;
  BankStep rest = step;
  rest.from.interact(step.chain.ownShares(units),
                     step.from.mixture(step.chain.probabilities(), step.is_coupled), step.is_coupled);
  rest.from.step(models, units, step.unit, step.amplitude, step.is_coupled);
  if (step.passing > 0.0) rest.from.addWhiteAcceleration(agilestStraight(models), step.passing, h);
  rest.chain = step.chain.after(units);
  rest.learning.fade(units);
  rest.h = step.h - h;
  return rest;
}

namespace {

/// Of each model, by all sightings.
Eigen::Vector2d noiseOf(const SmoothedBank& smoothed, Eigen::Index model) {  // (S-146)
  const double weight = smoothed.noise_weight + smoothed.later_weight;
  Eigen::Vector2d noise;
  for (int c = 0; c < 2; ++c) {
    noise(c) = (smoothed.noise_weight * smoothed.noise[c](model) + smoothed.later_noise[c](model)) / weight;
  }
  return noise;
}

}  // namespace

Eigen::Vector2d noiseOf(const SmoothedBank& smoothed) {
  Eigen::Vector2d noise = Eigen::Vector2d::Zero();
  for (Eigen::Index model = 0; model < smoothed.weights.size(); ++model)
    noise += smoothed.weights(model) * noiseOf(smoothed, model);
  return noise;
}

AngularState motionOf(const SmoothedBank& smoothed) {
  const ModeArray weights = likelyShares(smoothed.weights, smoothed.left_out);
  if (smoothed.later_weight == 0.0) return smoothed.bank.motion(weights);
  ResponseBank bank = smoothed.bank;
  for (Eigen::Index model = 0; model < smoothed.weights.size(); ++model) {
    if (weights(model) == 0.0) continue;
    ResponseBelief belief = bank.belief(static_cast<int>(model));
    const Eigen::Vector2d growth = noiseOf(smoothed, model).cwiseQuotient(belief.noise).cwiseSqrt();
    scaleErrors(belief, growth, smoothed.is_coupled);
    bank.setBelief(static_cast<int>(model), belief);
  }
  return bank.motion(weights);
}

void turn(SmoothedBank& smoothed, const Eigen::Matrix3d& R_new_old) {
  for (Eigen::Index model = 0; model < smoothed.weights.size(); ++model) {
    if (smoothed.weights(model) == 0.0) continue;
    ResponseBelief belief = smoothed.bank.belief(static_cast<int>(model));
    turn(belief, R_new_old);
    smoothed.bank.setBelief(static_cast<int>(model), belief);
    smoothed.is_coupled = smoothed.is_coupled || belief.cross.cwiseAbs().maxCoeff() > 0.0;
  }
}

}  // namespace sightline::core
