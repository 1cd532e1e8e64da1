// One of six sensors degrades unannounced (reference: E6), through the local tracker with its defaults.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "sightline/core/tracking/local_tracker.h"

#include "monte_carlo.h"
#include "parallel.h"
#include "quantiles.h"
#include "tables.h"

namespace sightline::bench {
namespace {

constexpr double kAmplitude = 1e-2;  // [rad]: the sphere is flat
constexpr double kBestSigma = 0.08;  // of amplitude
constexpr int kStart = 200;          // tick at which tracking starts
constexpr int kChange = 500;         // tick from which the sensor is degraded
constexpr int kDegraded = 3;         // the first tracking sensor
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// What becomes of a sensor.
struct Degradation {
  const char* name;
  double noise = 1.0;         // factor on its sigma
  double bias = 0.0;          // in azimuth [its sigma]
  double drift = 0.0;         // in azimuth [amplitude/s]
  bool is_exemplary = false;  // one of those that stand for the rest
  bool all_tracking = false;  // the same of all three tracking sensors
  double aim = kNone;         // of the ratio to the tracker that knows

  bool hits(int sensor) const { return all_tracking ? sensor >= 3 : sensor == kDegraded; }
  bool isNoise() const { return noise != 1.0; }
  bool isClean() const { return !isNoise() && bias == 0.0 && drift == 0.0; }
};

const Degradation kCases[] = {{"clean", 1.0, 0.0, 0.0, true},
                              {"noise x2", 2.0, 0.0, 0.0, false, false, 1.02},
                              {"noise x4", 4.0, 0.0, 0.0, true, false, 1.02},
                              {"noise x8", 8.0, 0.0, 0.0, false, false, 1.02},
                              {"noise x20", 20.0, 0.0, 0.0, false, false, 1.02},
                              {"bias 1 sigma", 1.0, 1.0},
                              {"bias 2 sigma", 1.0, 2.0, 0.0, true, false, 1.10},
                              {"bias 4 sigma", 1.0, 4.0, 0.0, false, false, 1.10},
                              {"drift 0.16/s", 1.0, 0.0, 0.16},
                              {"noise x4 on 3", 4.0, 0.0, 0.0, false, true, 1.02}};

/// How a tracker is told of the degradation, or guards against it.
enum class Knowledge { naive, guarded, told, without };

/// A run as the tracker gets it.
std::vector<core::Scan> scansOf(const Stream& stream, const Degradation& degradation, Knowledge knowledge) {
  std::vector<core::Scan> scans;
  for (const Instant& instant : stream) {
    if (instant.tick < kStart) continue;
    const bool is_hit = degradation.hits(instant.sensor);
    const bool is_degraded = is_hit && instant.tick >= kChange;
    const bool is_left_out =
        knowledge == Knowledge::without
            ? is_hit
            : knowledge == Knowledge::told && is_degraded && !degradation.isNoise() && !degradation.isClean();
    core::Scan scan;
    scan.time = core::Time(std::chrono::seconds(1000)) + (instant.measurement.time - core::Time{});
    scan.sensor = "sensor_" + std::to_string(instant.sensor);
    Eigen::Vector2d angles = instant.measurement.position;
    Eigen::Matrix2d covariance = instant.measurement.covariance;
    if (is_degraded) {
      const Eigen::Vector2d truth = instant.truth.head<2>();
      angles = truth + degradation.noise * (angles - truth);
      angles.x() += degradation.bias * std::sqrt(covariance(0, 0)) +
                    degradation.drift * kAmplitude * 0.01 * (instant.tick - kChange);
      if (knowledge == Knowledge::told) covariance *= degradation.noise * degradation.noise;
    }
    // A sensor that is left out is marked by an empty name: its instants still count in the errors.
    if (is_left_out) scan.sensor.clear();
    scan.sightings = {core::sightingOf(angles, covariance)};
    scans.push_back(std::move(scan));
  }
  return scans;
}

struct RunFigures {
  double squares = kNone;  // mean squared error from the change on, in the best sigma
  double ghosts = 0.0;     // share of the instants with another established track
  double lost = 0.0;       // share of the instants without an established track
  double delay = kNone;    // of the detection [s]
  int false_alarms = 0;
};

core::LocalTrackerParams paramsOf(core::EstimatorKind kind, bool guarded) {
  core::LocalTrackerParams params;
  params.estimator.kind = kind;
  params.guard.enabled = guarded;
  return params;
}

void countChanges(const core::ScanReport& report, const Degradation& degradation, RunFigures& figures) {
  const core::Time change = core::Time(std::chrono::seconds(1000) + std::chrono::milliseconds(10 * kChange));
  for (const core::SensorChange& noticed : report.changes) {
    if (noticed.change.verdict == core::SensorVerdict::healthy) continue;
    const bool is_hit = !degradation.isClean() && degradation.hits(noticed.sensor.back() - '0');
    if (!is_hit || noticed.change.time < change) {
      ++figures.false_alarms;
    } else if (std::isnan(figures.delay)) {
      figures.delay = core::seconds(noticed.change.time - change);
    }
  }
}

RunFigures follow(const Stream& stream, const Degradation& degradation, Knowledge knowledge,
                  core::EstimatorKind kind) {
  core::LocalTracker tracker(paramsOf(kind, knowledge == Knowledge::guarded));
  const std::vector<core::Scan> scans = scansOf(stream, degradation, knowledge);
  const std::size_t first = stream.size() - scans.size();
  RunFigures figures;
  double squares = 0.0;
  int counted = 0, instants = 0;
  core::ScanReport report;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    const Instant& instant = stream[first + k];
    if (!scans[k].sensor.empty()) {
      report = tracker.onScan(scans[k]);
      countChanges(report, degradation, figures);
    }
    if (instant.tick <= kChange || report.time != scans[k].time) continue;
    ++instants;
    const core::Track* oldest = nullptr;
    for (const core::Track& track : report.tracks) {
      if (track.status == core::TrackStatus::tentative) continue;
      if (oldest == nullptr) {
        oldest = &track;
      } else {
        figures.ghosts += 1.0;
        break;
      }
    }
    if (oldest == nullptr) {
      figures.lost += 1.0;
      continue;
    }
    const Eigen::Vector2d error = core::angleDifference(oldest->state.angles(), instant.truth.head<2>());
    squares += error.squaredNorm() / (2.0 * std::pow(kBestSigma * kAmplitude, 2));
    ++counted;
  }
  figures.squares = counted > 0 ? squares / counted : kNone;
  figures.ghosts /= instants;
  figures.lost /= instants;
  return figures;
}

std::vector<RunFigures> runsOf(const char* scenario, const Degradation& degradation, Knowledge knowledge,
                               core::EstimatorKind kind, const Options& options, int runs) {
  Sensors sensors = sixSensors();
  sensors.scale = kAmplitude;
  std::vector<RunFigures> figures(static_cast<std::size_t>(runs));
  forEachRun(runs, options.threads, [&](int run) {
    figures[static_cast<std::size_t>(run)] =
        follow(simulate(scenarioOf(scenario), sensors, run), degradation, knowledge, kind);
  });
  return figures;
}

Sample sampleOf(const std::vector<RunFigures>& runs) {
  std::vector<double> values;
  for (const RunFigures& run : runs) values.push_back(run.squares);
  return Sample(values);
}

double meanOf(const std::vector<RunFigures>& runs, double RunFigures::*field) {
  double sum = 0.0;
  for (const RunFigures& run : runs) sum += run.*field;
  return sum / static_cast<double>(runs.size());
}

/// `without`: error without the sensor, whatever it does.
void printCase(const Degradation& degradation, core::EstimatorKind kind, double without,
               const Options& options) {
  const auto run = [&](Knowledge knowledge) {
    return runsOf("sin", degradation, knowledge, kind, options, options.runs);
  };
  const auto naive = run(Knowledge::naive), guarded = run(Knowledge::guarded);
  const auto told = degradation.isClean() ? naive : run(Knowledge::told);
  const Ratio ratio = rootRatio(sampleOf(guarded), sampleOf(told));
  std::vector<double> delays;
  int false_alarms = 0;
  for (const RunFigures& figures : guarded) {
    if (!std::isnan(figures.delay)) delays.push_back(1e3 * figures.delay);
    false_alarms += figures.false_alarms;
  }
  const int healthy = degradation.isClean() ? 6 : degradation.all_tracking ? 3 : 5;
  const double hours = healthy * options.runs * 0.01 * (kTicks - kStart) / 3600.0;
  std::printf(
      "%-14s|%6.3f |%6.3f |%6.3f |%6.3f |%6.3f +-%5.3f |%5.0f /%5.0f |%5.1f %% |%3d in %4.1f h |%5.1f;%4.1f "
      "|",
      degradation.name, sampleOf(naive).root(), sampleOf(guarded).root(), sampleOf(told).root(), without,
      ratio.value, ratio.value * ratio.log_band, quantile(delays, 0.5), quantile(delays, 0.95),
      100.0 * static_cast<double>(delays.size()) / options.runs, false_alarms, hours,
      100.0 * meanOf(guarded, &RunFigures::ghosts), 100.0 * meanOf(guarded, &RunFigures::lost));
  if (!std::isnan(degradation.aim))
    std::printf(" <= %.2f %s", degradation.aim,
                markOf(ratio.value, degradation.aim, ratio.value * ratio.log_band));
  if (degradation.noise == 4.0 && !degradation.all_tracking) {
    std::printf("; delay <= 100 / 200 %s / %s", markOf(quantile(delays, 0.5), 100.0, 0.0),
                markOf(quantile(delays, 0.95), 200.0, 0.0));
  }
  if (degradation.isClean()) {
    const Ratio cost = rootRatio(sampleOf(guarded), sampleOf(naive));
    std::printf(" guard / naive %.4f +- %.4f, < 1.005 %s", cost.value, cost.log_band,
                markOf(cost.value, 1.005, cost.log_band));
  }
  std::printf("\n");
  std::fflush(stdout);
}

/// Ten sensor-hours and more of sensors that are what they say.
void printFalseAlarms(core::EstimatorKind kind, const Options& options) {
  const char* const scenarios[] = {"sin", "weave", "line", "ncv0.3"};
  const int runs = options.quick ? 20 : 200;
  int all = 0;
  double hours = 0.0;
  std::printf("false alarms of healthy sensors:");
  for (const char* scenario : scenarios) {
    int alarms = 0;
    for (const RunFigures& run : runsOf(scenario, kCases[0], Knowledge::guarded, kind, options, runs))
      alarms += run.false_alarms;
    hours += 6.0 * runs * 0.01 * (kTicks - kStart) / 3600.0;
    all += alarms;
    std::printf(" %s %d,", scenario, alarms);
  }
  std::printf(" in %.1f sensor-hours: %.2f an hour, aim <= 0.5 %s\n", hours, all / hours,
              markOf(all / hours, 0.5, 2.0 * std::sqrt(std::max(1, all)) / hours));
}

}  // namespace

