#include "sightline/core/imaging/spot_detector.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "sightline/core/simulation/random_stream.h"

namespace sightline::core {
namespace {

constexpr int kWidth = 160, kHeight = 120;  // [px]
constexpr double kNoise = 10.0;             // [grey levels]

/// A slope with white noise.
class Picture {
 public:
  explicit Picture(RandomStream& stream, double noise = kNoise) : pixels_(kWidth * kHeight) {
    for (std::size_t i = 0; i < pixels_.size(); i += 2) {
      const Eigen::Vector2d drawn = noise * stream.normalPair();
      for (std::size_t k = 0; k < 2; ++k) {
        const std::size_t u = (i + k) % kWidth, v = (i + k) / kWidth;
        pixels_[i + k] =
            static_cast<float>(2000.0 + 1.5 * double(u) - 2.0 * double(v) + drawn(Eigen::Index(k)));
      }
    }
  }

  /// Adds a Gaussian spot.
  Picture& with(const Eigen::Vector2d& centre, double peak, double sigma = 1.2) {
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        const double d2 = (Eigen::Vector2d(u, v) - centre).squaredNorm();
        pixels_[std::size_t(v * kWidth + u)] +=
            static_cast<float>(peak * std::exp(-0.5 * d2 / (sigma * sigma)));
      }
    }
    return *this;
  }

  /// Adds a level to all pixels right of a column.
  Picture& withEdge(int column, double step) {
    for (int v = 0; v < kHeight; ++v)
      for (int u = column; u < kWidth; ++u) pixels_[std::size_t(v * kWidth + u)] += static_cast<float>(step);
    return *this;
  }

  /// Replaces the pixels of a rectangle from its first to before its last corner.
  Picture& withBad(int left, int top, int right, int bottom, float value) {
    for (int v = top; v < bottom; ++v)
      for (int u = left; u < right; ++u) pixels_[std::size_t(v * kWidth + u)] = value;
    return *this;
  }

  GreyImage view() const { return {pixels_.data(), kWidth, kHeight}; }

 private:
  std::vector<float> pixels_;
};

SpotDetectorParams withoutFloor() {
  SpotDetectorParams params;
  params.threshold = 6.0;
  params.centroid_floor = 0.0;
  return params;
}

TEST(SpotDetector, PlainNoiseOnASlopeHasNoSpots) {
  RandomStream stream(1);
  SpotDetector detector(withoutFloor());
  int spots = 0;
  // Beyond six sigma lie 1e-9 of Gaussian pixels: 2e-3 in a hundred of these pictures. The noise is measured
  // on 450 pixels that are smoothed, so say some ten times as many.
  for (int i = 0; i < 100; ++i) spots += static_cast<int>(detector.detect(Picture(stream).view()).size());
  EXPECT_LE(spots, 1);
}

TEST(SpotDetector, SpotsAreFoundWithCentresThatErrAsTheirCovarianceSays) {
  RandomStream stream(2);
  SpotDetector detector(withoutFloor());
  int seen = 0, offered = 0;
  double nees = 0.0;
  for (int i = 0; i < 60; ++i) {
    Picture picture(stream);
    std::vector<Eigen::Vector2d> truth;
    for (int u = 20; u < 150; u += 30)
      for (int v = 20; v < 110; v += 30) truth.emplace_back(u + stream.uniform(), v + stream.uniform());
    for (const auto& centre : truth) picture.with(centre, 150.0);
    offered += static_cast<int>(truth.size());
    for (const Spot& spot : detector.detect(picture.view())) {
      for (const auto& centre : truth) {
        const Eigen::Vector2d error = spot.pixel - centre;
        if (error.norm() > 3.0) continue;
        ++seen;
        nees += error.dot(spot.covariance.llt().solve(error)) / 2.0;
      }
    }
  }
  EXPECT_EQ(seen, offered);
  // The mean of chi^2_2 / 2 scatters by 1/sqrt(n): four of them, and 5 % for pixels and the neighbours'
  // skirts.
  EXPECT_NEAR(nees / seen, 1.0, 4.0 / std::sqrt(double(seen)) + 0.05);
}

