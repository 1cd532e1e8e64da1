// Six asynchronous sensors in one tracker (reference: E4), and the same at every angular scale.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "bounds.h"
#include "monte_carlo.h"
#include "tables.h"

namespace sightline::bench {
namespace {

constexpr double kBestSigma = 0.08;

struct SixAims {
  const char* scenario;
  double noga, noga_then, twbls;
};

void printLine(const Score& score, double aim, double then) {
  const double value = score.estimate.root() / kBestSigma, band = score.estimate.rootBand() / kBestSigma;
  std::printf("%-22s|%7.3f +-%5.3f |%7.3f |%6.3g;%6.3g |", score.name.c_str(), value, band,
              score.prediction.root() / kBestSigma, score.nees_position.mean(), score.nees_state.mean());
  if (!std::isnan(aim)) std::printf(" <= %.3f %s", aim, markOf(value, aim, band));
  if (!std::isnan(then)) std::printf(", then %.3f %s", then, markOf(value, then, band));
  std::printf("\n");
}

double boundOf(const Scenario& scenario, const Options& options) {
  const bool sinusoid = scenario.name == "sin";
  if (!sinusoid && !(scenario.white_acceleration > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  double sum = 0.0;
  for (int run = 0; run < options.runs; ++run) {
    const Stream stream = simulate(scenario, sixSensors(), run);
    sum +=
        sinusoid ? sinusoidBound(stream) : whiteAccelerationBound(stream, scenario.white_acceleration, 1.0);
  }
  return std::sqrt(sum / options.runs) / kBestSigma;
}

}  // namespace

void printSixSensors(const Options& options) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  for (const SixAims& aims : {SixAims{"sin", 0.195, 0.185, 0.28}, SixAims{"weave", 0.315, none, 0.315},
                              SixAims{"ncv0.3", none, none, none}}) {
    const Scenario& scenario = scenarioOf(aims.scenario);
    std::printf("\n## Six asynchronous sensors (3 x 15 %%, 3 x 8 %%) in one tracker, %s, %d runs\n",
                aims.scenario, options.runs);
    std::printf("%-22s|%15s |%7s |%13s | aim\n", "", "RMSE / 0.08", "pred.", "ANEES pos;st");
    std::vector<Contender> all = ours(std::numeric_limits<double>::infinity());
    const std::vector<Contender> others = otherEstimators(std::numeric_limits<double>::infinity());
    for (const auto& list : {others, imms(1.0, 0.0), kalmanFilters(1.0, 0.0)})
      all.insert(all.end(), list.begin(), list.end());
    const std::vector<Score> scores = evaluate(scenario, sixSensors(), all, options);
    const std::size_t first_kalman = 2 + others.size() + imms(1.0, 0.0).size();
    printLine(scores[0], aims.noga, aims.noga_then);
    printLine(scores[1], aims.twbls, none);
    for (std::size_t k = 2; k < first_kalman; ++k) printLine(scores[k], none, none);
    const std::vector<Score> filters(scores.begin() + static_cast<std::ptrdiff_t>(first_kalman),
                                     scores.end());
    Score best = filters[bestOf(filters)];
    best.name = "KF* = " + best.name;
    printLine(best, none, none);
    const double bound = boundOf(scenario, options);
    if (!std::isnan(bound)) std::printf("%-22s|%7.3f\n", "bound", bound);
  }
}

void printScale(const Options& options) {
  Options fewer = options;
  fewer.runs = std::max(5, options.runs / 4);  // the same noise at every scale: few runs tell
  const double scales[] = {1.0, 0.1, 0.01, 1e-3, 1e-4};
  std::printf("\n## Default settings at every angular scale: RMSE / (scale x best sigma), %d runs\n",
              fewer.runs);
  std::printf("%-30s", "");
  for (const double scale : scales) std::printf("|%9g", scale);
  std::printf("| largest change, aim <= 3 %%\n");
  struct Case {
    const char* scenario;
    Sensors sensors;
    const char* what;
  };
  const Case cases[] = {{"sin", sixSensors(), "six sensors, sin"},
                        {"weave", sixSensors(), "six sensors, weave"},
                        {"sin", {{0.08}, 1.0}, "one of 8 %, sin"},
                        {"line", {{0.08}, 1.0}, "one of 8 %, line"},
                        {"weave", {{0.08}, 1.0}, "one of 8 %, weave"}};
  for (const Case& entry : cases) {
    std::vector<std::vector<Score>> of_scale;
    for (const double scale : scales) {
      Sensors sensors = entry.sensors;
      sensors.scale = scale;
      of_scale.push_back(evaluate(scenarioOf(entry.scenario), sensors,
                                  ours(std::numeric_limits<double>::infinity()), fewer));
    }
    for (std::size_t k = 0; k < 2; ++k) {
      std::printf("%-6s%-24s", of_scale[0][k].name.c_str(), entry.what);
      double change = 0.0;
      for (std::size_t i = 0; i < of_scale.size(); ++i) {
        const double value = of_scale[i][k].estimate.root() / scales[i] / kBestSigma;
        const double at_one = of_scale[0][k].estimate.root() / kBestSigma;
        change = std::max(change, std::abs(value / at_one - 1.0));
        std::printf("|%9.4f", value);
      }
      std::printf("| %5.2f %% %s\n", 100.0 * change, markOf(change, 0.03, 0.0));
    }
  }
}

}  // namespace sightline::bench
