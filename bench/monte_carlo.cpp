#include "monte_carlo.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <Eigen/Cholesky>

#include "sightline/core/model/sphere.h"

#include "parallel.h"
#include "tables.h"

namespace sightline::bench {
namespace {

constexpr int kFirstTick = 100;   // figures count after it: 1 s
constexpr int kRestartAfter = 8;  // rejected sightings in turn

/// A contender that follows one run: sightings outside its gate are kept from it, eight in turn start it
/// anew.
class Follower {
 public:
  explicit Follower(const Contender& contender) : contender_(contender), estimator_(contender.make()) {}

  std::optional<core::AngularState> stateAt(core::Time time) const { return estimator_->stateAt(time); }

  void take(const core::Measurement& measurement, const std::optional<core::AngularState>& expected) {
    if (expected && std::isfinite(contender_.gate) && isOutside(measurement, *expected)) {
      if (++rejected_ < kRestartAfter) return;
      estimator_ = contender_.make();
    }
    rejected_ = 0;
    estimator_->update(measurement);
  }

 private:
  bool isOutside(const core::Measurement& measurement, const core::AngularState& expected) const {
    const Eigen::Vector2d innovation = core::angleDifference(measurement.position, expected.angles());
    const Eigen::Matrix2d S = expected.anglesCovariance() + measurement.covariance;
    return !(innovation.dot(S.llt().solve(innovation)) <= contender_.gate);
  }