TEST(SpotDetector, WithoutNoiseTheCentreIsExactOnASlopeToo) {
  RandomStream stream(3);
  SpotDetector detector(withoutFloor());
  const Eigen::Vector2d centre(70.37, 51.82);
  const auto spots = detector.detect(Picture(stream, 0.0).with(centre, 100.0).view());
  ASSERT_EQ(spots.size(), 1u);
  EXPECT_LT((spots[0].pixel - centre).norm(), 2e-3);
  EXPECT_GT(spots[0].contrast, 50.0);
}

TEST(SpotDetector, FaintSpotsAreKnownLessWellThanBrightOnes) {
  RandomStream stream(4);
  SpotDetector detector(withoutFloor());
  const auto spots =
      detector.detect(Picture(stream).with({40.0, 60.0}, 400.0).with({110.0, 60.0}, 100.0).view());
  ASSERT_EQ(spots.size(), 2u);
  EXPECT_LT(spots[0].pixel.x(), 75.0) << "the strongest first";
  EXPECT_NEAR(std::sqrt(spots[1].covariance.trace() / spots[0].covariance.trace()), 4.0, 1.0);
  EXPECT_NEAR(spots[0].snr / spots[1].snr, 4.0, 1.0);
}

TEST(SpotDetector, TheFloorIsAddedToTheCentresVariance) {
  SpotDetectorParams params = withoutFloor();
  params.centroid_floor = 0.3;
  RandomStream stream(5), same(5);
  const auto with = SpotDetector(params).detect(Picture(stream).with({40.0, 60.0}, 400.0).view());
  const auto without = SpotDetector(withoutFloor()).detect(Picture(same).with({40.0, 60.0}, 400.0).view());
  ASSERT_EQ(with.size(), 1u);
  ASSERT_EQ(without.size(), 1u);
  EXPECT_NEAR((with[0].covariance - without[0].covariance).trace(), 2.0 * 0.09, 1e-9);
}

TEST(SpotDetector, EdgesAndLargeThingsAreNoSpots) {
  RandomStream stream(6);
  SpotDetector detector(withoutFloor());
  EXPECT_TRUE(detector.detect(Picture(stream).withEdge(80, 500.0).view()).empty());
  EXPECT_TRUE(detector.detect(Picture(stream).with({80.0, 60.0}, 500.0, 9.0).view()).empty());
}

TEST(SpotDetector, PolarityDecidesBetweenBrightAndDark) {
  for (const auto polarity : {SpotDetectorParams::Polarity::bright, SpotDetectorParams::Polarity::dark,
                              SpotDetectorParams::Polarity::both}) {
    SpotDetectorParams params = withoutFloor();
    params.polarity = polarity;
    RandomStream stream(7);
    SpotDetector detector(params);
    const auto spots =
        detector.detect(Picture(stream).with({40.0, 60.0}, 300.0).with({110.0, 60.0}, -300.0).view());
    const bool both = polarity == SpotDetectorParams::Polarity::both;
    ASSERT_EQ(spots.size(), both ? 2u : 1u);
    if (!both) {
      EXPECT_EQ(spots[0].contrast > 0.0, polarity == SpotDetectorParams::Polarity::bright);
    }
  }
}

TEST(SpotDetector, OverTimeWhatStandsStillIsForgottenAndWhatMovesIsNot) {
  SpotDetectorParams params = withoutFloor();
  params.background = SpotDetectorParams::Background::temporal;
  SpotDetector detector(params);
  RandomStream stream(8);
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector2d moving(20.0 + 2.0 * i, 90.0);
    const auto spots = detector.detect(Picture(stream).with({120.0, 30.0}, 300.0).with(moving, 300.0).view());
    EXPECT_EQ(detector.isReady(), i >= params.warm_up) << i;
    if (i < params.warm_up) {
      EXPECT_TRUE(spots.empty());
      continue;
    }
    ASSERT_EQ(spots.size(), 1u) << i;
    EXPECT_LT((spots[0].pixel - moving).norm(), 0.5);
  }
}

