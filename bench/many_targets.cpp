// Many targets that cross, biased sensors with a tracker each, clutter: what becomes of the global tracks,
// and what it costs.
//   many_targets [seeds]

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "fusion_of_many.h"

namespace {

using namespace sightline;

void printRow(const char* name, const bench::ManyTargets& scene, int seeds) {
  bench::ManyTargetsFigures sum;
  for (int seed = 1; seed <= seeds; ++seed) {
    bench::ManyTargets seeded = scene;
    seeded.seed = static_cast<std::uint64_t>(seed);
    sum.add(bench::followMany(seeded));
  }
  const double time = scene.duration * seeds;
  std::printf("| %s | %s | %.3f | %.3f | %.3f | %.1f | %.1f | %.2f | %.3f | %.3f |\n", name,
              core::nameOf(scene.fusion.rule).c_str(), 100.0 * sum.missed / sum.looks,
              100.0 * sum.duplicates / sum.looks, 100.0 * sum.astray / sum.looks,
              static_cast<double>(sum.label_changes) / seeds,
              static_cast<double>(sum.local_label_changes) / seeds / scene.sensors, 1e3 * sum.rmse(),
              sum.tracker_time / time, sum.fusion_time / time);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::max(std::atoi(argv[1]), 1) : 3;
  std::printf(
      "| scene | rule | missed [%%] | duplicates [%%] | astray [%%] | label changes a run | of a local "
      "tracker | "
      "RMSE [mrad] | trackers [s/s] | fusion [s/s] |\n|---|---|---|---|---|---|---|---|---|---|\n");
  for (const core::FusionRule rule : {core::FusionRule::best, core::FusionRule::cross_covariance}) {
    bench::ManyTargets scene;
    scene.fusion.rule = rule;
    scene.bias = 0.0;
    printRow("24 targets, P_D 0.9, 5 false", scene, seeds);
    scene.bias = 1.0;
    printRow("each sensor off by a sigma", scene, seeds);
    scene.detection_probability = 0.75;
    scene.clutter = 20.0;
    printRow("and P_D 0.75, 20 false", scene, seeds);
  }
  bench::ManyTargets load;
  load.targets = 200;
  load.half_width = 0.8;
  load.rate = 30.0;
  load.duration = 6.0;
  load.clutter = 10.0;
  load.bias = 0.0;
  printRow("200 targets, 30 Hz, 10 false", load, 1);
}
