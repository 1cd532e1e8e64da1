#include "sightline/core/imaging/pixel_mask.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sightline::core {
namespace {

constexpr float kLargest = 1e18F;  // grey levels; squares of these still fit into a float
constexpr float kInfiniteGrowth = std::numeric_limits<float>::infinity();
constexpr double kLeastRing = 12.0;    // pixels: three for the plane, and some more
constexpr double kLeastSpread = 1.0;   // [px^2] of the ring's pixels, in the direction of least
constexpr double kNoiseOfCross = 0.8;  // variance of a smoothed pixel over that of (S-89)'s difference

}  // namespace

GreyImage PixelMask::apply(const GreyImage& image) {
  width_ = image.width;
  height_ = image.height;
  const auto size = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  count_ = 0;
  for (std::size_t i = 0; i < size; ++i) count_ += std::abs(image.pixels[i]) < kLargest ? 0 : 1;
  if (count_ == 0) return image;
  bad_.assign(size, 0);
  filled_.assign(image.pixels, image.pixels + size);
  bad_box_ = {width_, height_, 0, 0};
  double sum = 0.0;
  for (int v = 0; v < height_; ++v) {
    for (int u = 0; u < width_; ++u) {
      const float value = filled_[at(u, v)];
      if (std::abs(value) < kLargest) {
        sum += static_cast<double>(value);
        continue;
      }
      bad_[at(u, v)] = 1;
      bad_box_ = {std::min(bad_box_.left, u), std::min(bad_box_.top, v), std::max(bad_box_.right, u + 1),
                  std::max(bad_box_.bottom, v + 1)};
    }
  }
  const auto good = static_cast<double>(size) - count_;
  const auto mean = static_cast<float>(good > 0.0 ? sum / good : 0.0);
  for (std::size_t i = 0; i < size; ++i) {
    if (bad_[i] != 0) filled_[i] = mean;
  }
  whole_.assign(size, 1);
  part_.assign(size, 1.0F);
  growth_.assign(size, 1.0F);
  return {filled_.data(), width_, height_};
}

PixelMask::Box PixelMask::grown(const Box& box, int by) const {
  return {std::max(box.left - by, 0), std::max(box.top - by, 0), std::min(box.right + by, width_),
          std::min(box.bottom + by, height_)};
}

/// (S-105), smoothing. At the image's rim the pixels there count for those beyond, as everywhere in the
/// detector.
void PixelMask::mendSmoothed(std::vector<float>& smoothed) {
  for (int v = bad_box_.top; v < bad_box_.bottom; ++v) {
    for (int u = bad_box_.left; u < bad_box_.right; ++u) {
      if (bad_[at(u, v)] == 0) continue;
      for (int y = std::max(v - 1, 0); y <= std::min(v + 1, height_ - 1); ++y)
        for (int x = std::max(u - 1, 0); x <= std::min(u + 1, width_ - 1); ++x) whole_[at(x, y)] = 0;
    }
  }
  const Box box = grown(bad_box_, 1);
  for (int v = box.top; v < box.bottom; ++v) {
    for (int u = box.left; u < box.right; ++u) {
      const std::size_t here = at(u, v);
      if (whole_[here] != 0) continue;
      float weight = 0.0F, sum = 0.0F;
      for (int dv = -1; dv <= 1; ++dv) {
        for (int du = -1; du <= 1; ++du) {
          const std::size_t there = at(std::clamp(u + du, 0, width_ - 1), std::clamp(v + dv, 0, height_ - 1));
          if (bad_[there] != 0) continue;
          const float w = (du == 0 ? kSmoothMiddle : kSmoothSide) * (dv == 0 ? kSmoothMiddle : kSmoothSide);
          weight += w;
          sum += w * filled_[there];
        }
      }
      part_[here] = weight;
      if (weight > 0.0F) smoothed[here] = sum / weight;
    }
  }
}