  const Contender& contender_;
  std::unique_ptr<core::Estimator> estimator_;
  int rejected_ = 0;
};

struct RunFigures {
  double estimate = 0.0, prediction = 0.0, nees_position = 0.0, nees_state = 0.0, gap = 0.0, gap_nees = 0.0;
  Checkpoints position_at{}, state_at{};
};

Eigen::Vector4d errorOf(const core::AngularState& state, const Eigen::Vector4d& truth) {
  Eigen::Vector4d error = state.mean - truth;
  error.head<2>() = core::angleDifference(state.angles(), truth.head<2>());
  return error;
}

double neesOfPosition(const core::AngularState& state, const Eigen::Vector4d& error) {
  const Eigen::Vector2d position = error.head<2>();
  return position.dot(state.anglesCovariance().llt().solve(position)) / 2.0;
}

double neesOfState(const core::AngularState& state, const Eigen::Vector4d& error) {
  return error.dot(state.covariance.llt().solve(error)) / 4.0;
}

RunFigures follow(const Contender& contender, const Scenario& scenario, const Stream& stream) {
  Follower follower(contender);
  RunFigures figures;
  int counted = 0, seen = 0, checkpoint = 0;
  bool in_gap = false;
  for (std::size_t i = 0; i < stream.size(); ++i) {
    const Instant& instant = stream[i];
    const core::Time time = instant.measurement.time;
    const auto expected = follower.stateAt(time);
    if (instant.seen) follower.take(instant.measurement, expected);
    const auto state = follower.stateAt(time);
    if (!expected || !state) continue;

    const Eigen::Vector4d expected_error = errorOf(*expected, instant.truth);
    const Eigen::Vector4d error = errorOf(*state, instant.truth);
    if (in_gap && instant.seen && scenario.dropout_to > 0.0) {
      figures.gap = expected_error.head<2>().squaredNorm() / 2.0;
      figures.gap_nees = neesOfPosition(*expected, expected_error);
    }
    in_gap = !instant.seen;
    if (instant.tick > kFirstTick) {
      figures.estimate += error.head<2>().squaredNorm() / 2.0;
      figures.nees_position += neesOfPosition(*state, error);
      figures.nees_state += neesOfState(*state, error);
      if (instant.seen) figures.prediction += expected_error.head<2>().squaredNorm() / 2.0, ++seen;
      ++counted;
    }
    const int next_tick = i + 1 < stream.size() ? stream[i + 1].tick : kTicks;
    for (; checkpoint < kCheckpoints && kFirstTick + 10 * checkpoint < next_tick; ++checkpoint) {
      figures.position_at[static_cast<std::size_t>(checkpoint)] = neesOfPosition(*state, error);
      figures.state_at[static_cast<std::size_t>(checkpoint)] = neesOfState(*state, error);
    }
  }
  for (double* sum : {&figures.estimate, &figures.nees_position, &figures.nees_state}) *sum /= counted;
  figures.prediction /= seen;
  return figures;
}

Sample sampleOf(const std::vector<RunFigures>& runs, double RunFigures::*figure) {
  std::vector<double> values;
  for (const RunFigures& run : runs) values.push_back(run.*figure);
  return Sample(std::move(values));
}

Checkpoints meanOf(const std::vector<RunFigures>& runs, Checkpoints RunFigures::*figure) {
  Checkpoints means{};
  for (const RunFigures& run : runs) {
    for (std::size_t k = 0; k < means.size(); ++k)
      means[k] += (run.*figure)[k] / static_cast<double>(runs.size());
  }
  return means;
}

}  // namespace

double Sample::mean() const {
  double sum = 0.0;
  for (const double value : values_) sum += value;
  return sum / static_cast<double>(values_.size());
}

double Sample::standardError() const {
  const double middle = mean(), n = static_cast<double>(values_.size());
  double squares = 0.0;
  for (const double value : values_) squares += (value - middle) * (value - middle);
  return std::sqrt(squares / (n - 1.0) / n);
}

double Sample::root() const {
  return std::sqrt(mean());
}

Ratio rootRatio(const Sample& numerator, const Sample& denominator) {
  const double a = numerator.mean(), b = denominator.mean();
  std::vector<double> relative;  // first-order share of each run in the logarithm of the quotient
  for (std::size_t k = 0; k < numerator.values().size(); ++k)
    relative.push_back(0.5 * (numerator.values()[k] / a - denominator.values()[k] / b));
  return {std::sqrt(a / b), Sample(std::move(relative)).band()};
}

Ratio geometricMean(const std::vector<Ratio>& ratios) {
  double sum = 0.0, squares = 0.0;
  for (const Ratio& ratio : ratios) {
    sum += std::log(ratio.value);
    squares += ratio.log_band * ratio.log_band;
  }
  const auto n = static_cast<double>(ratios.size());
  return {std::exp(sum / n), std::sqrt(squares) / n};
}

std::vector<Score> evaluate(const Scenario& scenario, const Sensors& sensors,
                            const std::vector<Contender>& contenders, const Options& options) {
  std::vector<std::vector<RunFigures>> figures(
      contenders.size(), std::vector<RunFigures>(static_cast<std::size_t>(options.runs)));
  forEachRun(options.runs, options.threads, [&](int run) {
    const Stream stream = simulate(scenario, sensors, run);
    for (std::size_t k = 0; k < contenders.size(); ++k)
      figures[k][static_cast<std::size_t>(run)] = follow(contenders[k], scenario, stream);
  });
  std::vector<Score> scores;
  for (std::size_t k = 0; k < contenders.size(); ++k) {
    Score score;
    score.name = contenders[k].name;
    score.estimate = sampleOf(figures[k], &RunFigures::estimate);
    score.prediction = sampleOf(figures[k], &RunFigures::prediction);
    score.nees_position = sampleOf(figures[k], &RunFigures::nees_position);
    score.nees_state = sampleOf(figures[k], &RunFigures::nees_state);
    score.gap = sampleOf(figures[k], &RunFigures::gap);
    score.gap_nees = sampleOf(figures[k], &RunFigures::gap_nees);
    score.position_at = meanOf(figures[k], &RunFigures::position_at);
    score.state_at = meanOf(figures[k], &RunFigures::state_at);
    scores.push_back(std::move(score));
  }
  return scores;
}

std::size_t bestOf(const std::vector<Score>& scores) {
  std::size_t best = 0;
  for (std::size_t k = 1; k < scores.size(); ++k)
    if (scores[k].estimate.mean() < scores[best].estimate.mean()) best = k;
  return best;
}

}  // namespace sightline::bench