void printDegraded(const Options& options) {
  struct Kind {
    const char* name;
    core::EstimatorKind kind;
    bool all_cases;
  };
  for (const Kind& entry :
       {Kind{"noga", core::EstimatorKind::noga, true}, Kind{"twbls", core::EstimatorKind::twbls, false}}) {
    std::printf("\n## One of six sensors (a tracking sensor) degrades unannounced at 5 s, %s, sin, %d runs\n",
                entry.name, options.runs);
    std::printf("RMSE / 0.08 from then on; told = knows R, or leaves the biased one out\n");
    std::printf("%-14s|%6s |%6s |%6s |%6s |%14s |%12s |%7s |%11s |%10s | aim\n", "", "naive", "guard", "told",
                "w/out", "guard / told", "delay/95% ms", "found", "false", "ghost;lost%");
    const auto withoutBy = [&](const Degradation& degradation) {
      return sampleOf(runsOf("sin", degradation, Knowledge::without, entry.kind, options, options.runs))
          .root();
    };
    const double without_one = withoutBy(kCases[0]);
    for (const Degradation& degradation : kCases) {
      if (!entry.all_cases && !degradation.is_exemplary) continue;
      const double without = degradation.all_tracking ? withoutBy(degradation) : without_one;
      printCase(degradation, entry.kind, without, options);
    }
    printFalseAlarms(entry.kind, options);
  }
}

}  // namespace sightline::bench