/// (S-105), background: by sums about the middle of the ring's good pixels, where the plane's level and slope
/// do not depend on each other.
void PixelMask::mendContrast(const std::vector<float>& smoothed, std::vector<float>& contrast) {
  forRingsWithBad(plane_columns_, smoothed, whole_, [&](int u, int v, const Sums<kPlane>& sums) {
    const std::size_t here = at(u, v);
    contrast[here] = 0.0F;
    growth_[here] = kInfiniteGrowth;
    const double count = sums(0);
    if (part_[here] < kLeastPart || count < kLeastRing) return;
    const double mean = sums(1) / count, x = sums(2) / count, y = sums(3) / count;
    const double xx = sums(4) / count - x * x, xy = sums(5) / count - x * y, yy = sums(6) / count - y * y;
    const double determinant = xx * yy - xy * xy;
    if (!(determinant > kLeastSpread * (xx + yy))) return;
    const double along_x = sums(7) / count - x * mean, along_y = sums(8) / count - y * mean;
    const double slope_x = (yy * along_x - xy * along_y) / determinant;
    const double slope_y = (xx * along_y - xy * along_x) / determinant;
    const double level = mean - slope_x * x - slope_y * y;
    const double level_variance = (1.0 + (yy * x * x - 2.0 * xy * x * y + xx * y * y) / determinant) / count;
    const Smoothing smoothing = whole_[here] != 0 ? Smoothing{} : smoothingAt(u, v);
    contrast[here] = static_cast<float>(static_cast<double>(smoothed[here]) - level -
                                        slope_x * smoothing.aside_x - slope_y * smoothing.aside_y);
    growth_[here] = static_cast<float>((smoothing.squares + level_variance) / kSmoothGain);
  });
}

/// Of the good pixels in the smoothing's square.
PixelMask::Smoothing PixelMask::smoothingAt(int u, int v) const {
  Smoothing smoothing{0.0, 0.0, 0.0};
  double weight = 0.0;
  for (int dv = -1; dv <= 1; ++dv) {
    for (int du = -1; du <= 1; ++du) {
      const std::size_t there = at(std::clamp(u + du, 0, width_ - 1), std::clamp(v + dv, 0, height_ - 1));
      if (bad_[there] != 0) continue;
      const double w = (du == 0 ? kSmoothMiddle : kSmoothSide) * (dv == 0 ? kSmoothMiddle : kSmoothSide);
      smoothing.aside_x += w * du;
      smoothing.aside_y += w * dv;
      smoothing.squares += w * w;
      weight += w;
    }
  }
  return {smoothing.aside_x / weight, smoothing.aside_y / weight, smoothing.squares / (weight * weight)};
}

/// (S-105), noise.
void PixelMask::mendNoise(const std::vector<float>& rough, std::vector<float>& noise) {
  even_.resize(whole_.size());
  for (int v = 0; v < height_; ++v) {
    const int above = v >= kNoiseCross ? v - kNoiseCross : std::min(v + kNoiseCross, height_ - 1);
    const int below = v + kNoiseCross < height_ ? v + kNoiseCross : std::max(v - kNoiseCross, 0);
    for (int u = 0; u < width_; ++u) {
      const int left = u >= kNoiseCross ? u - kNoiseCross : std::min(u + kNoiseCross, width_ - 1);
      const int right = u + kNoiseCross < width_ ? u + kNoiseCross : std::max(u - kNoiseCross, 0);
      const bool is_even = whole_[at(u, v)] != 0 && whole_[at(u, above)] != 0 && whole_[at(u, below)] != 0 &&
                           whole_[at(left, v)] != 0 && whole_[at(right, v)] != 0;
      even_[at(u, v)] = is_even ? 1 : 0;
    }
  }
  squares_.resize(rough.size());
  std::transform(rough.begin(), rough.end(), squares_.begin(), [](float value) { return value * value; });
  forRingsWithBad(mean_columns_, squares_, even_, [&](int u, int v, const Sums<kMean>& sums) {
    noise[at(u, v)] = sums(0) < kLeastRing
                          ? kInfiniteGrowth
                          : static_cast<float>(std::sqrt(kNoiseOfCross * std::max(sums(1) / sums(0), 0.0)));
  });
  for (std::size_t i = 0; i < noise.size(); ++i) {
    if (growth_[i] != 1.0F) noise[i] *= std::sqrt(growth_[i]);
  }
}

