// The fused track of six local tracks that report every 300 ms, against the central tracker that is shown
// every sighting (reference: E5). Synchronous sensors, amplitude 1 mrad, where the sphere is flat; figures at
// the instants of the reports after 1 s, when both have seen the same.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Cholesky>

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
constexpr int kReportEvery = 30;     // ticks of 10 ms

/// A fusion node, and what it is sent.
struct Node {
  std::string name;
  core::FusionRule rule;
  core::IntersectionWeights weights;
  core::CompressionParams compression;  // of the tracklets, where the rule takes them
  double aim;                           // RMSE / that of the central tracker; 0 = none
};

std::vector<Node> nodes() {
  using core::FusionRule;
  const auto determinant = core::IntersectionWeights::determinant, trace = core::IntersectionWeights::trace;
  return {
      {"weighted covariance", FusionRule::weighted_covariance, determinant, {}, 0.0},
      {"cross-covariance", FusionRule::cross_covariance, determinant, {}, 0.0},
      {"covariance intersection, determinant", FusionRule::covariance_intersection, determinant, {}, 0.0},
      {"covariance intersection, trace", FusionRule::covariance_intersection, trace, {}, 0.0},
      {"inverse covariance intersection", FusionRule::inverse_covariance_intersection, determinant, {}, 0.0},
      {"every sighting", FusionRule::tracklets, determinant, {0.0, 1}, 1.01},
      {"centroid tracklets of 90 ms", FusionRule::tracklets, determinant, {0.09, 1}, 1.03},
      {"two nodes in 150 ms (default)", FusionRule::best, determinant, {}, 1.01},
      {"two nodes in 300 ms", FusionRule::tracklets, determinant, {0.3, 2}, 0.0}};
}

struct RunFigures {
  double squares = 0.0, nees_position = 0.0, nees_state = 0.0, tracklets = 0.0;
  int count = 0;

  void add(const core::AngularState& state, const Eigen::Vector4d& truth) {
    const Eigen::Vector4d error = state.mean - truth;
    const Eigen::Vector2d position = error.head<2>();
    squares += position.squaredNorm() / 2.0;
    nees_position += position.dot(state.anglesCovariance().llt().solve(position)) / 2.0;
    nees_state += error.dot(state.covariance.llt().solve(error)) / 4.0;
    ++count;
  }
  void finish() {
    for (double* sum : {&squares, &nees_position, &nees_state}) *sum /= count;
  }
};

