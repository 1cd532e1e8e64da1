// Whether the published covariances are consistent: squared errors over them (ANEES, 1 when
// honest).
//
// On a random truth of white acceleration an honest covariance's ANEES of many runs lies, at every instant,
// in the band of chi^2 with 95 % probability. On a deterministic trajectory the error has a bias that comes
// and goes with the turns: only its average over time means something.

#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "sightline/core/evaluation/metrics.h"

#include "monte_carlo.h"
#include "tables.h"

namespace sightline::bench {
namespace {

constexpr double kAll = std::numeric_limits<double>::infinity();

/// Every estimator with its default settings; the first `kAimed` have aims.
constexpr std::size_t kAimed = 2;
std::vector<Contender> estimators(double white_acceleration) {
  std::vector<Contender> all = ours(kAll);
  const std::vector<Contender> others = otherEstimators(kAll);
  all.insert(all.end(), others.begin(), others.end());
  if (white_acceleration > 0.0) {
    BaselineParams truth;
    truth.models = {{BaselineModel::Kind::velocity, white_acceleration}};
    all.push_back({"KF that knows q", [truth] { return std::make_unique<BaselineEstimator>(truth); }, kAll});
  }
  return all;
}

/// Share of the instants inside the band, and below its upper end.
struct Shares {
  double inside = 0.0, below = 0.0;
};

Shares sharesOf(const Checkpoints& nees, int runs, int dimensions) {
  const core::Band band = core::aneesBand(static_cast<double>(runs) * dimensions);
  Shares shares;
  for (const double value : nees) {
    shares.inside += (value >= band.low && value <= band.high) / static_cast<double>(nees.size());
    shares.below += (value <= band.high) / static_cast<double>(nees.size());
  }
  return shares;
}

void printRandom(const char* what, const Scenario& scenario, const Sensors& sensors, const Options& options) {
  std::printf(
      "\n%s: mean, share of instants in the 95 %% band (below its upper end); aims: mean in [0.95, 1.05], "
      "90 %% inside\n%-18s| %-36s| %s\n",
      what, "", "position", "position and rate");
  const std::vector<Score> scores =
      evaluate(scenario, sensors, estimators(scenario.white_acceleration), options);
  for (std::size_t k = 0; k < scores.size(); ++k) {
    std::printf("%-18s", scores[k].name.c_str());
    const struct {
      const Sample& nees;
      Shares shares;
    } kinds[] = {{scores[k].nees_position, sharesOf(scores[k].position_at, options.runs, 2)},
                 {scores[k].nees_state, sharesOf(scores[k].state_at, options.runs, 4)}};
    for (const auto& kind : kinds) {
      const double mean = kind.nees.mean();
      std::printf("|%8.3g +-%4.2g %4.0f %% (%3.0f %%) ", mean, kind.nees.band(), 100.0 * kind.shares.inside,
                  100.0 * kind.shares.below);
      if (k >= kAimed) continue;
      const bool enough = kind.shares.inside >= 0.9;
      std::printf("%-6s %-6s", markOf(mean, 0.95, 1.05, kind.nees.band()), enough ? "met" : "MISSED");
    }
    std::printf("\n");
  }
}

void printDeterministic(const std::vector<const Scenario*>& scenarios, double sigma, const Options& options) {
  std::printf(
      "\ndeterministic, one of %.0f %%: average over time of position;state, aim: in [0.7, 1.2]\n%-18s",
      100.0 * sigma, "");
  for (const Scenario* scenario : scenarios) std::printf("|%24s ", scenario->name.c_str());
  std::printf("\n");
  std::vector<std::vector<Score>> columns;
  for (const Scenario* scenario : scenarios)
    columns.push_back(evaluate(*scenario, {{sigma}, 1.0}, estimators(0.0), options));
  for (std::size_t k = 0; k < columns.front().size(); ++k) {
    std::printf("%-18s", columns.front()[k].name.c_str());
    for (const auto& scores : columns) {
      const Sample &position = scores[k].nees_position, &state = scores[k].nees_state;
      std::printf("|%5.3g;%5.3g ", position.mean(), state.mean());
      if (k < kAimed) {
        std::printf("%-6s %-6s", markOf(position.mean(), 0.7, 1.2, position.band()),
                    markOf(state.mean(), 0.7, 1.2, state.band()));
      } else {
        std::printf("%13s", "");
      }
    }
    std::printf("\n");
  }
}

}  // namespace

void printConsistency(const Options& options) {
  std::printf("\n## Consistency: ANEES of the published covariances, %d runs\n", options.runs);
  const Sensors one8{{0.08}, 1.0}, one15{{0.15}, 1.0};
  printRandom("white acceleration 0.3, one of 8 %", scenarioOf("ncv0.3"), one8, options);
  printRandom("white acceleration 0.3, one of 15 %", scenarioOf("ncv0.3"), one15, options);
  printRandom("white acceleration 0.03, one of 8 %", scenarioOf("ncv0.03"), one8, options);
  printRandom("white acceleration 0.3, six sensors", scenarioOf("ncv0.3"), sixSensors(), options);
  std::vector<const Scenario*> scenarios;
  for (const char* name : {"sin", "weave", "line", "jinks", "s-turns"})
    scenarios.push_back(&scenarioOf(name));
  for (const double sigma : {0.08, 0.15}) printDeterministic(scenarios, sigma, options);
}

}  // namespace sightline::bench
