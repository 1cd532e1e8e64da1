#include "baselines.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>

#include "sightline/core/estimators/estimators.h"
#include "sightline/core/model/sphere.h"

namespace sightline::bench {
namespace {

/// Transition over h of one channel; a constant-velocity model forgets its acceleration.
Eigen::Matrix3d transition(BaselineModel::Kind kind, double h) {
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  F(0, 1) = h;
  if (kind == BaselineModel::Kind::velocity) {
    F(2, 2) = 0.0;
  } else {
    F(0, 2) = 0.5 * h * h;
    F(1, 2) = h;
  }
  return F;
}

/// Process noise over h; what a constant-velocity model does not know of its acceleration is N(0, 1^2), so
/// that a constant-acceleration model has something to start from when the mode changes.
Eigen::Matrix3d processNoise(const BaselineModel& model, double h, double scale) {
  const double h2 = h * h, h3 = h2 * h, variance = scale * scale;
  Eigen::Matrix3d Q = Eigen::Matrix3d::Zero();
  if (model.kind == BaselineModel::Kind::velocity) {
    Q.topLeftCorner<2, 2>() << h3 / 3.0, h2 / 2.0, h2 / 2.0, h;
    Q *= model.q * variance;
    Q(2, 2) = variance;
  } else {
    Q << h3 * h2 / 20.0, h2 * h2 / 8.0, h3 / 6.0, h2 * h2 / 8.0, h3 / 3.0, h2 / 2.0, h3 / 6.0, h2 / 2.0, h;
    Q *= model.q * variance;
  }
  return Q;
}

Contender contender(std::string name, const BaselineParams& params) {
  return {std::move(name), [params] { return std::make_unique<BaselineEstimator>(params); },
          std::numeric_limits<double>::infinity()};
}

}  // namespace

void BaselineEstimator::start(const core::Measurement& measurement) {
  const double variance = params_.scale * params_.scale;
  beliefs_.assign(params_.models.size(), {});
  for (Belief& belief : beliefs_) {
    belief.probability = 1.0 / static_cast<double>(beliefs_.size());
    for (int channel = 0; channel < 2; ++channel) {
      belief.mean[channel](0) = measurement.position(channel);
      belief.covariance[channel].diagonal() << measurement.covariance(channel, channel), 4.0 * variance,
          4.0 * variance;
    }
  }
}

/// Interaction over h: the probabilities before the sighting, and what each model starts from.
std::vector<BaselineEstimator::Belief> BaselineEstimator::mixed(double h) const {
  const std::size_t n = beliefs_.size();
  if (n == 1 || h <= 0.0) return beliefs_;
  const double stay = std::exp(-h / params_.dwell), leave = (1.0 - stay) / static_cast<double>(n - 1);
  std::vector<Belief> result(n);
  for (std::size_t j = 0; j < n; ++j) {
    Belief& to = result[j];
    std::vector<double> weights(n);
    for (std::size_t i = 0; i < n; ++i) {
      weights[i] = (i == j ? stay : leave) * beliefs_[i].probability;
      to.probability += weights[i];
    }
    for (double& weight : weights) weight /= to.probability;
    for (int channel = 0; channel < 2; ++channel) {
      for (std::size_t i = 0; i < n; ++i) to.mean[channel] += weights[i] * beliefs_[i].mean[channel];
      for (std::size_t i = 0; i < n; ++i) {
        const Eigen::Vector3d apart = beliefs_[i].mean[channel] - to.mean[channel];
        to.covariance[channel] += weights[i] * (beliefs_[i].covariance[channel] + apart * apart.transpose());
      }
    }
  }
  return result;
}

std::vector<BaselineEstimator::Belief> BaselineEstimator::expected(double h) const {
  std::vector<Belief> beliefs = mixed(h);
  if (h <= 0.0) return beliefs;
  for (std::size_t j = 0; j < beliefs.size(); ++j) {
    const Eigen::Matrix3d F = transition(params_.models[j].kind, h);
    const Eigen::Matrix3d Q = processNoise(params_.models[j], h, params_.scale);
    for (int channel = 0; channel < 2; ++channel) {
      beliefs[j].mean[channel] = F * beliefs[j].mean[channel];
      beliefs[j].covariance[channel] = F * beliefs[j].covariance[channel] * F.transpose() + Q;
    }
  }
  return beliefs;
}

/// Updates both channels, each with a soft gate of its own; returns the logarithm of the likelihood.
double BaselineEstimator::reduce(Belief& belief, const core::Measurement& measurement) const {
  double log_likelihood = 0.0;
  for (int channel = 0; channel < 2; ++channel) {
    Eigen::Matrix3d& P = belief.covariance[channel];
    const double S = P(0, 0) + measurement.covariance(channel, channel);
    const double innovation = measurement.position(channel) - belief.mean[channel](0);
    const double log_genuine =
        -0.5 * (innovation * innovation / S + std::log(2.0 * sightline::core::kPi * S));
    const double genuine = (1.0 - params_.outlier_share) * std::exp(log_genuine);
    const double wild = params_.outlier_share / (4.0 * params_.scale);
    const double beta = params_.outlier_share > 0.0 ? genuine / (genuine + wild) : 1.0;
    const Eigen::Vector3d K = P.col(0) / S;
    belief.mean[channel] += beta * innovation * K;
    P -= (beta * S - beta * (1.0 - beta) * innovation * innovation) * K * K.transpose();
    P = core::symmetric(P);
    log_likelihood += params_.outlier_share > 0.0 ? std::log(genuine + wild) : log_genuine;
  }
  return log_likelihood;
}

void BaselineEstimator::update(const core::Measurement& measurement) {
  if (!time_) {
    start(measurement);
    time_ = measurement.time;
    return;
  }
  beliefs_ = expected(core::seconds(measurement.time - *time_));
  time_ = measurement.time;
  std::vector<double> log_weights;
  for (Belief& belief : beliefs_)
    log_weights.push_back(std::log(belief.probability) + reduce(belief, measurement));
  const double best = *std::max_element(log_weights.begin(), log_weights.end());
  double sum = 0.0;
  for (std::size_t j = 0; j < beliefs_.size(); ++j) {
    beliefs_[j].probability = std::max(std::exp(log_weights[j] - best), 1e-12);
    sum += beliefs_[j].probability;
  }
  for (Belief& belief : beliefs_) belief.probability /= sum;
}

std::optional<core::AngularState> BaselineEstimator::stateAt(core::Time time) const {
  if (!time_) return std::nullopt;
  const std::vector<Belief> beliefs = expected(core::seconds(time - *time_));
  core::AngularState state;
  for (int channel = 0; channel < 2; ++channel) {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
    for (const Belief& belief : beliefs) mean += belief.probability * belief.mean[channel].head<2>();
    for (const Belief& belief : beliefs) {
      const Eigen::Vector2d apart = belief.mean[channel].head<2>() - mean;
      covariance +=
          belief.probability * (belief.covariance[channel].topLeftCorner<2, 2>() + apart * apart.transpose());
    }
    for (int row = 0; row < 2; ++row) {
      state.mean(channel + 2 * row) = mean(row);
      for (int column = 0; column < 2; ++column)
        state.covariance(channel + 2 * row, channel + 2 * column) = covariance(row, column);
    }
  }
  return state;
}

void BaselineEstimator::rotate(const Eigen::Matrix3d&) {
  throw std::logic_error("a baseline keeps the chart it started in");
}

std::vector<Contender> kalmanFilters(double scale, double outlier_share) {
  using Kind = BaselineModel::Kind;
  std::vector<Contender> all;
  const auto add = [&](const char* name, Kind kind, double q) {
    BaselineParams params;
    params.models = {{kind, q}};
    params.scale = scale;
    params.outlier_share = outlier_share;
    char label[32];
    std::snprintf(label, sizeof label, "KF %s %g", name, q);
    all.push_back(contender(label, params));
  };
  for (const double q : {0.001, 0.01, 0.03, 0.1, 0.3, 0.5, 0.8, 2.0, 5.0}) add("CV", Kind::velocity, q);
  for (const double q : {0.1, 0.3, 0.6, 1.0, 3.0, 10.0, 30.0}) add("CA", Kind::acceleration, q);
  return all;
}

std::vector<Contender> imms(double scale, double outlier_share) {
  constexpr auto kCv = BaselineModel::Kind::velocity, kCa = BaselineModel::Kind::acceleration;
  std::vector<Contender> all;
  const auto add = [&](const char* name, std::vector<BaselineModel> models, double dwell) {
    BaselineParams params;
    params.models = std::move(models);
    params.dwell = dwell;
    params.scale = scale;
    params.outlier_share = outlier_share;
    all.push_back(contender(name, params));
  };
  add("IMM CV.01+CV.8 t3", {{kCv, 0.01}, {kCv, 0.8}}, 3.0);
  add("IMM CV.01+CV.8 t10", {{kCv, 0.01}, {kCv, 0.8}}, 10.0);
  add("IMM CV.01+CA1 t3", {{kCv, 0.01}, {kCa, 1.0}}, 3.0);
  add("IMM CV.01+CA3 t10", {{kCv, 0.01}, {kCa, 3.0}}, 10.0);
  add("IMM CA.1+CA3 t3", {{kCa, 0.1}, {kCa, 3.0}}, 3.0);
  add("IMM CA.3+CA1 t3", {{kCa, 0.3}, {kCa, 1.0}}, 3.0);
  return all;
}

std::vector<Contender> ours(double gate) {
  core::EstimatorParams noga, twbls;
  noga.kind = core::EstimatorKind::noga;
  twbls.kind = core::EstimatorKind::twbls;
  return {{"NOGA", [noga] { return core::makeEstimator(noga); }, gate},
          {"TWBLS", [twbls] { return core::makeEstimator(twbls); }, gate}};
}

std::vector<Contender> otherEstimators(double gate) {
  core::EstimatorParams imm, kalman, twbls, noga;
  imm.kind = core::EstimatorKind::imm;
  kalman.kind = core::EstimatorKind::kalman;
  twbls.kind = core::EstimatorKind::twbls;
  twbls.twbls_form = core::EstimatorForm::paper;
  noga.kind = core::EstimatorKind::noga;
  noga.noga_form = core::EstimatorForm::paper;
  std::vector<Contender> all;
  const auto add = [&](const char* name, const core::EstimatorParams& params) {
    all.push_back({name, [params] { return core::makeEstimator(params); }, gate});
  };
  add("IMM default", imm);
  add("Kalman default", kalman);
  add("TWBLS paper", twbls);
  add("NOGA paper", noga);
  return all;
}

}  // namespace sightline::bench