TEST(SpotDetector, ImagesOfAnotherSizeTinyAndConstantOnesAreHarmless) {
  SpotDetector detector(SpotDetectorParams{});
  const std::vector<float> constant(200 * 100, 7.0F);
  for (const auto& [width, height] :
       {std::pair{200, 100}, {1, 1}, {2, 3}, {1, 50}, {13, 5}, {100, 200}, {0, 0}}) {
    EXPECT_TRUE(detector.detect({constant.data(), width, height}).empty()) << width << 'x' << height;
  }
}

TEST(SpotDetector, SixteenBitImagesKeepTheirPrecision) {
  // A level of 60000 with noise of 5: squares of 3.6e9 must not drown a variance of 25.
  std::vector<float> pixels(kWidth * kHeight);
  RandomStream stream(9);
  for (float& pixel : pixels) pixel = static_cast<float>(60000.0 + 5.0 * stream.normalPair().x());
  pixels[60 * kWidth + 80] += 400.0F;
  SpotDetector detector(withoutFloor());
  const auto spots = detector.detect({pixels.data(), kWidth, kHeight});
  ASSERT_EQ(spots.size(), 1u);
  EXPECT_LT((spots[0].pixel - Eigen::Vector2d(80.0, 60.0)).norm(), 0.1);
}

TEST(SpotDetector, CovariancesArePositiveDefiniteAtTheImagesRimToo) {
  RandomStream stream(10);
  SpotDetector detector(withoutFloor());
  int seen = 0;
  for (const Eigen::Vector2d& centre :
       {Eigen::Vector2d(2.0, 60.0), Eigen::Vector2d(1.5, 1.5), Eigen::Vector2d(157.0, 118.0)}) {
    for (const Spot& spot : detector.detect(Picture(stream).with(centre, 800.0).view())) {
      ++seen;
      EXPECT_EQ(spot.covariance.llt().info(), Eigen::Success);
      EXPECT_TRUE(spot.pixel.allFinite());
    }
  }
  EXPECT_GE(seen, 1);
}

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

TEST(SpotDetector, BadPixelsElsewhereChangeNothingOfASpot) {
  const Eigen::Vector2d centre(100.3, 40.7);
  for (const double noise : {0.0, kNoise}) {
    for (const auto background :
         {SpotDetectorParams::Background::spatial, SpotDetectorParams::Background::temporal}) {
      SpotDetectorParams params;
      params.background = background;
      params.warm_up = 1;
      const auto spotsOf = [&](const auto& spoil) {
        SpotDetector detector(params);
        RandomStream stream(12);
        Picture first(stream, noise);
        detector.detect(first.view());
        Picture picture(stream, noise);
        picture.with(centre, 200.0);
        spoil(picture);
        return detector.detect(picture.view());
      };
      const auto clean = spotsOf([](Picture&) {});
      ASSERT_EQ(clean.size(), 1u);
      const auto expectSame = [&](const std::vector<Spot>& spots, const char* what) {
        ASSERT_EQ(spots.size(), 1u) << what;
        EXPECT_LT((spots[0].pixel - clean[0].pixel).norm(), 1e-9) << what;
        EXPECT_NEAR(spots[0].snr, clean[0].snr, 1e-6 * clean[0].snr) << what;
        EXPECT_LT((spots[0].covariance - clean[0].covariance).norm(), 1e-9) << what;
      };
      expectSame(spotsOf([](Picture& p) { p.withBad(5, 5, 6, 6, kNaN); }), "one that is not a number");
      expectSame(spotsOf([](Picture& p) { p.withBad(5, 5, 6, 6, kInf); }), "an infinite one");
      expectSame(spotsOf([](Picture& p) { p.withBad(150, 110, 151, 111, -kInf); }), "minus infinity");
      expectSame(spotsOf([](Picture& p) { p.withBad(0, 0, 30, 40, kNaN); }), "a block in a corner");
      expectSame(
          spotsOf([](Picture& p) { p.withBad(0, 70, kWidth, 71, kNaN).withBad(30, 0, 31, 120, kInf); }),
          "a row and a column");
    }
  }
}

