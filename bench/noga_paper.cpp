// NOGA of the paper on the paper's benchmark, in every reading of it, beside the reference figures of an
// independent numpy implementation (100 runs, other seeds).
//
//   noga_paper [--runs N]     (default 100)
//
// Figures over t in (1, 10] s and both channels, in units of sigma; +- is the 95 % band over runs. Few rows
// leave few degrees of freedom: the errors then have such tails that the root mean square converges slowly or
// not at all, and the figure to compare is the one from the median, median |error| / 0.6745.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "sightline/core/estimators/noga.h"

#include "paper_benchmark.h"
#include "quantiles.h"

namespace sightline::bench {
namespace {

using core::NogaEstimator;
using core::NogaParams;

/// One reading and what the reference has for it; NaN = not given.
struct Reading {
  int rows;
  bool weighted, feedback;
  double estimate[2], median[2], prediction[2];  // for sigma 8 % and 15 %
};

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
const Reading kReadings[] = {
    {18, false, false, {0.777, 0.731}, {0.777, 0.74}, {0.917, 0.851}},
    {3, false, false, {1.258, 1.212}, {0.975, 0.97}, {3.543, 4.340}},
    {3, true, false, {2.730, 1.993}, {2.109, 1.98}, {11.842, 4.292}},
    {18, true, false, {4.912, kNone}, {6.215, kNone}, {kNone, kNone}},
    {3, false, true, {253547.0, 218323.0}, {16.27, 8.29}, {487661.0, 318985.0}},
    {3, true, true, {8.839, 4.714}, {13.10, 6.99}, {8.839, 4.714}},
};

std::string nameOf(const Reading& reading) {
  return std::to_string(reading.rows) + " rows" + (reading.weighted ? ", weighted" : "") +
         (reading.feedback ? ", feedback" : "");
}

/// Errors of one reading under both kinds of covariance; the estimates are the same.
struct Errors {
  Score printed, residual;
  std::vector<double> sizes;  // of the estimate, each sighting and channel [rad]

  double fromMedian() const { return median(sizes) / 0.6745; }
};

void addRun(const Run& run, NogaParams params, bool sizes, Score& score, Errors& errors) {
  EstimatorMethod method([&] { return std::make_unique<NogaEstimator>(params); });
  method.begin();
  for (std::size_t i = 0; i < run.sightings.size(); ++i) {
    Answer answers[2];
    method.answer(run.sightings[i], answers);
    if (core::seconds(run.sightings[i].time.time_since_epoch()) <= 1.0) continue;
    for (int channel = 0; channel < 2; ++channel) {
      score.add(answers[channel], run.truth[i](channel), run.truth[i](channel + 2));
      if (sizes) errors.sizes.push_back(std::abs(answers[channel].estimate - run.truth[i](channel)));
    }
  }
  score.endRun();
}

Errors measured(const Reading& reading, double sigma, int runs) {
  NogaParams params;
  params.rows = reading.rows;
  params.weighted = reading.weighted;
  params.feedback = reading.feedback;
  Errors errors;
  for (int k = 0; k < runs; ++k) {
    const Run run = simulate(1000 + static_cast<std::uint64_t>(k), sigma);
    params.covariance = core::NogaCovariance::printed;
    addRun(run, params, true, errors.printed, errors);
    params.covariance = core::NogaCovariance::residual;
    addRun(run, params, false, errors.residual, errors);
  }
  return errors;
}

void printReference(double reference) {
  if (std::isnan(reference)) {
    std::printf(" %9s", "-");
  } else {
    std::printf(" %9.4g", reference);
  }
}

void printFigure(const Figure& figure, double sigma, double reference) {
  std::printf(" | %9.4g +-%8.2g", figure.root() / sigma, 1.96 * figure.rootStandardError() / sigma);
  printReference(reference);
}

void printTable(double sigma, int runs) {
  std::printf("\nsigma %.0f %%, %d runs\n%-28s | %-30s | %-17s | %-30s | %s\n", 100.0 * sigma, runs, "",
              "estimate / sigma     reference", "median  reference", "prediction / sigma   reference",
              "ANEES printed, residual");
  const int column = sigma < 0.1 ? 0 : 1;
  for (const Reading& reading : kReadings) {
    Errors errors = measured(reading, sigma, runs);
    std::printf("%-28s", nameOf(reading).c_str());
    printFigure(errors.printed.estimate, sigma, reading.estimate[column]);
    std::printf(" | %7.4g", errors.fromMedian() / sigma);
    printReference(reading.median[column]);
    printFigure(errors.printed.prediction, sigma, reading.prediction[column]);
    std::printf(" | %9.3g %9.3g\n", errors.printed.estimate_nees.mean(),
                errors.residual.estimate_nees.mean());
  }
}

}  // namespace
}  // namespace sightline::bench

int main(int argc, char** argv) {
  int runs = 100;
  if (argc == 3 && std::strcmp(argv[1], "--runs") == 0) runs = std::atoi(argv[2]);
  if ((argc != 1 && argc != 3) || runs < 2) {
    std::fprintf(stderr, "usage: noga_paper [--runs N]   (N >= 2)\n");
    return 2;
  }
  for (const double sigma : {0.08, 0.15}) sightline::bench::printTable(sigma, runs);
  return 0;
}
