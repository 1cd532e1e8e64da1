#include "sightline/core/imaging/pixel_mask.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "sightline/core/simulation/random_stream.h"

namespace sightline::core {
namespace {

constexpr int kWidth = 60, kHeight = 50, kGuard = 6, kNeighbourhood = 12;  // [px]
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

std::size_t at(int u, int v) {
  return static_cast<std::size_t>(v * kWidth + u);
}

std::vector<float> slope() {
  std::vector<float> pixels(kWidth * kHeight);
  for (int v = 0; v < kHeight; ++v)
    for (int u = 0; u < kWidth; ++u) pixels[at(u, v)] = static_cast<float>(500.0 + 3.0 * u - 2.0 * v);
  return pixels;
}

TEST(PixelMask, AnImageWithoutBadPixelsIsHandedThrough) {
  PixelMask mask(kGuard, kNeighbourhood);
  const auto pixels = slope();
  const GreyImage same = mask.apply({pixels.data(), kWidth, kHeight});
  EXPECT_EQ(same.pixels, pixels.data());
  EXPECT_EQ(mask.count(), 0);
  EXPECT_TRUE(mask.isKnown(0));
  EXPECT_FALSE(mask.isBad(0));
}

TEST(PixelMask, NotANumberInfiniteAndAbsurdPixelsAreBadAndCountedAndReplacedByTheMean) {
  PixelMask mask(kGuard, kNeighbourhood);
  std::vector<float> pixels(kWidth * kHeight, 10.0F);
  const float infinite = std::numeric_limits<float>::infinity();
  const float bad[] = {kNaN, infinite, -infinite, std::numeric_limits<float>::max(), -1e30F};
  for (int i = 0; i < 5; ++i) pixels[at(5 * i, 7)] = bad[i];
  const GreyImage filled = mask.apply({pixels.data(), kWidth, kHeight});
  EXPECT_EQ(mask.count(), 5);
  for (int i = 0; i < 5; ++i) {
    EXPECT_TRUE(mask.isBad(static_cast<int>(at(5 * i, 7))));
    EXPECT_EQ(filled.pixels[at(5 * i, 7)], 10.0F);
  }
  EXPECT_FALSE(mask.isBad(static_cast<int>(at(1, 7))));
  const auto good = slope();
  mask.apply({good.data(), kWidth, kHeight});
  EXPECT_EQ(mask.count(), 0) << "the next image";
}

/// The planes of the spot detector for an image, mended.
struct Planes {
  std::vector<float> smoothed, contrast, rough, noise;
};

Planes planesOf(PixelMask& mask, const std::vector<float>& pixels) {
  const GreyImage image = mask.apply({pixels.data(), kWidth, kHeight});
  const auto within = [](int value, int end) { return std::clamp(value, 0, end - 1); };
  Planes planes;
  planes.smoothed.resize(pixels.size());
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      float sum = 0.0F;
      for (int dv = -1; dv <= 1; ++dv)
        for (int du = -1; du <= 1; ++du)
          sum += (du == 0 ? 0.5F : 0.25F) * (dv == 0 ? 0.5F : 0.25F) *
                 image.pixels[at(within(u + du, kWidth), within(v + dv, kHeight))];
      planes.smoothed[at(u, v)] = sum;
    }
  }
  if (mask.count() > 0) mask.mendSmoothed(planes.smoothed);
  planes.contrast.assign(pixels.size(), -1.0F);
  if (mask.count() > 0) mask.mendContrast(planes.smoothed, planes.contrast);
  planes.rough.assign(pixels.size(), 5.0F);
  planes.noise.assign(pixels.size(), 7.0F);
  if (mask.count() > 0) mask.mendNoise(planes.rough, planes.noise);
  return planes;
}

