#include "fusion_of_many.h"

#include <cmath>

#include <gtest/gtest.h>

namespace sightline::bench {
namespace {

ManyTargetsFigures overSeeds(ManyTargets scene) {
  ManyTargetsFigures sum;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    scene.seed = seed;
    sum.add(followMany(scene));
  }
  return sum;
}

/// False tracks fall near a target by chance: as often as the targets' surroundings fill the square.
double duplicatesByChance(const ManyTargets& scene, const ManyTargetsFigures& figures) {
  const double filled = scene.targets * M_PI * kNear * kNear / std::pow(2.0 * scene.half_width, 2.0);
  return filled / (1.0 - filled) * figures.astray;
}

/// One look in a thousand.
void expectOneTrackForEachTarget(const ManyTargets& scene, const ManyTargetsFigures& figures) {
  EXPECT_EQ(figures.label_changes, 0);
  EXPECT_LE(figures.missed, 1e-3 * figures.looks);
  EXPECT_LE(figures.duplicates, 2.0 * duplicatesByChance(scene, figures) + 1e-3 * figures.looks);
}

TEST(FusionOfMany, KeepsOneTrackWithOneLabelForEachOfTwentyFourTargetsThatCross) {
  ManyTargets scene;
  scene.bias = scene.clutter = 0.0;
  const ManyTargetsFigures figures = overSeeds(scene);
  expectOneTrackForEachTarget(scene, figures);
  EXPECT_EQ(figures.missed, 0.0);
  EXPECT_EQ(figures.duplicates, 0.0);
}

TEST(FusionOfMany, KeepsThemInClutterThatMakesItsTrackersChangeTheirs) {
  ManyTargets scene;
  scene.bias = 0.0;
  const ManyTargetsFigures figures = overSeeds(scene);
  expectOneTrackForEachTarget(scene, figures);
}

TEST(FusionOfMany, KeepsThemThoughEverySensorIsOffByASigma) {
  const ManyTargets scene;
  expectOneTrackForEachTarget(scene, overSeeds(scene));
}

}  // namespace
}  // namespace sightline::bench
