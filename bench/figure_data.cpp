// What the figures 3 to 6 of the paper show, in its own form and in the consistent one, as CSV on standard
// output; `bench/figures` draws it.
//
//   figure_data > figures.csv
//
// One line for each sighting and form (figure 5: for each report of a local and of the fused track): the
// figure, the form, the series, time [s], and for each channel truth, sighting, prediction with the half
// width of its gate, estimate with its stated standard deviation [rad]. What there is not stays empty.

#include <cmath>
#include <cstdio>
#include <deque>
#include <functional>
#include <memory>
#include <string>

#include "sightline/core/estimators/estimators.h"
#include "sightline/core/fusion/track_fusion.h"
#include "sightline/core/tracking/local_tracker.h"
#include "sightline/core/tracking/tracklet_builder.h"

#include "scenarios.h"

namespace sightline::bench {
namespace {

using core::EstimatorForm;
using core::EstimatorKind;
using core::EstimatorParams;

constexpr double kGate = 3.0;        // sigmas, (S-3)
constexpr double kFlatScale = 1e-3;  // amplitude at which the sphere is flat [rad]
constexpr int kRun = 0;              // of the benchmark that is drawn

struct Point {
  double truth = std::nan(""), sighting = std::nan(""), prediction = std::nan(""), gate = std::nan("");
  double estimate = std::nan(""), deviation = std::nan("");
};

void printNumber(double value) {
  if (std::isnan(value)) {
    std::printf(",");
  } else {
    std::printf(",%.6g", value);
  }
}

void printLine(int figure, const char* form, const std::string& series, int tick, const Point (&points)[2]) {
  std::printf("%d,%s,%s,%.2f", figure, form, series.c_str(), 0.01 * tick);
  for (const Point& point : points) {
    for (const double value :
         {point.truth, point.sighting, point.prediction, point.gate, point.estimate, point.deviation})
      printNumber(value);
  }
  std::printf("\n");
}

/// Gate of (S-3), or of (5) where the estimator is the paper's TWBLS.
double gateOf(const core::Estimator& estimator, const core::AngularState& expected,
              const core::Measurement& measurement, double h, int channel) {
  const double sigma = std::sqrt(measurement.covariance(channel, channel));
  if (const auto* twbls = dynamic_cast<const core::TwblsEstimator*>(&estimator)) {
    if (const auto& fit = twbls->fit(channel); fit && !std::isnan(fit->E(0)))
      return core::paperGateHalfWidth(*fit, h, sigma);
  }
  return kGate * std::sqrt(expected.covariance(channel, channel) + sigma * sigma);
}

/// The state at a sighting; of the paper's TWBLS the fit and its error (9C), which its anchor (5) leaves out.
void fillEstimate(const core::Estimator& estimator, core::Time time, int channel, Point& point) {
  const auto state = estimator.stateAt(time);
  point.estimate = state->mean(channel);
  point.deviation = std::sqrt(state->covariance(channel, channel));
  const auto* twbls = dynamic_cast<const core::TwblsEstimator*>(&estimator);
  if (twbls == nullptr) return;
  if (const auto& fit = twbls->fit(channel); fit && !std::isnan(fit->E(1))) {
    point.estimate = fit->C(1);
    point.deviation = fit->E(1);
  }
}

/// One tracker that takes every sighting: figures 3, 4 and 6.
void printTracker(int figure, const char* form, const Stream& stream, const EstimatorParams& params) {
  const auto estimator = core::makeEstimator(params);
  int last_tick = 0;
  for (const Instant& instant : stream) {
    Point points[2];
    const core::Measurement& measurement = instant.measurement;
    const auto expected = estimator->stateAt(measurement.time);
    for (int channel = 0; channel < 2; ++channel) {
      points[channel].truth = instant.truth(channel);
      points[channel].sighting = measurement.position(channel);
      if (!expected) continue;
      points[channel].prediction = expected->mean(channel);
      points[channel].gate =
          gateOf(*estimator, *expected, measurement, 0.01 * (instant.tick - last_tick), channel);
    }
    estimator->update(measurement);
    last_tick = instant.tick;
    for (int channel = 0; channel < 2; ++channel)
      fillEstimate(*estimator, measurement.time, channel, points[channel]);
    printLine(figure, form, "sensor " + std::to_string(instant.sensor + 1), instant.tick, points);
  }
}

void printState(const char* form, const std::string& series, const Instant& instant,
                const core::AngularState& state) {
  Point points[2];
  for (int channel = 0; channel < 2; ++channel) {
    points[channel].truth = instant.truth(channel) / kFlatScale;
    points[channel].estimate = state.mean(channel) / kFlatScale;
    points[channel].deviation = std::sqrt(state.covariance(channel, channel)) / kFlatScale;
  }
  printLine(5, form, series, instant.tick, points);
}

/// Six local trackers and the fusion of their tracks: figure 5.
void printFusion(const char* form, const EstimatorParams& estimator, const core::TrackFusionParams& fusion) {
  core::LocalTrackerParams params;
  params.estimator = estimator;
  std::deque<core::LocalTracker> locals;
  std::deque<core::TrackletBuilder> builders;
  core::TrackFusion node(fusion);
  Sensors sensors = sixSensors();
  sensors.scale = kFlatScale;
  sensors.synchronous = true;
  for (std::size_t k = 0; k < sensors.sigmas.size(); ++k) {
    locals.emplace_back(params);
    builders.emplace_back(core::TrackletParams{});
  }
  const Stream stream = simulate(scenarioOf("sin"), sensors, kRun);
  for (std::size_t i = 0; i < stream.size(); ++i) {
    const Instant& instant = stream[i];
    core::Scan scan;
    scan.time = instant.measurement.time;
    scan.sensor = "sensor " + std::to_string(instant.sensor + 1);
    scan.sightings = {core::sightingOf(instant.measurement.position, instant.measurement.covariance)};
    const auto sensor = static_cast<std::size_t>(instant.sensor);
    const core::ScanReport report = locals[sensor].onScan(scan);
    if (auto tracklets = builders[sensor].onScan(scan, report)) {
      tracklets->tracker = "tracker of " + scan.sensor;
      node.onTracklets(*tracklets);
    }
    const core::FusionReport fused = node.onReport({"tracker of " + scan.sensor, report.time, report.tracks});
    if (!report.tracks.empty()) printState(form, scan.sensor, instant, report.tracks.front().state);
    const bool all_reported = i + 1 == stream.size() || stream[i + 1].tick != instant.tick;
    if (all_reported && !fused.tracks.empty())
      printState(form, "fused", instant, fused.tracks.front().track.state);
  }
}

void printAll() {
  std::printf("figure,form,series,time");
  for (const char* channel : {"azimuth", "elevation"}) {
    for (const char* what : {"truth", "sighting", "prediction", "gate", "estimate", "deviation"})
      std::printf(",%s_%s", channel, what);
  }
  std::printf("\n");

  EstimatorParams twbls, twbls_paper, noga, noga_paper;
  twbls.kind = twbls_paper.kind = EstimatorKind::twbls;
  twbls_paper.twbls_form = EstimatorForm::paper;
  twbls_paper.twbls.anchor = core::TwblsAnchor::raw;
  twbls_paper.twbls.covariance = core::TwblsCovariance::fit_error;
  noga.kind = noga_paper.kind = EstimatorKind::noga;
  noga_paper.noga_form = EstimatorForm::paper;
  noga_paper.noga.covariance = core::NogaCovariance::printed;

  const Stream one = simulate(scenarioOf("sin"), {{0.08}}, kRun);
  const Stream six = simulate(scenarioOf("sin"), sixSensors(), kRun);
  EstimatorParams twenty = twbls_paper;
  twenty.twbls.max_sightings = 20;
  printTracker(3, "paper", one, twenty);
  printTracker(3, "consistent", one, twbls);
  printTracker(4, "paper", six, twbls_paper);
  printTracker(4, "consistent", six, twbls);
  core::TrackFusionParams weighted, best;
  best.tracklets.estimator = twbls;
  weighted.rule = core::FusionRule::weighted_covariance;
  EstimatorParams local_paper = twenty;
  local_paper.twbls.anchor = core::TwblsAnchor::fit;
  printFusion("paper", local_paper, weighted);
  printFusion("consistent", twbls, best);
  printTracker(6, "paper", one, noga_paper);
  printTracker(6, "consistent", one, noga);
}

}  // namespace
}  // namespace sightline::bench

int main() {
  sightline::bench::printAll();
  return 0;
}