TEST(PixelMask, OnASlopeNearABlockOfBadPixelsThereIsNoContrast) {
  PixelMask mask(kGuard, kNeighbourhood);
  auto pixels = slope();
  for (int v = 0; v < 20; ++v)
    for (int u = 0; u < 25; ++u) pixels[at(u, v)] = kNaN;
  const Planes planes = planesOf(mask, pixels);
  int known = 0;
  // The image's rim, where pixels count for those beyond, is left out with what it is the background of.
  for (int v = kNeighbourhood + 1; v + kNeighbourhood + 1 < kHeight; ++v) {
    for (int u = kNeighbourhood + 1; u + kNeighbourhood + 1 < kWidth; ++u) {
      if (planes.contrast[at(u, v)] == -1.0F) continue;  // far from the block
      EXPECT_NEAR(planes.contrast[at(u, v)], 0.0, 2e-3) << u << ", " << v;
      known += mask.isKnown(at(u, v)) ? 1 : 0;
    }
  }
  EXPECT_GT(known, 200);
  EXPECT_FALSE(mask.isKnown(at(10, 10)));
  EXPECT_TRUE(std::isinf(planes.noise[at(10, 10)])) << "nothing is seen there";
  EXPECT_TRUE(mask.isKnown(at(25, 10)));
}

TEST(PixelMask, FarFromABadPixelNothingChanges) {
  PixelMask mask(kGuard, kNeighbourhood);
  auto pixels = slope();
  pixels[at(10, 10)] = kNaN;
  const Planes planes = planesOf(mask, pixels);
  EXPECT_EQ(planes.contrast[at(40, 10)], -1.0F);
  EXPECT_EQ(planes.noise[at(40, 10)], 7.0F);
  EXPECT_NEAR(planes.smoothed[at(10, 10)], 500.0 + 30.0 - 20.0, 1e-3) << "from its neighbours";
}

TEST(PixelMask, NoiseNearBadPixelsIsThatOfTheGoodOnesAndGrowsWithWhatIsMissing) {
  PixelMask mask(kGuard, kNeighbourhood);
  auto pixels = slope();
  pixels[at(30, 25)] = kNaN;
  const Planes planes = planesOf(mask, pixels);
  // `rough` is 5 everywhere: the noise of a smoothed pixel is the root of 4/5 of its square.
  const double of_smoothed = std::sqrt(0.8) * 5.0;
  EXPECT_NEAR(planes.noise[at(38, 25)], of_smoothed, 0.05) << "one of hundreds of the ring is missing";
  // At the bad pixel 3/4 of the weight is left: 4/64 + 4/256 of a pixel's variance, over its square.
  EXPECT_NEAR(planes.noise[at(30, 25)],
              of_smoothed * std::sqrt((4.0 / 64.0 + 4.0 / 256.0) / (0.75 * 0.75) / 0.140625), 0.05);
}

// The plane's level errs too; together they err as much as is said.
TEST(PixelMask, ContrastBesideABlockErrsAsItsNoiseSays) {
  PixelMask mask(kGuard, kNeighbourhood);
  RandomStream stream(5);
  double squares = 0.0;
  int count = 0;
  for (int i = 0; i < 400; ++i) {
    auto pixels = slope();
    for (float& pixel : pixels) pixel += static_cast<float>(4.0 * stream.normalPair().x());
    for (int v = 0; v < kHeight; ++v)
      for (int u = 0; u < 30; ++u) pixels[at(u, v)] = kNaN;
    const Planes planes = planesOf(mask, pixels);
    const std::size_t beside = at(30, 25);
    // With `rough` of 5 the noise is stated for a pixel's variance of 0.8 * 25 / 0.140625.
    const double stated = planes.noise[beside] * 4.0 / std::sqrt(0.8 * 25.0 / 0.140625);
    squares += std::pow(planes.contrast[beside] / stated, 2);
    ++count;
  }
  EXPECT_NEAR(squares / count, 1.0, 4.0 * std::sqrt(2.0 / count));
}

}  // namespace
}  // namespace sightline::core
