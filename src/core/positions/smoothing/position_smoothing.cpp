#include "sightline/core/positions/smoothing/position_smoothing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include <Eigen/Cholesky>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kLeastWeight = 5e-4;  // of a model that is still followed back
constexpr double kLeastDrawn = 1e-3;   // probability of having been drawn that is looked into
constexpr double kLeastSource = 1e-3;  // of a model before, from which one may have been drawn
constexpr double kWorse = 1.5;     // variance of the position over the filter's with which nothing was told
constexpr double kNever = -1e300;  // logarithm of the evidence for what cannot be

/// Rows of a state or matrix: the motion, and the slots of the stations that are in the state at both ends.
using Rows = std::vector<Eigen::Index>;

PositionVector pick(const PositionVector& x, const Rows& rows) {
  PositionVector picked(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) picked(static_cast<Eigen::Index>(i)) = x(rows[i]);
  return picked;
}

PositionMatrix pickRows(const PositionMatrix& M, const Rows& rows) {
  PositionMatrix picked(rows.size(), M.cols());
  for (std::size_t i = 0; i < rows.size(); ++i) picked.row(static_cast<Eigen::Index>(i)) = M.row(rows[i]);
  return picked;
}

PositionMatrix pick(const PositionMatrix& M, const Rows& rows) {
  return pickRows(pickRows(M, rows).transpose(), rows);
}

/// F P for the step's transition (P-4).
PositionMatrix transitionTimes(const PositionStep& step, const PositionModel& model,
                               const PositionMatrix& P) {
  PositionMatrix FP = P;
  const double h = step.h;
  FP.middleRows<3>(0) += h * P.middleRows<3>(3);
  if (model.kind == PositionModel::Kind::white_jerk) {
    FP.middleRows<3>(0) += 0.5 * h * h * P.middleRows<3>(6);
    FP.middleRows<3>(3) += h * P.middleRows<3>(6);
  } else if (h > 0.0) {
    FP.middleRows<3>(6).setZero();
  }
  for (std::size_t slot = 0; slot < step.stations.size(); ++slot) {
    const auto at = kMotionSize + 2 * static_cast<Eigen::Index>(slot);
    FP.middleRows<2>(at) *= std::exp(-h / step.slow[slot].time_constant);
  }
  return FP;
}

/// Inverse of a symmetric positive definite matrix, and the logarithm of its determinant's root.
struct Inverse {
  PositionMatrix matrix;
  double log_root = 0.0;
  bool exists = false;

  explicit Inverse(const PositionMatrix& A) {
    const Eigen::LLT<PositionMatrix> factors(A);
    if (factors.info() != Eigen::Success) return;
    const Eigen::Index n = A.rows();
    matrix = factors.solve(PositionMatrix::Identity(n, n));
    matrix = (0.5 * (matrix + matrix.transpose())).eval();
    log_root = factors.matrixLLT().diagonal().array().log().sum();
    exists = matrix.allFinite() && std::isfinite(log_root);
  }
};

/// What later measurements say to one model at the end of a step, and the way back from there.
class WayBack {
 public:
  WayBack(const PositionStep& step, const PositionModel& model, const Rows& rows)
      : step_(&step), model_(&model), rows_(&rows) {}

  /// `before`: what the model believed at the beginning, after the models had interacted; `smoothed`: what it
  /// believes at the end, by all measurements, of the rows alone. Returns whether there is a way back.
  bool find(const PositionBelief& before, const PositionBelief& smoothed) {  // (S-144)
    const PositionBelief predicted = predictedFrom(before);
    const Inverse filter(predicted.covariance), known(smoothed.covariance);
    if (!filter.exists || !known.exists) return false;
    origin_ = predicted.mean;
    y_ = known.matrix * (smoothed.mean - predicted.mean);
    Y_ = known.matrix - filter.matrix;
    return true;
  }

