// How often a fused track is nearer to the truth than the best local one (the paper: about 65 %), against
// what an optimal fuser reaches (S-10), and whether it is better in every run (reference: E5).
//
// Synchronous sensors, each with a local tracker that reports after every third exposure (90 ms on average),
// whose tracks are fused then; and the central tracker that is shown every sighting. Amplitude 1 mrad, where
// the sphere is flat. The share counts every report after 1 s and each channel for itself. It is never tuned
// on: a tiny step from the best track towards the fused one inflates it.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Cholesky>

#include "sightline/core/evaluation/metrics.h"
#include "sightline/core/fusion/track_fusion.h"
#include "sightline/core/tracking/local_tracker.h"
#include "sightline/core/tracking/tracklet_builder.h"

#include "monte_carlo.h"
#include "parallel.h"
#include "tables.h"

namespace sightline::bench {
namespace {

constexpr double kAmplitude = 1e-3;  // [rad]
constexpr int kFirstTick = 100;      // figures count after it: 1 s
constexpr int kReportEvery = 3;      // exposures

struct Fuser {
  std::string name;
  core::TrackFusionParams params;
  bool is_default = false;
};

std::vector<Fuser> fusers() {
  std::vector<Fuser> all;
  const auto add = [&](const char* name, core::FusionRule rule) {
    core::TrackFusionParams params;
    params.rule = rule;
    all.push_back({name, params, rule == core::TrackFusionParams{}.rule});
    if (all.back().is_default) all.back().name += " (default)";
  };
  add("best rule: tracklets", core::FusionRule::best);
  add("weighted covariance", core::FusionRule::weighted_covariance);
  add("cross-covariance", core::FusionRule::cross_covariance);
  return all;
}

/// Figures of one track (fused, central, or the best local one) in one run.
struct RunFigures {
  double squares = 0.0, nees_position = 0.0, nees_state = 0.0, beats = 0.0;
  int count = 0;

