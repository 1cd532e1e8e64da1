// The smoother against the filter on the scenarios of `accuracy`: errors, honesty, processor time.
//
//   smoothing [--runs N] [--threads N]
//
// NOGA with its default settings, one sensor, no tracker. Lags are tried on the first scenario alone. Figures
// come from fixed seeds and do not depend on the number of threads, but for the times, which are of one
// thread. +- is the 95 % band over runs.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Cholesky>

#include "sightline/core/estimators/estimators.h"
#include "sightline/core/smoothing/bank_smoother.h"

#include "monte_carlo.h"
#include "number_option.h"
#include "parallel.h"
#include "processor_time.h"
#include "scenarios.h"

namespace sightline::bench {
namespace {

constexpr int kFirstTick = 100;  // figures count after it: 1 s
constexpr double kHalfSecond = 0.5, kOneSecond = 1.0;

struct Settings {
  int runs = 100;
  int threads = 2;
};

/// What came of one run, by the filter and by smoothers.
struct Method {
  const char* name;
  bool is_filter;
  std::optional<double> lag;  // [s]
};
constexpr std::size_t kMethods = 4, kWithoutLag = 2;
const Method kAll[kMethods] = {{"filter", true, {}},
                               {"smoother", false, {}},
                               {"lag 1.0 s", false, kOneSecond},
                               {"lag 0.5 s", false, kHalfSecond}};

struct RunFigures {
  double square = 0.0, nees_position = 0.0, nees_state = 0.0;  // means; the first in rad^2
  double gap_square = 0.0, gap_nees = 0.0;
  double time = 0.0;  // of the processor, for one sighting [s]
};

/// Instants with the states that a method gives there.
using States = std::vector<std::optional<core::AngularState>>;

States filtered(const Stream& stream) {
  const auto estimator = core::makeEstimator({});
  States states;
  for (const Instant& instant : stream) {
    estimator->stateAt(instant.measurement.time);  // as a tracker would, to associate
    if (instant.seen) estimator->update(instant.measurement);
    states.push_back(estimator->stateAt(instant.measurement.time));
  }
  return states;
}

States smoothed(const Stream& stream, std::optional<double> lag) {
  std::vector<core::ChartedMeasurement> sightings;
  std::vector<core::Time> times;
  for (const Instant& instant : stream) {
    times.push_back(instant.measurement.time);
    if (instant.seen) sightings.push_back({instant.measurement, std::nullopt});
  }
  const core::BankSmoother smoother{core::NogaConsistentParams()};
  States states;
  for (const auto& motion : smoother.smooth(sightings, times, lag))
    states.push_back(motion ? std::make_optional(motion->state) : std::nullopt);
  return states;
}

RunFigures figuresOf(const Stream& stream, const Method& method) {
  const double start = processorTime();
  const States states = method.is_filter ? filtered(stream) : smoothed(stream, method.lag);
  RunFigures figures;
  figures.time = (processorTime() - start) / static_cast<double>(stream.size());
  int counted = 0, hidden = 0;
  for (std::size_t i = 0; i < stream.size(); ++i) {
    if (stream[i].tick <= kFirstTick || !states[i]) continue;
    const Eigen::Vector4d error = states[i]->mean - stream[i].truth;
    const Eigen::Vector2d position = error.head<2>();
    const double square = position.squaredNorm() / 2.0;
    const double nees = position.dot(states[i]->anglesCovariance().llt().solve(position)) / 2.0;
    figures.square += square;
    figures.nees_position += nees;
    figures.nees_state += error.dot(states[i]->covariance.llt().solve(error)) / 4.0;
    ++counted;
    if (stream[i].seen) continue;
    figures.gap_square += square;
    figures.gap_nees += nees;
    ++hidden;
  }
  for (double* sum : {&figures.square, &figures.nees_position, &figures.nees_state}) *sum /= counted;
  for (double* sum : {&figures.gap_square, &figures.gap_nees}) *sum /= std::max(hidden, 1);
  return figures;
}

Sample sampleOf(const std::vector<RunFigures>& runs, double RunFigures::*figure) {
  std::vector<double> values;
  for (const RunFigures& run : runs) values.push_back(run.*figure);
  return Sample(std::move(values));
}

const char* mark(bool is_met) {
  return is_met ? "met" : "MISSED";
}

/// Prints a scenario's lines; the smoother's rms over the filter's.
Ratio printScenario(const Scenario& scenario, double sigma, const Settings& settings, std::size_t methods,
                    double* time) {
  std::vector<std::vector<RunFigures>> figures(
      methods, std::vector<RunFigures>(static_cast<std::size_t>(settings.runs)));
  forEachRun(settings.runs, settings.threads, [&](int run) {
    const Stream stream = simulate(scenario, {{sigma}, 1.0}, run);
    for (std::size_t k = 0; k < methods; ++k)
      figures[k][static_cast<std::size_t>(run)] = figuresOf(stream, kAll[k]);
  });
  const Sample filter = sampleOf(figures[0], &RunFigures::square);
  Ratio smoother;
  for (std::size_t k = 0; k < methods; ++k) {
    const Sample square = sampleOf(figures[k], &RunFigures::square);
    const Ratio ratio = rootRatio(square, filter);
    const double nees = sampleOf(figures[k], &RunFigures::nees_position).mean();
    std::printf("| %-9s | %-9s | %.3f +-%.3f | %.3f +-%.3f | %.2f; %.2f |", scenario.name.c_str(),
                kAll[k].name, square.root() / sigma, square.rootBand() / sigma, ratio.value,
                ratio.value * ratio.log_band, nees, sampleOf(figures[k], &RunFigures::nees_state).mean());
    if (scenario.dropout_to > 0.0) {
      const Sample gap = sampleOf(figures[k], &RunFigures::gap_square);
      std::printf(" %.3f +-%.3f, ANEES %.2f", gap.root() / sigma, gap.rootBand() / sigma,
                  sampleOf(figures[k], &RunFigures::gap_nees).mean());
      if (k == 1 && sigma < 0.1) std::printf(", aim <= 0.5 %s", mark(gap.root() / sigma <= 0.5));
    }
    if (k == 1) std::printf(" ANEES aim 0.8 to 1.2 %s", mark(nees >= 0.8 && nees <= 1.2));
    if (k == 1) smoother = ratio;
    std::printf("\n");
    time[k] += sampleOf(figures[k], &RunFigures::time).mean();
  }
  std::fflush(stdout);
  return smoother;
}

void printScenarios(const std::vector<Scenario>& scenarios, const char* title, const Settings& settings) {
  for (const double sigma : {0.08, 0.15}) {
    std::printf("\n## %s, one sensor, sigma %.0f %%, %d runs\n", title, 100.0 * sigma, settings.runs);
    std::printf(
        "| scenario | by | RMSE / sigma | over the filter's | ANEES position; state | hidden, RMSE / "
        "sigma\n");
    std::vector<Ratio> ratios;
    double time[kMethods] = {};
    for (const Scenario& scenario : scenarios)
      ratios.push_back(
          printScenario(scenario, sigma, settings, ratios.empty() ? kMethods : kWithoutLag, time));
    const Ratio mean = geometricMean(ratios);
    std::printf("smoother over filter: geometric mean %.3f +-%.3f, aim <= 0.72 %s; %s %.3f %s\n", mean.value,
                mean.value * mean.log_band, mark(mean.value <= 0.72), scenarios[0].name.c_str(),
                ratios[0].value, mark(ratios[0].value <= 0.72));
    std::printf("processor time of one sighting [us]:");
    const auto count = static_cast<double>(scenarios.size());
    std::printf(" filter %.2f, smoother %.2f (%.1f), aim <= 3.0 %s;", 1e6 * time[0] / count,
                1e6 * time[1] / count, time[1] / time[0], mark(time[1] <= 3.0 * time[0]));
    for (std::size_t k = kWithoutLag; k < kMethods; ++k) std::printf(" %s %.0f", kAll[k].name, 1e6 * time[k]);
    std::printf("\n");
  }
}

void run(int argc, char** argv) {
  Settings settings;
  for (int i = 1; i < argc; i += 2) {
    const std::string option = argv[i];
    if ((option != "--runs" && option != "--threads") || i + 1 == argc)
      throw std::invalid_argument("usage: smoothing [--runs N] [--threads N]");
    if (option == "--runs") settings.runs = numberOf(option, argv[i + 1], 2);
    if (option == "--threads") settings.threads = numberOf(option, argv[i + 1], 1);
  }
  printScenarios(namedScenarios(), "The eight scenarios", settings);
  printScenarios(unseenScenarios(), "Six trajectories that estimators.md does not name", settings);
}

}  // namespace
}  // namespace sightline::bench

int main(int argc, char** argv) {
  try {
    sightline::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "smoothing: %s\n", error.what());
    return 2;
  }
  return 0;
}