  /// A belief at the beginning, given that and the model. Returns the logarithm of the evidence, kNever where
  /// the numbers do not allow it.
  double take(PositionBelief& belief, bool want_belief = true) const {  // (S-143)
    const PositionBelief after = predictedFrom(belief);
    const Inverse predicted(after.covariance);
    if (!predicted.exists) return kNever;
    const Inverse both(predicted.matrix + Y_);
    if (!both.exists) return kNever;
    const PositionVector offset = after.mean - origin_;
    const PositionVector pull = y_ - Y_ * offset;
    const PositionVector shift = both.matrix * pull;
    const double evidence =
        0.5 * pull.dot(shift) + offset.dot(y_ - 0.5 * Y_ * offset) - predicted.log_root - both.log_root;
    if (!want_belief) return evidence;
    const PositionMatrix FP = pickRows(transitionTimes(*step_, *model_, belief.covariance), *rows_);
    const PositionMatrix G = FP.transpose() * predicted.matrix;
    PositionMatrix P = belief.covariance;
    P.noalias() -= G * FP;
    const PositionMatrix G_both = G * both.matrix;
    P.noalias() += G_both * G.transpose();
    belief.mean += G * shift;
    belief.covariance = 0.5 * (P + P.transpose());
    return evidence;
  }

 private:
  PositionBelief predictedFrom(const PositionBelief& belief) const {
    PositionBelief after = belief;
    if (step_->h > 0.0) predict(after, *model_, step_->unit_squared, step_->h, step_->slow);
    after.mean = pick(after.mean, *rows_);
    after.covariance = pick(after.covariance, *rows_);
    return after;
  }

  const PositionStep* step_;
  const PositionModel* model_;
  const Rows* rows_;
  PositionVector origin_, y_;
  PositionMatrix Y_;
};

PositionBelief mixtureOf(const ModeArray& weights, const std::vector<PositionBelief>& beliefs) {  // (S-6)
  PositionBelief all;
  bool is_first = true;
  for (Eigen::Index mode = 0; mode < weights.size(); ++mode) {
    if (!(weights(mode) > 0.0)) continue;
    const PositionBelief& belief = beliefs[static_cast<std::size_t>(mode)];
    if (is_first) all.mean = PositionVector::Zero(belief.mean.size());
    is_first = false;
    all.mean += weights(mode) * belief.mean;
  }
  all.covariance = PositionMatrix::Zero(all.mean.size(), all.mean.size());
  for (Eigen::Index mode = 0; mode < weights.size(); ++mode) {
    if (!(weights(mode) > 0.0)) continue;
    const PositionBelief& belief = beliefs[static_cast<std::size_t>(mode)];
    const PositionVector offset = belief.mean - all.mean;
    all.covariance += weights(mode) * belief.covariance;
    all.covariance.noalias() += (weights(mode) * offset) * offset.transpose();
  }
  return all;
}

/// `share` of `own`, for the rest `other` (S-6).
PositionBelief mixtureOf(double share, const PositionBelief& own, const PositionBelief& other) {
  if (share >= 1.0) return own;
  const PositionVector offset = own.mean - other.mean;
  PositionBelief mixed;
  mixed.mean = other.mean + share * offset;
  mixed.covariance = share * own.covariance + (1.0 - share) * other.covariance;
  mixed.covariance.noalias() += (share * (1.0 - share) * offset) * offset.transpose();
  return mixed;
}

/// Of the state at the end of a step, and of the same state at its beginning.
struct CommonRows {
  Rows before, after;
};

/// Without the acceleration where it is not of the model, which forgets it in every step.
CommonRows commonRows(const std::vector<int>& before, const std::vector<int>& after,
                      PositionModel::Kind kind) {
  CommonRows rows;
  const int motion = kind == PositionModel::Kind::white_jerk ? kMotionSize : 6;
  for (Eigen::Index i = 0; i < motion; ++i) {
    rows.before.push_back(i);
    rows.after.push_back(i);
  }
  for (std::size_t slot = 0; slot < before.size(); ++slot) {
    const auto found = std::find(after.begin(), after.end(), before[slot]);
    if (found == after.end()) continue;
    for (Eigen::Index k = 0; k < 2; ++k) {
      rows.before.push_back(kMotionSize + 2 * static_cast<Eigen::Index>(slot) + k);
      rows.after.push_back(kMotionSize + 2 * (found - after.begin()) + k);
    }
  }
  return rows;
}

}  // namespace

SmoothedPositionBank nothingLater(const PositionStep& step) {
  return {step.from, step.chain.probabilities(), step.stations};
}

