// Accuracy and consistency of the fusion rules, as the fusion node applies them to reported tracks
// (reference: E5). Usage: track_fusion_rules [runs]
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "sightline/core/estimators/kalman.h"
#include "sightline/core/estimators/twbls.h"

#include "fusion_benchmark.h"

namespace {

using namespace sightline;
using namespace sightline::bench;

std::vector<core::TrackFusionParams> fusions() {
  std::vector<core::TrackFusionParams> all(4);
  all[0].rule = core::FusionRule::weighted_covariance;
  all[1].rule = core::FusionRule::cross_covariance;
  all[2].rule = core::FusionRule::covariance_intersection;
  all[3].rule = core::FusionRule::covariance_intersection;
  all[3].intersection_weights = core::IntersectionWeights::trace;
  return all;
}

void print(const char* name, const FusionScore& score) {
  std::printf("| %-42s | %.3f +- %.3f | %5.2f +- %.2f | %5.2f +- %.2f |\n", name, score.rmse() / 0.08,
              score.squares.rootStandardError() / 0.08, score.position_nees.mean(),
              score.position_nees.standardError(), score.state_nees.mean(), score.state_nees.standardError());
}

void printTable(const char* title, const FusionExperiment& experiment) {
  const FusionScores scores = score(experiment, fusions());
  std::printf("\n### %s\n", title);
  std::printf("| %-42s | RMSE/0.08       | ANEES position | ANEES state   |\n|---|---|---|---|\n", "fusion");
  print("local track of the first sensor", scores.local);
  const char* const names[] = {"weighted_covariance", "cross_covariance",
                               "covariance_intersection, determinant", "covariance_intersection, trace"};
  for (std::size_t k = 0; k < scores.fused.size(); ++k) print(names[k], scores.fused[k]);
  if (scores.broken > 0) std::printf("(instants without all sensors in one track: %zu)\n", scores.broken);
}

}  // namespace

int main(int argc, char** argv) {
  const int runs = argc > 1 ? std::atoi(argv[1]) : 100;
  const EstimatorMaker kalman = [] {
    core::KalmanParams params;
    params.process_noise = kDensity * kAmplitude * kAmplitude;
    return std::make_unique<core::KalmanEstimator>(params);
  };
  const EstimatorMaker twbls = [] { return std::make_unique<core::TwblsEstimator>(core::TwblsParams{}); };

  const std::vector<double> two{0.08, 0.08}, unlike{0.08, 0.15}, six{0.08, 0.08, 0.08, 0.15, 0.15, 0.15};
  const auto experiment = [runs](Target target, const std::vector<double>& sigmas, const EstimatorMaker& make,
                                 bool synchronous) {
    return FusionExperiment{target, sigmas, make, synchronous, runs, 1};
  };
  printTable("sin, two equal 8 %, Kalman q = 0.3", experiment(Target::sinusoid, two, kalman, true));
  printTable("sin, 8 % + 15 %, Kalman q = 0.3", experiment(Target::sinusoid, unlike, kalman, true));
  printTable("sin, 3 x 8 % + 3 x 15 %, Kalman q = 0.3", experiment(Target::sinusoid, six, kalman, true));
  printTable("white acceleration 0.3, 8 % + 15 %, Kalman q = 0.3",
             experiment(Target::white_acceleration, unlike, kalman, true));
  printTable("white acceleration 0.3, 3 x 8 % + 3 x 15 %, Kalman q = 0.3",
             experiment(Target::white_acceleration, six, kalman, true));
  printTable("white acceleration 0.3, 3 x 8 % + 3 x 15 %, each at its own times, Kalman q = 0.3",
             experiment(Target::white_acceleration, six, kalman, false));
  printTable("sin, 3 x 8 % + 3 x 15 %, TWBLS", experiment(Target::sinusoid, six, twbls, true));
  printTable("sin, 3 x 8 % + 3 x 15 %, each at its own times, TWBLS",
             experiment(Target::sinusoid, six, twbls, false));
  return 0;
}