struct Experiment {
  const char* scenario;
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

/// What a local tracker has taken and not reported yet, as the builder of a node's tracklets would hold it.
struct Local {
  core::LocalTracker tracker;
  std::string name;
  core::ScanReport last;
  std::vector<core::TrackTracklet> pending;  // sighting by sighting
  std::optional<core::Time> reported;
};

void sight(Local& local, core::TrackletBuilder& every_sighting, const core::Scan& scan) {
  local.last = local.tracker.onScan(scan);
  const auto report = every_sighting.onScan(scan, local.last);
  local.pending.insert(local.pending.end(), report->tracklets.begin(), report->tracklets.end());
}

core::TrackletReport trackletsOf(const Local& local, const core::CompressionParams& compression) {
  core::TrackletReport report{local.name, local.last.time, local.reported, {}};
  std::map<std::uint32_t, std::vector<core::Tracklet>> of_track;
  for (const core::TrackTracklet& it : local.pending) of_track[it.track].push_back(it.tracklet);
  for (const auto& [id, sightings] : of_track) {
    for (const core::Tracklet& tracklet : core::compress(sightings, compression))
      report.tracklets.push_back({id, tracklet});
  }
  return report;
}

/// Figures of the central tracker, the best local one, then the nodes.
std::vector<RunFigures> follow(const Experiment& experiment, int run) {
  core::LocalTrackerParams params;
  params.estimator = experiment.estimator;
  Sensors sensors = sixSensors();
  sensors.scale = kAmplitude;
  sensors.synchronous = true;
  const auto best = static_cast<std::size_t>(std::min_element(sensors.sigmas.begin(), sensors.sigmas.end()) -
                                             sensors.sigmas.begin());
  std::deque<Local> locals;
  std::deque<core::TrackletBuilder> builders;
  for (std::size_t k = 0; k < sensors.sigmas.size(); ++k) {
    locals.push_back({core::LocalTracker(params), "tracker_" + std::to_string(k), {}, {}, {}});
    builders.emplace_back(core::TrackletParams{});
  }
  core::LocalTracker central(params);
  core::ScanReport all;
  std::deque<core::TrackFusion> fusions;
  for (const Node& node : nodes()) {
    core::TrackFusionParams fusion;
    fusion.rule = node.rule;
    fusion.intersection_weights = node.weights;
    fusion.tracklets.estimator = experiment.estimator;
    fusions.emplace_back(fusion);
  }

  std::vector<RunFigures> figures(2 + fusions.size());
  const Stream stream = simulate(scenarioOf(experiment.scenario), sensors, run);
  int next_report = 0;
  for (std::size_t i = 0; i < stream.size();) {
    const int tick = stream[i].tick;
    const Eigen::Vector4d truth = stream[i].truth;
    for (; i < stream.size() && stream[i].tick == tick; ++i) {
      const auto k = static_cast<std::size_t>(stream[i].sensor);
      const core::Scan scan = scanOf(stream[i]);
      sight(locals[k], builders[k], scan);
      all = central.onScan(scan);
    }
    if (tick < next_report) continue;
    next_report = tick + kReportEvery;
    std::vector<core::FusionReport> answers(fusions.size());
    for (std::size_t n = 0; n < fusions.size(); ++n) {
      const Node node = nodes()[n];
      for (const Local& local : locals) {
        const bool takes = node.rule == core::FusionRule::tracklets || node.rule == core::FusionRule::best;
        if (takes) fusions[n].onTracklets(trackletsOf(local, node.compression));
        for (const core::TrackTracklet& it : trackletsOf(local, node.compression).tracklets)
          figures[2 + n].tracklets += takes && it.track > 0 ? 1.0 : 0.0;
        answers[n] = fusions[n].onReport({local.name, local.last.time, local.last.tracks});
      }
    }
    for (Local& local : locals) {
      local.pending.clear();
      local.reported = local.last.time;
    }
    if (tick <= kFirstTick || all.tracks.empty() || locals[best].last.tracks.empty()) continue;
    figures[0].add(all.tracks.front().state, truth);
    figures[1].add(locals[best].last.tracks.front().state, truth);
    for (std::size_t n = 0; n < fusions.size(); ++n) {
      if (!answers[n].tracks.empty()) figures[2 + n].add(answers[n].tracks.front().track.state, truth);
    }
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
  std::vector<std::vector<RunFigures>> runs(static_cast<std::size_t>(options.runs));
  forEachRun(options.runs, options.threads,
             [&](int run) { runs[static_cast<std::size_t>(run)] = follow(experiment, run); });
  std::printf("\n%s, %s\n%-38s| RMSE / 0.08   | / central         | ANEES pos        ; state | sent\n",
              experiment.scenario, experiment.estimator_name, "");
  const Sample central = sampleOf(runs, 0, &RunFigures::squares);
  const double unit = kAmplitude * 0.08, sightings = sampleOf(runs, 7, &RunFigures::tracklets).mean();
  for (std::size_t k = 0; k < nodes().size() + 2; ++k) {
    const std::string name = k == 0 ? "central" : k == 1 ? "best local" : nodes()[k - 2].name;
    const Sample squares = sampleOf(runs, k, &RunFigures::squares);
    const Sample nees = sampleOf(runs, k, &RunFigures::nees_position);
    const Ratio ratio = rootRatio(squares, central);
    std::printf("%-38s|%6.3f +-%5.3f |%7.3f +-%5.3f   |%6.2f +-%5.2f   ;%6.2f", name.c_str(),
                squares.root() / unit, squares.rootBand() / unit, ratio.value, ratio.value * ratio.log_band,
                nees.mean(), nees.band(), sampleOf(runs, k, &RunFigures::nees_state).mean());
    const double sent = sampleOf(runs, k, &RunFigures::tracklets).mean();
    if (sent > 0.0) std::printf(" | %3.0f %%", 100.0 * sent / sightings);
    const double aim = k < 2 ? 0.0 : nodes()[k - 2].aim;
    if (aim > 0.0) {
      std::printf("  aim <= %.2f %s, ANEES in [0.9, 1.1] %s", aim,
                  markOf(ratio.value, aim, ratio.value * ratio.log_band),
                  markOf(nees.mean(), 0.9, 1.1, nees.band()));
    }
    std::printf("\n");
  }
}

}  // namespace

void printTrackFusion(const Options& options) {
  std::printf(
      "\n## Fused track of six local tracks, reports every 300 ms, against the central tracker, %d runs; "
      "sent: tracklets for 100 sightings\n",
      options.runs);
  core::EstimatorParams noga, twbls, kalman;
  noga.kind = core::EstimatorKind::noga;
  twbls.kind = core::EstimatorKind::twbls;
  kalman.kind = core::EstimatorKind::kalman;
  kalman.kalman.process_noise = 0.3 * kAmplitude * kAmplitude;
  for (const char* scenario : {"sin", "weave", "ncv0.3"}) {
    printExperiment({scenario, "Kalman q = 0.3", kalman}, options);
    printExperiment({scenario, "NOGA", noga}, options);
  }
  if (!options.quick) printExperiment({"sin", "TWBLS", twbls}, options);
}

}  // namespace sightline::bench