  void add(const core::AngularState& state, const Eigen::Vector4d& truth, const Eigen::Vector2d& best_error) {
    const Eigen::Vector4d error = state.mean - truth;
    const Eigen::Vector2d position = error.head<2>();
    squares += position.squaredNorm() / 2.0;
    nees_position += position.dot(state.anglesCovariance().llt().solve(position)) / 2.0;
    nees_state += error.dot(state.covariance.llt().solve(error)) / 4.0;
    for (int channel = 0; channel < 2; ++channel)
      beats += 0.5 * (std::abs(position(channel)) < std::abs(best_error(channel)));
    ++count;
  }
  void finish() {
    for (double* sum : {&squares, &nees_position, &nees_state, &beats}) *sum /= std::max(count, 1);
  }
};

struct Experiment {
  const char* scenario;
  const char* sensors_name;
  std::vector<double> sigmas;  // the first is the best
  const char* estimator_name;
  core::EstimatorParams estimator;
};

core::Scan scanOf(const Instant& instant) {
  core::Scan scan;
  scan.time = instant.measurement.time + std::chrono::seconds(1);
  scan.sensor = "sensor_" + std::to_string(instant.sensor);
  scan.sightings = {core::sightingOf(instant.measurement.position, instant.measurement.covariance)};
  return scan;
}

/// Figures of the best local track, the central tracker, then the fusers.
std::vector<RunFigures> follow(const Experiment& experiment, const std::vector<Fuser>& rules, int run) {
  core::LocalTrackerParams params;
  params.estimator = experiment.estimator;
  std::deque<core::LocalTracker> locals;
  for (std::size_t k = 0; k < experiment.sigmas.size(); ++k) locals.emplace_back(params);
  core::LocalTracker central(params);
  std::deque<core::TrackletBuilder> builders;
  for (std::size_t k = 0; k < experiment.sigmas.size(); ++k) builders.emplace_back(core::TrackletParams{});
  std::deque<core::TrackFusion> nodes;
  for (const Fuser& rule : rules) {
    core::TrackFusionParams fusion = rule.params;
    fusion.tracklets.estimator = experiment.estimator;
    nodes.emplace_back(fusion);
  }

  std::vector<RunFigures> figures(2 + rules.size());
  const Sensors sensors{experiment.sigmas, kAmplitude, true};
  const Stream stream = simulate(scenarioOf(experiment.scenario), sensors, run);
  int exposure = 0;
  for (std::size_t i = 0; i < stream.size(); ++exposure) {
    const Eigen::Vector4d truth = stream[i].truth;
    const int tick = stream[i].tick;
    std::optional<core::AngularState> best, all;
    std::vector<core::FusionReport> answers(nodes.size());
    for (; i < stream.size() && stream[i].tick == tick; ++i) {
      const core::Scan scan = scanOf(stream[i]);
      const auto sensor = static_cast<std::size_t>(stream[i].sensor);
      const core::ScanReport local = locals[sensor].onScan(scan);
      if (auto tracklets = builders[sensor].onScan(scan, local)) {
        tracklets->tracker = "tracker_of_" + scan.sensor;
        for (std::size_t k = 0; k < nodes.size(); ++k)
          if (rules[k].params.rule == core::FusionRule::best) nodes[k].onTracklets(*tracklets);
      }
      if (stream[i].sensor == 0 && !local.tracks.empty()) best = local.tracks.front().state;
      const core::ScanReport together = central.onScan(scan);
      if (!together.tracks.empty()) all = together.tracks.front().state;
      for (std::size_t k = 0; k < nodes.size() && exposure % kReportEvery == 0; ++k)
        answers[k] = nodes[k].onReport({"tracker_of_" + scan.sensor, local.time, local.tracks});
    }
    if (tick <= kFirstTick || !best || exposure % kReportEvery != 0) continue;
    const Eigen::Vector2d best_error = best->angles() - truth.head<2>();
    figures[0].add(*best, truth, best_error);
    if (all) figures[1].add(*all, truth, best_error);
    for (std::size_t k = 0; k < nodes.size(); ++k)
      if (!answers[k].tracks.empty())
        figures[2 + k].add(answers[k].tracks.front().track.state, truth, best_error);
  }
  for (RunFigures& figure : figures) figure.finish();
  return figures;
}

Sample sampleOf(const std::vector<std::vector<RunFigures>>& runs, std::size_t k, double RunFigures::*figure) {
  std::vector<double> values;
  for (const auto& run : runs) values.push_back(run[k].*figure);
  return Sample(std::move(values));
}

void printExperiment(const Experiment& experiment, const Options& options) {
  const std::vector<Fuser> rules = fusers();
  std::vector<std::vector<RunFigures>> runs(static_cast<std::size_t>(options.runs));
  forEachRun(options.runs, options.threads,
             [&](int run) { runs[static_cast<std::size_t>(run)] = follow(experiment, rules, run); });

  std::printf(
      "\n%s, %s, %s\n%-32s| RMSE / 0.08   | / central| beats best      | S-10   | runs better | ANEES "
      "pos;state\n",
      experiment.scenario, experiment.sensors_name, experiment.estimator_name, "");
  const Sample best = sampleOf(runs, 0, &RunFigures::squares),
               central = sampleOf(runs, 1, &RunFigures::squares);
  const std::optional<double> optimal = core::beatsTheory(central.mean() / best.mean());
  for (std::size_t k = 0; k < rules.size() + 2; ++k) {
    const Sample squares = sampleOf(runs, k, &RunFigures::squares);
    const Sample beats = sampleOf(runs, k, &RunFigures::beats);
    const std::string name = k == 0 ? "best local" : k == 1 ? "central" : rules[k - 2].name;
    const double unit = kAmplitude * 0.08;
    std::printf("%-32s|%6.3f +-%5.3f |%7.3f   ", name.c_str(), squares.root() / unit,
                squares.rootBand() / unit, rootRatio(squares, central).value);
    std::size_t better = 0;
    for (std::size_t run = 0; run < runs.size(); ++run) better += squares.values()[run] < best.values()[run];
    const auto theory = core::beatsTheory(squares.mean() / best.mean());
    if (k == 0) {
      std::printf("|%16s |%7s |%12s ", "", "", "");
    } else {
      std::printf("|%7.3f +-%5.3f  |%7.3f |%6zu /%4d ", beats.mean(), beats.band(),
                  theory.value_or(std::nan("")), better, options.runs);
    }
    std::printf("|%6.2f;%6.2f", sampleOf(runs, k, &RunFigures::nees_position).mean(),
                sampleOf(runs, k, &RunFigures::nees_state).mean());
    if (k >= 2 && rules[k - 2].is_default && optimal) {
      std::printf("  within 0.02 of the optimum's %.3f: %s", *optimal,
                  markOf(std::abs(beats.mean() - *optimal), 0.02, beats.band()));
      if (experiment.sigmas.size() > 2)
        std::printf("; better in every run: %s", better == runs.size() ? "met" : "MISSED");
    }
    std::printf("\n");
  }
}

}  // namespace

void printBeatsBest(const Options& options) {
  std::printf(
      "\n## Fused track against the best local one, %d runs; S-10: what an optimal fuser of this RMSE would "
      "have\n",
      options.runs);
  core::EstimatorParams noga, twbls, kalman;
  noga.kind = core::EstimatorKind::noga;
  twbls.kind = core::EstimatorKind::twbls;
  kalman.kind = core::EstimatorKind::kalman;
  kalman.kalman.process_noise = 0.3 * kAmplitude * kAmplitude;
  const std::vector<double> two{0.08, 0.08}, six{0.08, 0.08, 0.08, 0.15, 0.15, 0.15};
  for (const char* scenario : {"sin", "ncv0.3"}) {
    for (const bool pair : {true, false}) {
      const char* sensors = pair ? "two of 8 %" : "six (3 x 8 %, 3 x 15 %)";
      printExperiment({scenario, sensors, pair ? two : six, "NOGA", noga}, options);
      if (!options.quick) printExperiment({scenario, sensors, pair ? two : six, "TWBLS", twbls}, options);
      printExperiment({scenario, sensors, pair ? two : six, "Kalman q = 0.3", kalman}, options);
    }
  }
}

}  // namespace sightline::bench
