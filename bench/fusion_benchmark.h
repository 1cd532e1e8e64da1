#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "sightline/core/estimators/estimator.h"
#include "sightline/core/fusion/track_fusion.h"

#include "paper_benchmark.h"

/// Track fusion on the paper's benchmark: several synchronous sensors, each with a tracker of its own, and a
/// fusion of their tracks (reference: E5). Everything is scaled to an amplitude of 1 mrad, where the sphere
/// is flat.
namespace sightline::bench {

constexpr double kAmplitude = 1e-3;  // [rad]

using EstimatorMaker = std::function<std::unique_ptr<core::Estimator>()>;
enum class Target { sinusoid, white_acceleration };

/// Density of the white acceleration of the target and of the reference's Kalman filters, amplitude 1
/// [1/s^3].
constexpr double kDensity = 0.3;

/// A target's motion at irregular times, amplitude 1.
class TargetMotion {
 public:
  TargetMotion(Target target, std::mt19937_64& random) : target_(target), random_(random) {
    state_ << 0.0, 0.0, 0.5 * normal_(random_), 0.5 * normal_(random_);
  }

  Eigen::Vector4d at(double t) {
    if (target_ == Target::sinusoid) return bench::sinusoid(t);
    const double h = t - time_;
    time_ = t;
    if (h <= 0.0) return state_;
    Eigen::Matrix2d Q;
    Q << h * h * h / 3.0, h * h / 2.0, h * h / 2.0, h;
    const Eigen::Matrix2d root = Eigen::LLT<Eigen::Matrix2d>(kDensity * Q).matrixL();
    for (int channel = 0; channel < 2; ++channel) {
      const Eigen::Vector2d jolt = root * Eigen::Vector2d(normal_(random_), normal_(random_));
      state_(channel) += h * state_(channel + 2) + jolt(0);
      state_(channel + 2) += jolt(1);
    }
    return state_;
  }

 private:
  Target target_;
  std::mt19937_64& random_;
  std::normal_distribution<double> normal_;
  double time_ = 0.0;
  Eigen::Vector4d state_;
};

/// Errors of a fused (or local) track against the truth, over t in (1, 10] s.
struct FusionScore {
  Figure squares;        // of the position, a channel, amplitude 1
  Figure position_nees;  // over 2
  Figure state_nees;     // over 4

  double rmse() const { return squares.root(); }

  void add(const core::AngularState& state, const Eigen::Vector4d& truth) {
    const Eigen::Vector4d error = state.mean - kAmplitude * truth;
    const Eigen::Vector2d position = error.head<2>();
    squares.add(position.squaredNorm() / (2.0 * kAmplitude * kAmplitude));
    position_nees.add(position.dot(state.anglesCovariance().llt().solve(position)) / 2.0);
    state_nees.add(error.dot(state.covariance.llt().solve(error)) / 4.0);
  }
  void endRun() {
    for (Figure* figure : {&squares, &position_nees, &state_nees}) figure->endRun();
  }
};

struct FusionExperiment {
  Target target = Target::sinusoid;
  std::vector<double> sigmas;     // of the sensors, amplitude 1
  EstimatorMaker make_estimator;  // of every local tracker, for angles of `kAmplitude`
  bool synchronous = true;        // all sensors sight at the same times; otherwise each at its own
  int runs = 100;
  std::uint64_t first_seed = 1;
};

/// A local tracker reduced to its estimator, which is told that every sighting is the target's.
class LocalSource {
 public:
  LocalSource(std::size_t number, double sigma, const EstimatorMaker& make)
      : name_("sensor_" + std::to_string(number)), sigma_(sigma), estimator_(make()) {}