SmoothedPositionBank smoothedBack(const PositionStep& step, const std::vector<PositionModel>& models,
                                  const SmoothedPositionBank& later) {  // (P-18)
  const Eigen::Index count = later.weights.size();
  const ModeArray& before = step.chain.probabilities();
  const ModeArray own = step.chain.ownShares(step.h);
  const PositionBelief all = mixtureOf(before, step.from);
  using Kind = PositionModel::Kind;
  const CommonRows with = commonRows(step.stations, later.stations, Kind::white_jerk);
  const CommonRows without = commonRows(step.stations, later.stations, Kind::white_acceleration);
  SmoothedPositionBank back{step.from, ModeArray::Zero(count), step.stations};

  // Of each model that is in force at the end: whether it had been before, or was drawn within the step.
  double drawn = 0.0, most = 0.0;
  std::optional<WayBack> way_of_drawn;
  for (Eigen::Index j = 0; j < count; ++j) {
    if (later.weights(j) < kLeastWeight) continue;
    const auto at = static_cast<std::size_t>(j);
    PositionBelief& belief = back.beliefs[at];
    const CommonRows& rows = models[at].kind == Kind::white_jerk ? with : without;
    const PositionBelief smoothed{pick(later.beliefs[at].mean, rows.after),
                                  pick(later.beliefs[at].covariance, rows.after)};
    WayBack way(step, models[at], rows.before);
    double stays = 0.0;
    if (way.find(mixtureOf(own(j), belief, all), smoothed)) {
      const double log_own = way.take(belief);
      stays = log_own > kNever ? own(j) : 0.0;
      if (stays > 0.0 && 1.0 - own(j) > kLeastDrawn) {
        PositionBelief any = all;
        const double log_drawn = way.take(any, false);
        stays = own(j) / (own(j) + (1.0 - own(j)) * std::exp(std::min(log_drawn - log_own, 700.0)));
      }
    }
    back.weights(j) = later.weights(j) * stays;
    const double changes = later.weights(j) - back.weights(j);
    drawn += changes;
    if (changes <= most) continue;
    most = changes;
    way_of_drawn = way;
  }

  // From which it was drawn: by the likeliest of those that were.
  if (drawn > kLeastDrawn && way_of_drawn) {
    ModeArray log_came = ModeArray::Constant(count, kNever);
    std::vector<PositionBelief> came = step.from;
    for (Eigen::Index i = 0; i < count; ++i) {
      if (before(i) < kLeastSource) continue;
      const double log_evidence = way_of_drawn->take(came[static_cast<std::size_t>(i)]);
      if (log_evidence > kNever) log_came(i) = std::log(before(i)) + log_evidence;
    }
    if (log_came.maxCoeff() > kNever) {
      ModeArray weights = (log_came - log_came.maxCoeff()).exp();
      weights *= drawn / weights.sum();
      for (Eigen::Index i = 0; i < count; ++i) {
        const auto at = static_cast<std::size_t>(i);
        if (weights(i) > back.weights(i)) back.beliefs[at] = came[at];
        back.weights(i) += weights(i);
      }
    }
  }
  back.weights = (back.weights < kLeastWeight).select(0.0, back.weights);
  if (!(back.weights.sum() > 0.0)) return nothingLater(step);  // no way back: what the filter knew
  back.weights /= back.weights.sum();
  // An update by one station alone (P-6) is no optimal one; what is found behind it may be worse than before.
  const double variance = positionOf(back).covariance.topLeftCorner<3, 3>().trace();
  if (!(variance <= kWorse * all.covariance.topLeftCorner<3, 3>().trace())) return nothingLater(step);
  return back;
}

PositionStep remainderOf(const PositionStep& step, const std::vector<PositionModel>& models, double h) {
  PositionStep rest = step;
  const ModeArray own = step.chain.ownShares(h);
  const PositionBelief all = mixtureOf(step.chain.probabilities(), step.from);
  for (std::size_t mode = 0; mode < models.size(); ++mode) {
    rest.from[mode] = mixtureOf(own(static_cast<Eigen::Index>(mode)), step.from[mode], all);
    predict(rest.from[mode], models[mode], step.unit_squared, h, step.slow);
  }
  rest.chain = step.chain.after(h);
  rest.h = step.h - h;
  return rest;
}

SmoothedPosition positionOf(const SmoothedPositionBank& smoothed) {
  const PositionBelief all = mixtureOf(smoothed.weights, smoothed.beliefs);
  return {all.mean.head<6>(), symmetric(all.covariance.topLeftCorner<6, 6>())};
}

}  // namespace sightline::core