/// Every pixel in whose square there is one that is not good, with the sums over the good ones of its ring; x
/// and y from the pixel. Running sums over columns and a prefix sum along each row, as for means.
template <int kSize, typename Visit>
void PixelMask::forRingsWithBad(Columns<kSize>& columns, const std::vector<float>& plane,
                                const std::vector<unsigned char>& good, const Visit& visit) {
  const auto width = static_cast<std::size_t>(width_);
  columns.outer.assign(width, Sums<kSize>(Sums<kSize>::Zero()));
  columns.inner.assign(width, Sums<kSize>(Sums<kSize>::Zero()));
  columns.outer_before.resize(width + 1);
  columns.inner_before.resize(width + 1);
  const Box seen = grown(bad_box_, neighbourhood_ + kNoiseCross + 1);  // whose rings may have a bad one
  const Box summed = grown(seen, neighbourhood_);
  const double x0 = 0.5 * width_, y0 = 0.5 * height_;
  const auto addRow = [&](int v, double sign, std::vector<Sums<kSize>>& sums) {
    const double y = v - y0;
    for (int u = summed.left; u < summed.right; ++u) {
      if (good[at(u, v)] == 0) continue;
      const double x = u - x0, value = static_cast<double>(plane[at(u, v)]);
      Sums<kSize> one;
      if constexpr (kSize == kPlane) {
        one << 1.0, value, x, y, x * x, x * y, y * y, x * value, y * value, 0.0;
      } else {
        one << 1.0, value;
      }
      sums[static_cast<std::size_t>(u)] += sign * one;
    }
  };
  struct Rows {
    int begin, end;
  } outer_rows{summed.top, summed.top}, inner_rows{summed.top, summed.top};
  const auto moveTo = [&](Rows& rows, std::vector<Sums<kSize>>& sums, int v, int half) {
    while (rows.end < std::min(v + half + 1, height_)) addRow(rows.end++, 1.0, sums);
    while (rows.begin < v - half) addRow(rows.begin++, -1.0, sums);
  };
  const auto first = static_cast<std::size_t>(summed.left), last = static_cast<std::size_t>(summed.right);
  columns.outer_before[first].setZero();
  columns.inner_before[first].setZero();
  for (int v = seen.top; v < seen.bottom; ++v) {
    moveTo(outer_rows, columns.outer, v, neighbourhood_);
    moveTo(inner_rows, columns.inner, v, guard_);
    for (std::size_t u = first; u < last; ++u) {
      columns.outer_before[u + 1] = columns.outer_before[u] + columns.outer[u];
      columns.inner_before[u + 1] = columns.inner_before[u] + columns.inner[u];
    }
    const int rows = outer_rows.end - outer_rows.begin;
    for (int u = seen.left; u < seen.right; ++u) {
      const auto left = static_cast<std::size_t>(std::max(u - neighbourhood_, 0));
      const auto right = static_cast<std::size_t>(std::min(u + neighbourhood_ + 1, width_));
      Sums<kSize> sums = columns.outer_before[right] - columns.outer_before[left];
      if (sums(0) > rows * static_cast<double>(right - left) - 0.5) continue;
      sums -= columns.inner_before[static_cast<std::size_t>(std::min(u + guard_ + 1, width_))] -
              columns.inner_before[static_cast<std::size_t>(std::max(u - guard_, 0))];
      if constexpr (kSize == kPlane) {  // from the pixel, of sums from the image's middle
        const double x = u - x0, y = v - y0;
        sums(4) += x * (x * sums(0) - 2.0 * sums(2));
        sums(5) += x * y * sums(0) - y * sums(2) - x * sums(3);
        sums(6) += y * (y * sums(0) - 2.0 * sums(3));
        sums(2) -= x * sums(0);
        sums(3) -= y * sums(0);
        sums(7) -= x * sums(1);
        sums(8) -= y * sums(1);
      }
      visit(u, v, sums);
    }
  }
}

}  // namespace sightline::core
