#include "sightline/core/imaging/pixel_mask.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

namespace sightline::core {
namespace {

constexpr float kLargest = 1e18F;  // grey levels; squares of these still fit into a float
constexpr float kInfinite = std::numeric_limits<float>::infinity();
constexpr double kSmoothGain = 0.140625;  // sum of the squares of the smoothing's weights
constexpr double kLeastRing = 12.0;       // pixels: three for the plane, and some more
constexpr double kLeastSpread = 1.0;      // [px^2] of the ring's pixels, in the direction of least
constexpr double kNoiseOfCross = 0.8;     // variance of a smoothed pixel over that of (S-89)'s difference

/// What a ring says of the pixel in its middle.
struct Plane {
  double level = 0.0;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  double level_variance = 0.0;  // over that of a pixel
};

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
  const auto width = static_cast<std::size_t>(width_);
  outer_.resize(width);
  inner_.resize(width);
  outer_before_.resize(width + 1);
  inner_before_.resize(width + 1);
  return {filled_.data(), width_, height_};
}

PixelMask::Box PixelMask::grown(const Box& box, int by) const {
  return {std::max(box.left - by, 0), std::max(box.top - by, 0), std::min(box.right + by, width_),
          std::min(box.bottom + by, height_)};
}

/// (S-105), smoothing.
void PixelMask::mendSmoothed(std::vector<float>& smoothed) {
  const Box box = grown(bad_box_, 1);
  for (int v = box.top; v < box.bottom; ++v) {
    for (int u = box.left; u < box.right; ++u) {
      bool has_bad = false;
      float weight = 0.0F, sum = 0.0F;
      // At the image's rim the pixels there count for those beyond, as everywhere in the detector.
      for (int dv = -1; dv <= 1; ++dv) {
        for (int du = -1; du <= 1; ++du) {
          const std::size_t there = at(std::clamp(u + du, 0, width_ - 1), std::clamp(v + dv, 0, height_ - 1));
          if (bad_[there] != 0) {
            has_bad = true;
            continue;
          }
          const float w = (du == 0 ? kSmoothMiddle : kSmoothSide) * (dv == 0 ? kSmoothMiddle : kSmoothSide);
          weight += w;
          sum += w * filled_[there];
        }
      }
      if (!has_bad) continue;
      const std::size_t here = at(u, v);
      whole_[here] = 0;
      part_[here] = weight;
      if (weight > 0.0F) smoothed[here] = sum / weight;
    }
  }
}

/// (S-105), background.
void PixelMask::mendContrast(const std::vector<float>& smoothed, std::vector<float>& contrast) {
  forRingsWithBad(smoothed, whole_, [&](int u, int v, const Sums& sums) {
    const std::size_t here = at(u, v);
    contrast[here] = 0.0F;
    growth_[here] = kInfinite;
    if (part_[here] < kLeastPart || sums(0) < kLeastRing) return;
    Eigen::Matrix3d A;
    A << sums(0), sums(1), sums(2), sums(1), sums(3), sums(4), sums(2), sums(4), sums(5);
    const Eigen::Vector3d b(sums(6), sums(7), sums(8));
    // The spread of a ring is that of its pixels about their middle.
    const Eigen::Vector2d middle(A(1, 0) / A(0, 0), A(2, 0) / A(0, 0));
    const Eigen::Matrix2d spread = A.bottomRightCorner<2, 2>() / A(0, 0) - middle * middle.transpose();
    if (!(spread.determinant() > kLeastSpread * spread.trace())) return;
    const Eigen::LDLT<Eigen::Matrix3d> factors(A);
    if (factors.info() != Eigen::Success || !factors.isPositive()) return;
    const Eigen::Vector3d fit = factors.solve(b);
    const Plane plane{fit(0), fit.tail<2>(), factors.solve(Eigen::Vector3d::UnitX())(0)};
    // Where pixels are missing, the middle of the smoothing lies aside.
    Eigen::Vector2d aside = Eigen::Vector2d::Zero();
    double squares = 0.0, weight = 0.0;
    for (int dv = -1; dv <= 1; ++dv) {
      for (int du = -1; du <= 1; ++du) {
        if (isBad(static_cast<int>(
                at(std::clamp(u + du, 0, width_ - 1), std::clamp(v + dv, 0, height_ - 1))))) {
          continue;
        }
        const double w = (du == 0 ? kSmoothMiddle : kSmoothSide) * (dv == 0 ? kSmoothMiddle : kSmoothSide);
        aside += w * Eigen::Vector2d(du, dv);
        squares += w * w;
        weight += w;
      }
    }
    aside /= weight;
    contrast[here] =
        static_cast<float>(static_cast<double>(smoothed[here]) - plane.level - plane.slope.dot(aside));
    growth_[here] = static_cast<float>((squares / (weight * weight) + plane.level_variance) / kSmoothGain);
  });
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
  forRingsWithBad(squares_, even_, [&](int u, int v, const Sums& sums) {
    noise[at(u, v)] = sums(0) < kLeastRing
                          ? kInfinite
                          : static_cast<float>(std::sqrt(kNoiseOfCross * std::max(sums(6) / sums(0), 0.0)));
  });
  for (std::size_t i = 0; i < noise.size(); ++i) {
    if (growth_[i] != 1.0F) noise[i] *= std::sqrt(growth_[i]);
  }
}

/// Every pixel in whose ring or at whose place there is one that is not good, with the sums over the good
/// ones; x and y from the pixel. Running sums over columns and a prefix sum along each row, as for means.
void PixelMask::forRingsWithBad(const std::vector<float>& plane, const std::vector<unsigned char>& good,
                                const std::function<void(int, int, const Sums&)>& visit) {
  std::fill(outer_.begin(), outer_.end(), Sums(Sums::Zero()));
  std::fill(inner_.begin(), inner_.end(), Sums(Sums::Zero()));
  const Box seen = grown(bad_box_, neighbourhood_ + kNoiseCross + 1);  // whose rings may have a bad one
  const Box summed = grown(seen, neighbourhood_);
  const double x0 = 0.5 * width_, y0 = 0.5 * height_;
  const auto addRow = [&](int v, double sign, std::vector<Sums>& sums) {
    const double y = v - y0;
    for (int u = summed.left; u < summed.right; ++u) {
      if (good[at(u, v)] == 0) continue;
      const double x = u - x0, value = static_cast<double>(plane[at(u, v)]);
      Sums one;
      one << 1.0, x, y, x * x, x * y, y * y, value, x * value, y * value;
      sums[static_cast<std::size_t>(u)] += sign * one;
    }
  };
  struct Rows {
    int begin, end;
  } outer_rows{summed.top, summed.top}, inner_rows{summed.top, summed.top};
  const auto moveTo = [&](Rows& rows, std::vector<Sums>& sums, int v, int half) {
    while (rows.end < std::min(v + half + 1, height_)) addRow(rows.end++, 1.0, sums);
    while (rows.begin < v - half) addRow(rows.begin++, -1.0, sums);
  };
  const auto first = static_cast<std::size_t>(summed.left), last = static_cast<std::size_t>(summed.right);
  outer_before_[first].setZero();
  inner_before_[first].setZero();
  for (int v = seen.top; v < seen.bottom; ++v) {
    moveTo(outer_rows, outer_, v, neighbourhood_);
    moveTo(inner_rows, inner_, v, guard_);
    for (std::size_t u = first; u < last; ++u) {
      outer_before_[u + 1] = outer_before_[u] + outer_[u];
      inner_before_[u + 1] = inner_before_[u] + inner_[u];
    }
    const int rows = outer_rows.end - outer_rows.begin;
    for (int u = seen.left; u < seen.right; ++u) {
      const auto left = static_cast<std::size_t>(std::max(u - neighbourhood_, 0));
      const auto right = static_cast<std::size_t>(std::min(u + neighbourhood_ + 1, width_));
      const Sums all = outer_before_[right] - outer_before_[left];
      if (all(0) > rows * static_cast<double>(right - left) - 0.5) continue;
      const Sums sums = all - inner_before_[static_cast<std::size_t>(std::min(u + guard_ + 1, width_))] +
                        inner_before_[static_cast<std::size_t>(std::max(u - guard_, 0))];
      const double x = u - x0, y = v - y0;
      Sums from_here = sums;
      from_here(1) -= x * sums(0);
      from_here(2) -= y * sums(0);
      from_here(3) += x * (x * sums(0) - 2.0 * sums(1));
      from_here(4) += x * y * sums(0) - y * sums(1) - x * sums(2);
      from_here(5) += y * (y * sums(0) - 2.0 * sums(2));
      from_here(7) -= x * sums(6);
      from_here(8) -= y * sums(6);
      visit(u, v, from_here);
    }
  }
}

}  // namespace sightline::core
