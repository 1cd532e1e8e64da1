// Many targets that cross, six biased sensors with a tracker each, clutter: what becomes of the global
// tracks.
//   many_targets [seeds]

#include <cstdio>
#include <cstdlib>

#include "fusion_of_many.h"

int main(int argc, char** argv) {
  using namespace sightline;
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 3;
  std::printf(
      "| scene | rule | missed | duplicates | astray | label changes | of a local tracker | RMSE [mrad] | "
      "trackers | fusion |\n");
  for (const core::FusionRule rule : {core::FusionRule::best, core::FusionRule::cross_covariance}) {
    for (const double bias : {0.0, 1.0}) {
      bench::ManyTargetsFigures sum;
      bench::ManyTargets scene;
      scene.bias = bias;
      scene.fusion.rule = rule;
      for (int seed = 1; seed <= seeds; ++seed) {
        scene.seed = static_cast<std::uint64_t>(seed);
        const bench::ManyTargetsFigures f = bench::followMany(scene);
        std::printf("seed %d: missed %.0f dup %.0f astray %.0f labels %d local %d\n", seed, f.missed,
                    f.duplicates, f.astray, f.label_changes, f.local_label_changes);
        sum.add(f);
      }
      std::printf(
          "| bias %.1f sigma | %s | %.2f %% | %.2f %% | %.2f %% | %.1f | %.1f | %.3f | %.2f s | %.2f s |\n",
          bias, core::nameOf(rule).c_str(), 100.0 * sum.missed / sum.looks,
          100.0 * sum.duplicates / sum.looks, 100.0 * sum.astray / sum.looks,
          double(sum.label_changes) / seeds, double(sum.local_label_changes) / seeds / 6.0, 1e3 * sum.rmse(),
          sum.tracker_time / seeds, sum.fusion_time / seeds);
      std::fflush(stdout);
    }
  }
}