  core::LocalReport sight(core::Time time, const Eigen::Vector4d& truth, std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    core::Measurement sighting;
    sighting.time = time;
    sighting.position =
        kAmplitude * (truth.head<2>() + sigma_ * Eigen::Vector2d(normal(random), normal(random)));
    sighting.covariance = Eigen::Matrix2d::Identity() * std::pow(kAmplitude * sigma_, 2);
    estimator_->update(sighting);
    core::Track track;
    track.id = 1;
    track.status = core::TrackStatus::confirmed;
    track.state = *estimator_->stateAt(time);
    track.last_sighting = time;
    track.hits = ++hits_;
    track.sources = {name_};
    return {name_, time, {track}};
  }

 private:
  std::string name_;
  double sigma_;
  std::unique_ptr<core::Estimator> estimator_;
  std::uint32_t hits_ = 0;
};

/// One score for each fusion, and one (the last) for the first sensor's own track.
struct FusionScores {
  std::vector<FusionScore> fused;
  FusionScore local;
  std::size_t broken = 0;  // instants at which a fusion had not exactly one track with all sensors in it
};

/// Times of one run in ticks of 10 ms, by (S-1).
inline std::vector<int> sightingTicks(std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform;
  std::vector<int> ticks;
  for (int tick = 0; tick <= 1000; tick += 1 + static_cast<int>(uniform(random) * 5.0)) ticks.push_back(tick);
  return ticks;
}

/// Which sensors sight at each tick of one run.
inline std::vector<std::vector<std::size_t>> schedule(const FusionExperiment& experiment,
                                                      std::mt19937_64& random) {
  std::vector<std::vector<std::size_t>> sensors_at(1001);
  std::vector<int> ticks = sightingTicks(random);
  for (std::size_t sensor = 0; sensor < experiment.sigmas.size(); ++sensor) {
    if (!experiment.synchronous && sensor > 0) ticks = sightingTicks(random);
    for (const int tick : ticks) sensors_at[static_cast<std::size_t>(tick)].push_back(sensor);
  }
  return sensors_at;
}

inline FusionScores score(const FusionExperiment& experiment,
                          const std::vector<core::TrackFusionParams>& fusions) {
  FusionScores scores;
  scores.fused.resize(fusions.size());
  for (int run = 0; run < experiment.runs; ++run) {
    std::mt19937_64 random(experiment.first_seed + static_cast<std::uint64_t>(run));
    TargetMotion target(experiment.target, random);
    std::vector<LocalSource> sources;
    for (std::size_t i = 0; i < experiment.sigmas.size(); ++i) {
      sources.emplace_back(i, experiment.sigmas[i], experiment.make_estimator);
    }
    std::vector<core::TrackFusion> nodes(fusions.begin(), fusions.end());

    const auto sensors_at = schedule(experiment, random);
    for (std::size_t tick = 0; tick < sensors_at.size(); ++tick) {
      if (sensors_at[tick].empty()) continue;
      const double t = 0.01 * static_cast<double>(tick);
      const core::Time time(std::chrono::seconds(1) + std::chrono::milliseconds(10 * tick));
      const Eigen::Vector4d truth = target.at(t);
      std::vector<core::FusionReport> answers(nodes.size());
      for (const std::size_t sensor : sensors_at[tick]) {
        const core::LocalReport report = sources[sensor].sight(time, truth, random);
        for (std::size_t k = 0; k < nodes.size(); ++k) answers[k] = nodes[k].onReport(report);
        if (sensor == 0 && t > 1.0) scores.local.add(report.tracks[0].state, truth);
      }
      if (t <= 1.0) continue;
      for (std::size_t k = 0; k < nodes.size(); ++k) {
        const bool whole =
            answers[k].tracks.size() == 1 && answers[k].tracks[0].sources.size() == sources.size();
        if (!whole) ++scores.broken;
        if (!answers[k].tracks.empty()) scores.fused[k].add(answers[k].tracks[0].track.state, truth);
      }
    }
    for (FusionScore& fused : scores.fused) fused.endRun();
    scores.local.endRun();
  }
  return scores;
}

}  // namespace sightline::bench
