#pragma once

#include <vector>

#include <Eigen/Core>

#include "sightline/core/imaging/grey_image.h"

namespace sightline::core {

/// Smoothing by [1 2 1] / 4 in both directions: near enough to the image of a point in most cameras.
inline constexpr float kSmoothSide = 0.25F, kSmoothMiddle = 0.5F;

/// Distance of the four pixels that the noise is measured against (S-89) [px].
inline constexpr int kNoiseCross = 4;

/// The bad pixels of an image: NaN, infinite, or beyond 1e18 in size. It mends the planes of the spot
/// detector near them, so that they show what they would without the bad pixels (S-105); far from them
/// nothing changes.
class PixelMask {
 public:
  /// The square round a pixel whose rest is its background: half widths [px], guard < neighbourhood.
  PixelMask(int guard, int neighbourhood) : guard_(guard), neighbourhood_(neighbourhood) {}

  /// Looks for bad pixels. The same image when there is none; else a copy, valid until the next call, in
  /// which they have the mean of the good ones.
  GreyImage apply(const GreyImage& image);

  int count() const { return count_; }  ///< bad pixels of the image
  bool isBad(int pixel) const { return count_ > 0 && bad_[static_cast<std::size_t>(pixel)] != 0; }

  /// Whether contrast is known at a pixel: at least half of what it is smoothed from is good.
  bool isKnown(std::size_t pixel) const { return count_ == 0 || part_[pixel] >= kLeastPart; }

  /// Smoothed pixels next to bad ones: from the good ones alone.
  void mendSmoothed(std::vector<float>& smoothed);

  /// Contrast of pixels whose background has bad ones: what is above the plane fitted to the good ones, 0
  /// where it is not known.
  void mendContrast(const std::vector<float>& smoothed, std::vector<float>& contrast);

  /// Noise of the contrast at pixels near bad ones, from what `rough` has that no bad pixel is part of;
  /// infinite where it is not known.
  void mendNoise(const std::vector<float>& rough, std::vector<float>& noise);

 private:
  static constexpr float kLeastPart = 0.5F;
  static constexpr double kSmoothGain = 0.140625;  // sum of the squares of the smoothing's weights

  /// Sums over the good pixels of a ring: count and value, or beyond these x, y, xx, xy, yy, x value, y value
  /// (and a place that is not used).
  template <int kSize>
  using Sums = Eigen::Array<double, kSize, 1>;
  static constexpr int kMean = 2, kPlane = 10;

  /// Running sums over the columns of the image, and those before each column in its row.
  template <int kSize>
  struct Columns {
    std::vector<Sums<kSize>> outer, inner, outer_before, inner_before;
  };

  /// Columns and rows from the first to before the last.
  struct Box {
    int left = 0, top = 0, right = 0, bottom = 0;
  };

  /// A smoothed pixel: its centre aside of the pixel [px], and the sum of the squares of its weights.
  struct Smoothing {
    double aside_x = 0.0, aside_y = 0.0, squares = kSmoothGain;
  };

  Smoothing smoothingAt(int u, int v) const;
  Box grown(const Box& box, int by) const;  // within the image
  template <int kSize, typename Visit>
  void forRingsWithBad(Columns<kSize>& columns, const std::vector<float>& plane,
                       const std::vector<unsigned char>& good, const Visit& visit);
  std::size_t at(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(u);
  }

  int guard_, neighbourhood_;
  int width_ = 0, height_ = 0;
  int count_ = 0;
  Box bad_box_;  // round all bad pixels
  std::vector<float> filled_;
  std::vector<unsigned char> bad_;           // pixels
  std::vector<unsigned char> whole_, even_;  // smoothed pixels, and differences, without a bad part
  std::vector<float> part_;                  // of the weights of a smoothed pixel that is on good ones
  std::vector<float> growth_;                // of the contrast's noise variance by what is missing
  std::vector<float> squares_;               // of the differences
  Columns<kMean> mean_columns_;
  Columns<kPlane> plane_columns_;
};

}  // namespace sightline::core
