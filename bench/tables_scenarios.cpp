// The eight scenarios of section 7.1 (reference: E3) and six trajectories that estimators.md does not name,
// one sensor of 8 % or 15 %, one setting of each estimator for all.

#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "bounds.h"
#include "monte_carlo.h"
#include "parallel.h"
#include "tables.h"

namespace sightline::bench {
namespace {

/// Everything measured on one scenario.
struct Column {
  const Scenario* scenario = nullptr;
  std::vector<Score> ours, others, kalman, imm;
  double bound = std::numeric_limits<double>::quiet_NaN();  // RMSE / sigma
};

double boundOf(const Scenario& scenario, const Sensors& sensors, const Options& options) {
  const bool sinusoid = scenario.name.compare(0, 3, "sin") == 0 || scenario.name == "outlier";
  const bool line = scenario.name == "line";
  const double q = scenario.white_acceleration;
  if (!sinusoid && !line && !(q > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  double sum = 0.0;
  for (int run = 0; run < options.runs; ++run) {
    const Stream stream = simulate(scenario, sensors, run);
    sum += sinusoid ? sinusoidBound(stream)
           : line   ? lineBound(stream)
                    : whiteAccelerationBound(stream, q, sensors.scale);
  }
  return std::sqrt(sum / options.runs) / sensors.sigmas[0];
}

std::vector<Column> measure(const std::vector<Scenario>& scenarios, double sigma, const Options& options) {
  std::vector<Column> columns;
  const Sensors sensors{{sigma}, 1.0};
  for (const Scenario& scenario : scenarios) {
    // Against outliers the baselines have the soft gate of section 4.3, ours what the tracker puts before
    // them.
    const bool outliers = scenario.outlier_share > 0.0;
    const double share = outliers ? 0.01 : 0.0;
    const double gate = outliers ? kTrackerGate : std::numeric_limits<double>::infinity();
    Column column;
    column.scenario = &scenario;
    const std::pair<std::vector<Score>*, std::vector<Contender>> groups[] = {
        {&column.ours, ours(gate)},
        {&column.others, otherEstimators(gate)},
        {&column.kalman, kalmanFilters(1.0, share)},
        {&column.imm, imms(1.0, share)}};
    std::vector<Contender> all;
    for (const auto& group : groups) all.insert(all.end(), group.second.begin(), group.second.end());
    const std::vector<Score> scores = evaluate(scenario, sensors, all, options);
    auto next = scores.begin();
    for (const auto& group : groups) {
      const auto end = next + static_cast<std::ptrdiff_t>(group.second.size());
      group.first->assign(next, end);
      next = end;
    }
    column.bound = boundOf(scenario, sensors, options);
    columns.push_back(std::move(column));
  }
  return columns;
}

constexpr int kCell = 14;

void printName(const std::string& name) {
  std::printf("%-23s", name.c_str());
}

void printHead(const char* what, const std::vector<Column>& columns, const char* tail = "") {
  printName(what);
  for (const Column& column : columns) std::printf("|%*s", kCell, column.scenario->name.c_str());
  std::printf("|%s\n", tail);
}

/// RMSE / sigma with its band of every scenario; `of` picks the score.
template <typename Pick>
void printErrors(const std::string& name, const std::vector<Column>& columns, double sigma, const Pick& of) {
  printName(name);
  for (const Column& column : columns) {
    const Score& score = of(column);
    std::printf("|%7.3f +-%5.3f", score.estimate.root() / sigma, score.estimate.rootBand() / sigma);
  }
  std::printf("|\n");
}

template <typename Pick>
void printNees(const std::string& name, const std::vector<Column>& columns, const Pick& of) {
  printName(name);
  for (const Column& column : columns) {
    const Score& score = of(column);
    std::printf("|%6.3g;%6.3g ", score.nees_position.mean(), score.nees_state.mean());
  }
  std::printf("|\n");
}

/// Aims of a line of ratios; NaN = none.
struct RatioAims {
  double mean = std::numeric_limits<double>::quiet_NaN();
  double worst = std::numeric_limits<double>::quiet_NaN();
};

template <typename Above, typename Below>
void printRatios(const std::string& name, const std::vector<Column>& columns, const Above& above,
                 const Below& below, const RatioAims& aims) {
  printName(name);
  std::vector<Ratio> ratios;
  Ratio worst;
  for (const Column& column : columns) {
    ratios.push_back(rootRatio(above(column).estimate, below(column).estimate));
    if (ratios.back().value > worst.value) worst = ratios.back();
    std::printf("|%7.3f +-%5.3f", ratios.back().value, ratios.back().log_band * ratios.back().value);
  }
  const Ratio mean = geometricMean(ratios);
  std::printf("|  %6.3f +-%5.3f", mean.value, mean.log_band * mean.value);
  if (!std::isnan(aims.mean))
    std::printf("  <= %.3f %s", aims.mean, markOf(mean.value, aims.mean, mean.log_band * mean.value));
  if (!std::isnan(aims.worst))
    std::printf(", worst %.3f <= %.2f %s", worst.value, aims.worst,
                markOf(worst.value, aims.worst, worst.log_band * worst.value));
  std::printf("\n");
}

/// The single IMM with the smallest geometric mean over the scenarios.
std::size_t bestSingleImm(const std::vector<Column>& columns) {
  std::size_t best = 0;
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < columns.front().imm.size(); ++k) {
    double sum = 0.0;
    for (const Column& column : columns) sum += std::log(column.imm[k].estimate.mean());
    if (sum < smallest) smallest = sum, best = k;
  }
  return best;
}

const Score& bestKalman(const Column& column) {
  return column.kalman[bestOf(column.kalman)];
}

const Score& bestImm(const Column& column) {
  return column.imm[bestOf(column.imm)];
}

/// What the reference has for KF* (100 runs of its own), and the difference in standard errors of both.
void printReference(const std::vector<Column>& columns, const std::vector<double>& reference, double sigma) {
  printName("KF* of the reference");
  for (const double value : reference) std::printf("|%*.3f", kCell, value);
  std::printf("|\n");
  printName("  difference, z");
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const Sample& ours = bestKalman(columns[i]).estimate;
    const double error = ours.rootBand() / 1.96 / sigma, runs = static_cast<double>(ours.values().size());
    const double both = std::sqrt(error * error * (1.0 + runs / 100.0) + 0.0005 * 0.0005 / 3.0);
    std::printf("|%+*.1f", kCell, (ours.root() / sigma - reference[i]) / both);
  }
  std::printf("|\n");
}

struct Aims {
  RatioAims kalman[2], single_imm[2];  // of NOGA and TWBLS
  double nees_below = std::numeric_limits<double>::quiet_NaN();
};

/// Picks the k-th of a group of a column.
auto numbered(std::vector<Score> Column::*group, std::size_t k) {
  return [group, k](const Column& column) -> const Score& { return (column.*group)[k]; };
}

void printErrorBlock(const std::vector<Column>& columns, double sigma, const std::vector<double>& reference) {
  const Column& first = columns.front();
  printHead("RMSE / sigma", columns);
  for (std::size_t k = 0; k < first.ours.size(); ++k)
    printErrors(first.ours[k].name, columns, sigma, numbered(&Column::ours, k));
  for (std::size_t k = 0; k < first.others.size(); ++k)
    printErrors(first.others[k].name, columns, sigma, numbered(&Column::others, k));
  printErrors("KF* (hindsight)", columns, sigma, bestKalman);
  for (std::size_t k = 0; k < first.imm.size(); ++k)
    printErrors(first.imm[k].name, columns, sigma, numbered(&Column::imm, k));
  printName("bound");
  for (const Column& column : columns) {
    if (std::isnan(column.bound)) {
      std::printf("|%*s", kCell, "-");
    } else {
      std::printf("|%*.3f", kCell, column.bound);
    }
  }
  std::printf("|\n");
  printName("KF* is");
  for (const Column& column : columns) std::printf("|%*s", kCell, bestKalman(column).name.c_str());
  std::printf("|\n");
  if (!reference.empty()) printReference(columns, reference, sigma);
}

void printRatioBlock(const std::vector<Column>& columns, std::size_t single, const Aims& aims) {
  const Column& first = columns.front();
  std::printf("\nbest single IMM over these: %s\n", first.imm[single].name.c_str());
  printHead("RMSE ratios", columns, "  geometric mean     aim");
  for (std::size_t k = 0; k < first.ours.size(); ++k) {
    const auto pick = numbered(&Column::ours, k);
    const std::string& name = first.ours[k].name;
    printRatios(name + " / KF*", columns, pick, bestKalman, aims.kalman[k]);
    printRatios(name + " / best single IMM", columns, pick, numbered(&Column::imm, single),
                aims.single_imm[k]);
    printRatios(name + " / best IMM each", columns, pick, bestImm, {});
  }
  printRatios("single IMM / KF*", columns, numbered(&Column::imm, single), bestKalman, {});
}

void printNeesBlock(const std::vector<Column>& columns, std::size_t single, double aim) {
  const Column& first = columns.front();
  std::printf("\n");
  printHead("ANEES position;state", columns);
  for (std::size_t k = 0; k < first.ours.size(); ++k)
    printNees(first.ours[k].name, columns, numbered(&Column::ours, k));
  for (std::size_t k = 0; k < first.others.size(); ++k)
    printNees(first.others[k].name, columns, numbered(&Column::others, k));
  printNees("KF*", columns, bestKalman);
  printNees("best single IMM", columns, numbered(&Column::imm, single));
  for (std::size_t k = 0; k < first.ours.size() && !std::isnan(aim); ++k) {
    double worst = 0.0, band = 0.0;
    for (const Column& column : columns) {
      const Sample& nees = column.ours[k].nees_position;
      if (nees.mean() > worst) worst = nees.mean(), band = nees.band();
    }
    std::printf("%s: worst ANEES of the position %.2f, aim <= %.2f %s\n", first.ours[k].name.c_str(), worst,
                aim, markOf(worst, aim, band));
  }
}

void printColumns(const std::vector<Column>& columns, double sigma, const Aims& aims,
                  const std::vector<double>& reference) {
  const std::size_t single = bestSingleImm(columns);
  printErrorBlock(columns, sigma, reference);
  printRatioBlock(columns, single, aims);
  printNeesBlock(columns, single, aims.nees_below);
}

void printSinusoid(const Column& column, double sigma) {
  if (sigma > 0.1) return;
  std::printf("\nsinusoid at 8 %%, RMSE / sigma: ");
  const double aims[2] = {0.353, 0.487};
  for (std::size_t k = 0; k < 2; ++k) {
    const Sample& estimate = column.ours[k].estimate;
    const double value = estimate.root() / sigma, band = estimate.rootBand() / sigma;
    std::printf("%s %.3f +-%.3f, aim <= %.3f %s", column.ours[k].name.c_str(), value, band, aims[k],
                markOf(value, aims[k], band));
    if (k == 0) std::printf(", then 0.340 %s; ", markOf(value, 0.34, band));
  }
  std::printf("; bound %.3f\n", column.bound);
}

void printDropout(const Column& column, double sigma) {
  std::printf("\nposition predicted across the 1 s dropout, RMS / sigma (ANEES):\n");
  const auto line = [&](const Score& score, const char* note) {
    std::printf("  %-22s %6.3f +-%5.3f (%.2f)%s\n", score.name.c_str(), score.gap.root() / sigma,
                score.gap.rootBand() / sigma, score.gap_nees.mean(), note);
  };
  for (const Score& score : column.ours) {
    const bool aimed = score.name == "NOGA";
    char aim[64] = "";
    if (aimed)
      std::snprintf(aim, sizeof aim, "   aim <= 1.6 %s",
                    markOf(score.gap.root() / sigma, 1.6, score.gap.rootBand() / sigma));
    line(score, aim);
  }
  line(bestKalman(column), "   KF*");
  for (const Score& score : column.imm) line(score, "");
}

}  // namespace

void printScenarios(const Options& options) {
  const std::vector<double> reference[2] = {{0.441, 0.445, 0.505, 0.229, 1.107, 0.462, 0.477, 0.374},
                                            {0.407, 0.410, 0.453, 0.203, 0.790, 0.434, 0.422, 0.325}};
  for (const double sigma : {0.08, 0.15}) {
    const bool low = sigma < 0.1;
    std::printf("\n## The eight scenarios, one sensor, sigma %.0f %%, %d runs\n", 100.0 * sigma,
                options.runs);
    const std::vector<Column> columns = measure(namedScenarios(), sigma, options);
    Aims aims;
    aims.kalman[0].mean = low ? 0.823 : 0.891;
    aims.kalman[1].mean = low ? 1.071 : 1.074;
    aims.single_imm[0].mean = low ? 0.764 : 0.831;
    aims.single_imm[0].worst = 1.02;
    printColumns(columns, sigma, aims, reference[low ? 0 : 1]);
    printSinusoid(columns[0], sigma);
    printDropout(columns[4], sigma);
  }
}

void printUnseen(const Options& options) {
  for (const double sigma : {0.08, 0.15}) {
    std::printf(
        "\n## Six trajectories that estimators.md does not name, one sensor, sigma %.0f %%, %d runs\n",
        100.0 * sigma, options.runs);
    Aims aims;
    aims.kalman[0] = {0.99, 1.05};
    aims.nees_below = 1.3;
    printColumns(measure(unseenScenarios(), sigma, options), sigma, aims, {});
  }
}

}  // namespace sightline::bench
