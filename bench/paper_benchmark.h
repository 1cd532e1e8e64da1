#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/estimators/estimator.h"

/// The paper's benchmark: azimuth = sin t, elevation = cos t (amplitude 1 rad), sighted for 10 s at 10 to 50
/// ms.
namespace sightline::bench {

using core::Measurement;

struct Run {
  std::vector<Measurement> sightings;  // in order of time
  std::vector<Eigen::Vector4d> truth;  // (azimuth, elevation, rates) at each sighting
};

/// Motion of the benchmark's target at t [s].
inline Eigen::Vector4d sinusoid(double t) {
  return {std::sin(t), std::cos(t), std::cos(t), -std::sin(t)};
}

/// One run with noise of the given sigma [rad] on both channels; times by (S-1) in ticks of 10 ms.
inline Run simulate(std::uint64_t seed, double sigma, double duration_s = 10.0) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  Run run;
  for (int tick = 0; 0.01 * tick <= duration_s; tick += 1 + static_cast<int>(uniform(random) * 5.0)) {
    Measurement sighting;
    sighting.time = core::Time(std::chrono::milliseconds(10 * tick));
    const Eigen::Vector4d truth = sinusoid(0.01 * tick);
    sighting.position << truth(0) + sigma * normal(random), truth(1) + sigma * normal(random);
    sighting.covariance = Eigen::Matrix2d::Identity() * sigma * sigma;
    run.sightings.push_back(sighting);
    run.truth.push_back(truth);
  }
  return run;
}

/// What a method says about one channel at one sighting. A quantity that it does not give stays NaN.
struct Answer {
  double estimate = std::nan(""), estimate_variance = std::nan("");      // after the sighting
  double prediction = std::nan(""), prediction_variance = std::nan("");  // before it
  double rate = std::nan("");
};

/// Sums of one figure over the runs: the mean and how far chance may have moved it.
class Figure {
 public:
  void add(double value) { sum_ += value, ++count_; }
  void endRun() {
    if (count_ == 0) return;
    means_.push_back(sum_ / static_cast<double>(count_));
    sum_ = 0.0;
    count_ = 0;
  }
  bool isKnown() const { return means_.size() > 1; }
  double mean() const {
    double sum = 0.0;
    for (const double mean : means_) sum += mean;
    return sum / static_cast<double>(means_.size());
  }
  /// Standard error of the mean over independent runs.
  double standardError() const {
    double squares = 0.0;
    for (const double value : means_) squares += std::pow(value - mean(), 2);
    const auto n = static_cast<double>(means_.size());
    return std::sqrt(squares / (n - 1.0) / n);
  }
  double root() const { return std::sqrt(mean()); }
  /// Standard error of the root of the mean.
  double rootStandardError() const { return standardError() / (2.0 * root()); }

 private:
  std::vector<double> means_;  // one for each run: sightings of one run are not independent
  double sum_ = 0.0;
  std::size_t count_ = 0;
};

/// Errors of a method over t in (1, 10] s, both channels together.
struct Score {
  Figure estimate, prediction, rate;      // squared errors [rad^2], [rad^2/s^2]
  Figure estimate_nees, prediction_nees;  // squared errors over the stated variance

  void add(const Answer& answer, double position, double rate_truth) {
    addTo(estimate, estimate_nees, answer.estimate - position, answer.estimate_variance);
    addTo(prediction, prediction_nees, answer.prediction - position, answer.prediction_variance);
    if (!std::isnan(answer.rate)) rate.add(std::pow(answer.rate - rate_truth, 2));
  }
  void endRun() {
    for (Figure* figure : {&estimate, &prediction, &rate, &estimate_nees, &prediction_nees}) figure->endRun();
  }

 private:
  static void addTo(Figure& squares, Figure& nees, double error, double variance) {
    if (std::isnan(error)) return;
    squares.add(error * error);
    if (!std::isnan(variance)) nees.add(error * error / variance);
  }
};

/// A method under test: takes the run's sightings one by one and answers for both channels.
class Method {
 public:
  virtual ~Method() = default;
  virtual void begin() = 0;
  virtual void answer(const Measurement& sighting, Answer (&answers)[2]) = 0;
};

/// A core estimator as a method.
class EstimatorMethod final : public Method {
 public:
  explicit EstimatorMethod(std::function<std::unique_ptr<core::Estimator>()> make) : make_(std::move(make)) {}
  void begin() override { estimator_ = make_(); }
  void answer(const Measurement& sighting, Answer (&answers)[2]) override {
    if (const auto expected = estimator_->stateAt(sighting.time)) {
      for (int channel = 0; channel < 2; ++channel) {
        answers[channel].prediction = expected->mean(channel);
        answers[channel].prediction_variance = expected->covariance(channel, channel);
      }
    }
    estimator_->update(sighting);
    const auto state = estimator_->stateAt(sighting.time);
    for (int channel = 0; channel < 2; ++channel) {
      answers[channel].estimate = state->mean(channel);
      answers[channel].estimate_variance = state->covariance(channel, channel);
      answers[channel].rate = state->mean(channel + 2);
    }
  }

 private:
  std::function<std::unique_ptr<core::Estimator>()> make_;
  std::unique_ptr<core::Estimator> estimator_;
};

/// Scores a method over many runs with consecutive seeds.
inline Score score(Method& method, int runs, double sigma, std::uint64_t first_seed) {
  Score result;
  for (int k = 0; k < runs; ++k) {
    const Run run = simulate(first_seed + static_cast<std::uint64_t>(k), sigma);
    method.begin();
    for (std::size_t i = 0; i < run.sightings.size(); ++i) {
      Answer answers[2];
      method.answer(run.sightings[i], answers);
      if (core::seconds(run.sightings[i].time.time_since_epoch()) <= 1.0) continue;
      for (int channel = 0; channel < 2; ++channel) {
        result.add(answers[channel], run.truth[i](channel), run.truth[i](channel + 2));
      }
    }
    result.endRun();
  }
  return result;
}

}  // namespace sightline::bench