TEST(SpotDetector, BadPixelsAreCounted) {
  RandomStream stream(13);
  SpotDetector detector(SpotDetectorParams{});
  Picture picture(stream);
  detector.detect(picture.view());
  EXPECT_EQ(detector.badPixels(), 0);
  detector.detect(picture.withBad(3, 4, 6, 6, kNaN).view());
  EXPECT_EQ(detector.badPixels(), 6);
  EXPECT_TRUE(detector.detect(picture.withBad(0, 0, kWidth, kHeight, kNaN).view()).empty());
  EXPECT_EQ(detector.badPixels(), kWidth * kHeight);
  detector.detect(Picture(stream).view());
  EXPECT_EQ(detector.badPixels(), 0);
}

TEST(SpotDetector, ASpotWithABadPixelIsStillFoundWhereItIs) {
  const Eigen::Vector2d centre(100.3, 40.7);
  for (const auto& [u, v] : {std::pair{100, 41}, {101, 41}, {99, 40}, {102, 40}, {103, 43}}) {
    RandomStream stream(14);
    SpotDetector detector(withoutFloor());
    const auto spots =
        detector.detect(Picture(stream, 0.0).with(centre, 200.0).withBad(u, v, u + 1, v + 1, kNaN).view());
    ASSERT_EQ(spots.size(), 1u) << u << ", " << v;
    // The window is not quite of the spot's shape: half of the default centroid_floor.
    EXPECT_LT((spots[0].pixel - centre).norm(), 0.05) << u << ", " << v;
  }
}

TEST(SpotDetector, CentresOfSpotsWithABadPixelErrAsTheirCovarianceSays) {
  RandomStream stream(15);
  SpotDetector detector(withoutFloor());
  int seen = 0;
  double nees = 0.0;
  for (int i = 0; i < 400; ++i) {
    const Eigen::Vector2d centre(80.0 + stream.uniform(), 60.0 + stream.uniform());
    const auto spots =
        detector.detect(Picture(stream).with(centre, 200.0).withBad(81, 60, 82, 61, kNaN).view());
    for (const Spot& spot : spots) {
      const Eigen::Vector2d error = spot.pixel - centre;
      if (error.norm() > 3.0) continue;
      ++seen;
      nees += error.dot(spot.covariance.llt().solve(error)) / 2.0;
    }
  }
  EXPECT_GE(seen, 390);
  EXPECT_NEAR(nees / seen, 1.0, 4.0 / std::sqrt(double(seen)) + 0.1);
}

TEST(SpotDetector, PlainNoiseOnASlopeRoundBadPixelsHasNoSpots) {
  RandomStream stream(16);
  SpotDetector detector(withoutFloor());
  int spots = 0;
  for (int i = 0; i < 100; ++i) {
    Picture picture(stream);
    picture.withBad(0, 0, 50, 40, kNaN).withBad(100, 0, 101, kHeight, kInf).withBad(0, 90, kWidth, 92, kNaN);
    for (int k = 0; k < 40; ++k) {
      const int u = int(stream.uniform() * kWidth), v = int(stream.uniform() * kHeight);
      picture.withBad(u, v, u + 1, v + 1, kNaN);
    }
    spots += static_cast<int>(detector.detect(picture.view()).size());
  }
  EXPECT_LE(spots, 2);
}

TEST(SpotDetector, ASpotBesideABlockOfBadPixelsOnASlopeIsFound) {
  RandomStream stream(17);
  SpotDetector detector(withoutFloor());
  const Eigen::Vector2d centre(60.4, 60.2);
  for (int i = 0; i < 20; ++i) {
    const auto spots =
        detector.detect(Picture(stream).with(centre, 300.0).withBad(0, 0, 56, kHeight, kNaN).view());
    ASSERT_EQ(spots.size(), 1u);
    EXPECT_LT((spots[0].pixel - centre).norm(), 0.4);
  }
}

}  // namespace
}  // namespace sightline::core
