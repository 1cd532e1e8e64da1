#include "sightline/core/imaging/spot_detector.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace sightline::core {
namespace {

constexpr float kSide = kSmoothSide, kMiddle = kSmoothMiddle;
constexpr double kAreaAtHalf =
    4.355172180607204;                    // 2 pi ln 2: area of a Gaussian of sigma 1 above half of it
constexpr double kNarrowestWindow = 0.8;  // sigma [px]
constexpr int kCentroidSteps = 20;
constexpr double kCentroidDone = 1e-4;        // [px]
constexpr double kLongestCentroidStep = 0.5;  // [px]
constexpr float kSlowLearning = 0.1F;         // of pixels in which a target is seen, against the others

constexpr int kCross = kNoiseCross;                // [px]
constexpr unsigned char kNearBlob = 1, kBlob = 2;  // marks of pixels already looked at

}  // namespace

bool SpotDetector::isReady() const {
  return params_.background == SpotDetectorParams::Background::spatial || frames_ > params_.warm_up;
}

const std::vector<Spot>& SpotDetector::detect(const GreyImage& image) {
  resize(image);
  spots_.clear();
  image_ = mask_.apply(image).pixels;
  smooth();
  if (mask_.count() > 0) mask_.mendSmoothed(smoothed_);
  removeNeighbourhood();
  if (mask_.count() > 0) mask_.mendContrast(smoothed_, contrast_);
  measureNoise();
  if (mask_.count() > 0) mask_.mendNoise(rough_, noise_);
  std::fill(taken_.begin(), taken_.end(), 0);
  if (params_.background == SpotDetectorParams::Background::spatial || frames_ >= params_.warm_up) {
    findPeaks();
    takeSpots();
  }
  learn();
  return spots_;
}

void SpotDetector::resize(const GreyImage& image) {
  if (image.width == width_ && image.height == height_) return;
  width_ = image.width;
  height_ = image.height;
  frames_ = 0;
  const auto size = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  for (auto* plane : {&mean_, &smoothed_, &contrast_, &rough_, &noise_}) plane->assign(size, 0.0F);
  taken_.assign(size, 0);
  row_.assign(static_cast<std::size_t>(width_), 0.0F);
  column_sums_.assign(2 * static_cast<std::size_t>(width_), 0.0);
  prefix_.assign(2 * static_cast<std::size_t>(width_ + 1), 0.0);
}

void SpotDetector::smooth() {
  for (int v = 0; v < height_; ++v) {
    const float* middle = image_ + at(0, v);
    const float* above = image_ + at(0, std::max(v - 1, 0));
    const float* below = image_ + at(0, std::min(v + 1, height_ - 1));
    float* const row = row_.data();
    for (int u = 0; u < width_; ++u) row[u] = kSide * (above[u] + below[u]) + kMiddle * middle[u];
    float* const out = &smoothed_[static_cast<std::size_t>(at(0, v))];
    out[0] = kSide * (row[0] + row[std::min(1, width_ - 1)]) + kMiddle * row[0];
    for (int u = 1; u + 1 < width_; ++u) out[u] = kSide * (row[u - 1] + row[u + 1]) + kMiddle * row[u];
    if (width_ > 1) {
      const int last = width_ - 1;
      out[last] = kSide * (row[last - 1] + row[last]) + kMiddle * row[last];
    }
  }
}

/// (S-89), contrast.
void SpotDetector::removeNeighbourhood() {
  ringMeans(smoothed_, noise_, [](float value) { return static_cast<double>(value); });
  for (std::size_t i = 0; i < contrast_.size(); ++i) contrast_[i] = smoothed_[i] - noise_[i];
}

/// (S-89): the noise is what is left when four pixels at kCross round each are taken off it: slopes cancel,
/// and edges and spots do not reach far. Five fourths of the smoothed image's variance, for noise that is
/// independent over kCross.
void SpotDetector::measureNoise() {
  for (int v = 0; v < height_; ++v) {
    const float* const middle = &smoothed_[static_cast<std::size_t>(at(0, v))];
    const float* const above = &smoothed_[static_cast<std::size_t>(
        at(0, v >= kCross ? v - kCross : std::min(v + kCross, height_ - 1)))];
    const float* const below = &smoothed_[static_cast<std::size_t>(
        at(0, v + kCross < height_ ? v + kCross : std::max(v - kCross, 0)))];
    float* const out = &rough_[static_cast<std::size_t>(at(0, v))];
    for (int u = 0; u < width_; ++u) {
      const float left = middle[u >= kCross ? u - kCross : std::min(u + kCross, width_ - 1)];
      const float right = middle[u + kCross < width_ ? u + kCross : std::max(u - kCross, 0)];
      out[u] = middle[u] - 0.25F * (above[u] + below[u] + left + right);
    }
  }
  ringMeans(rough_, noise_, [](float value) { return static_cast<double>(value) * value; });
  for (float& noise : noise_) noise = std::sqrt(0.8F * std::max(noise, 0.0F));
}

/// Mean of a function of the pixels in the ring between guard and neighbourhood round each pixel, by running
/// sums over columns and a prefix sum along each row. Towards the image's rim the ring shrinks on both sides
/// alike, so that slopes cancel there too.
template <typename Function>
void SpotDetector::ringMeans(const std::vector<float>& plane, std::vector<float>& means,
                             const Function& function) {
  const auto width = static_cast<std::size_t>(width_);
  std::fill(column_sums_.begin(), column_sums_.end(), 0.0);
  const auto addRow = [&](int v, double sign, double* sums) {
    const float* const row = &plane[static_cast<std::size_t>(at(0, v))];
    for (std::size_t u = 0; u < width; ++u) sums[u] += sign * function(row[u]);
  };
  struct Rows {
    double* sums = nullptr;
    int begin = 0, end = 0;
  } outer{column_sums_.data()}, inner{column_sums_.data() + width};
  const auto moveTo = [&](Rows& rows, int v, int half) {
    while (rows.end < v + half + 1) addRow(rows.end++, 1.0, rows.sums);
    while (rows.begin < v - half) addRow(rows.begin++, -1.0, rows.sums);
  };
  double* const P = prefix_.data();  // outer and inner side by side
  for (int v = 0; v < height_; ++v) {
    const int far_v = std::min({params_.neighbourhood, v, height_ - 1 - v}),
              near_v = std::min(params_.guard, far_v);
    moveTo(outer, v, far_v);
    moveTo(inner, v, near_v);
    for (std::size_t u = 0; u < width; ++u) {
      P[2 * u + 2] = P[2 * u] + outer.sums[u];
      P[2 * u + 3] = P[2 * u + 1] + inner.sums[u];
    }
    const float* const here = &plane[static_cast<std::size_t>(at(0, v))];
    float* const out = &means[static_cast<std::size_t>(at(0, v))];
    for (std::ptrdiff_t u = 0; u < width_; ++u) {
      const auto far_u = std::min({std::ptrdiff_t{params_.neighbourhood}, u, width_ - 1 - u}),
                 near_u = std::min(std::ptrdiff_t{params_.guard}, far_u);
      const auto count = (2 * far_v + 1) * (2 * far_u + 1) - (2 * near_v + 1) * (2 * near_u + 1);
      const double sum =
          P[2 * (u + far_u + 1)] - P[2 * (u - far_u)] - P[2 * (u + near_u + 1) + 1] + P[2 * (u - near_u) + 1];
      // In the corners nothing is left of the ring: no contrast.
      out[u] = count > 0 ? static_cast<float>(sum / count) : static_cast<float>(function(here[u]));
    }
  }
}

/// (S-89): pixels above the threshold in units of the local noise (CFAR, Finn and Johnson 1968).
void SpotDetector::findPeaks() {
  using Polarity = SpotDetectorParams::Polarity;
  peaks_.clear();
  const auto threshold = static_cast<float>(params_.threshold);
  const auto least = static_cast<float>(params_.min_contrast);
  const float sign_of_bright = params_.polarity == Polarity::dark ? 0.0F : 1.0F;
  const float sign_of_dark = params_.polarity == Polarity::bright ? 0.0F : -1.0F;
  for (int v = 1; v + 1 < height_; ++v) {
    for (int u = 1; u + 1 < width_; ++u) {
      const auto i = static_cast<std::size_t>(at(u, v));
      const float strength = std::max(sign_of_bright * contrast_[i], sign_of_dark * contrast_[i]);
      if (strength < least || strength <= threshold * noise_[i] || !isPeak(u, v) || isOld(i)) continue;
      peaks_.push_back({u, v, strength / std::max(noise_[i], 1e-6F)});
    }
  }
  std::sort(peaks_.begin(), peaks_.end(), [this](const Peak& a, const Peak& b) {
    return a.strength != b.strength ? a.strength > b.strength : at(a.u, a.v) < at(b.u, b.v);
  });
}

/// (S-89): whether at least half of the contrast has been there before.
bool SpotDetector::isOld(std::size_t pixel) const {
  if (params_.background == SpotDetectorParams::Background::spatial) return false;
  return std::abs(contrast_[pixel] - mean_[pixel]) < 0.5F * std::abs(contrast_[pixel]);
}

/// Whether no neighbour has more contrast of the same sign; of equal ones the first has it.
bool SpotDetector::isPeak(int u, int v) const {
  const int here = at(u, v);
  const float sign = contrast_[static_cast<std::size_t>(here)] < 0.0F ? -1.0F : 1.0F;
  const float value = sign * contrast_[static_cast<std::size_t>(here)];
  for (int dv = -1; dv <= 1; ++dv) {
    for (int du = -1; du <= 1; ++du) {
      const int there = at(u + du, v + dv);
      const float other = sign * contrast_[static_cast<std::size_t>(there)];
      if (other > value || (other == value && there < here)) return false;
    }
  }
  return true;
}

void SpotDetector::takeSpots() {
  for (const Peak& peak : peaks_) {
    if (static_cast<int>(spots_.size()) >= params_.max_spots) return;
    if (taken_[static_cast<std::size_t>(at(peak.u, peak.v))] != 0) continue;
    const Blob blob = grow(peak);
    if (blob.is_small) spots_.push_back(locate(peak, blob));
  }
}

/// Takes the connected pixels with at least half of the peak's contrast; up to the largest size of a spot,
/// and round it one guard wide, so that no other peak in there counts as a spot of its own.
SpotDetector::Blob SpotDetector::grow(const Peak& peak) {
  const float half = 0.5F * contrast_[static_cast<std::size_t>(at(peak.u, peak.v))];
  const float sign = half < 0.0F ? -1.0F : 1.0F;
  Blob blob;
  int left = peak.u, right = peak.u, top = peak.v, bottom = peak.v;
  front_.assign(1, at(peak.u, peak.v));
  taken_[static_cast<std::size_t>(front_[0])] = kBlob;
  const int reach = 2 * params_.max_size;
  for (std::size_t next = 0; next < front_.size(); ++next) {
    const int u = front_[next] % width_, v = front_[next] / width_;
    left = std::min(left, u), right = std::max(right, u), top = std::min(top, v),
    bottom = std::max(bottom, v);
    for (int y = std::max(v - 1, 0); y <= std::min(v + 1, height_ - 1); ++y) {
      for (int x = std::max(u - 1, 0); x <= std::min(u + 1, width_ - 1); ++x) {
        const auto i = static_cast<std::size_t>(at(x, y));
        if (taken_[i] == kBlob || sign * contrast_[i] < sign * half) continue;
        if (std::abs(x - peak.u) > reach || std::abs(y - peak.v) > reach) continue;
        taken_[i] = kBlob;
        front_.push_back(at(x, y));
      }
    }
  }
  blob.area = static_cast<int>(front_.size());
  blob.is_small = right - left < params_.max_size && bottom - top < params_.max_size;
  if (!blob.is_small) return blob;
  for (int y = std::max(top - params_.guard, 0); y <= std::min(bottom + params_.guard, height_ - 1); ++y) {
    for (int x = std::max(left - params_.guard, 0); x <= std::min(right + params_.guard, width_ - 1); ++x) {
      unsigned char& taken = taken_[static_cast<std::size_t>(at(x, y))];
      taken = std::max(taken, kNearBlob);
    }
  }
  return blob;
}

/// (S-90): a plane fitted to the ring between guard and neighbourhood, and the variance left there.
SpotDetector::Patch SpotDetector::patchAround(int u, int v) const {
  const int far = params_.neighbourhood, near = params_.guard;
  const double origin = image_[at(u, v)];
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double squares = 0.0;
  for (int y = std::max(v - far, 0); y <= std::min(v + far, height_ - 1); ++y) {
    for (int x = std::max(u - far, 0); x <= std::min(u + far, width_ - 1); ++x) {
      if ((std::abs(x - u) <= near && std::abs(y - v) <= near) || mask_.isBad(at(x, y))) continue;
      const Eigen::Vector3d terms(1.0, x - u, y - v);
      const double value = image_[at(x, y)] - origin;
      A += terms * terms.transpose();
      b += value * terms;
      squares += value * value;
    }
  }
  const Eigen::LDLT<Eigen::Matrix3d> factors(A);
  Patch patch;
  patch.plane = factors.info() == Eigen::Success && factors.isPositive() ? Eigen::Vector3d(factors.solve(b))
                                                                         : Eigen::Vector3d::Zero();
  patch.variance = std::max(squares - patch.plane.dot(b), 0.0) / std::max(A(0, 0) - 3.0, 1.0);
  patch.plane(0) += origin;
  return patch;
}

/// (S-90): the centre c of a Gaussian window in which the spot is balanced: F(c) = sum w (x - c) d(x) = 0, w
/// as wide as the spot, d the contrast. Its covariance is that of any such estimate: G^-1 V G^-T with G =
/// dF/dc and V = variance of F from the noise of the pixels, sigma^2 sum w^2 (x - c)(x - c)'. A bad pixel has
/// the contrast that the others lead one to expect of a spot of the window's shape (S-105).
Spot SpotDetector::locate(const Peak& peak, const Blob& blob) const {
  const Patch patch = patchAround(peak.u, peak.v);
  const double width = std::max(std::sqrt(blob.area / kAreaAtHalf), kNarrowestWindow);
  const int reach = std::min(static_cast<int>(std::ceil(3.0 * width)) + 1, params_.neighbourhood);
  Spot spot;
  spot.contrast = contrast_[static_cast<std::size_t>(at(peak.u, peak.v))];
  spot.area = blob.area;
  const Eigen::Vector2d start(peak.u, peak.v);
  Eigen::Vector2d centre = start;
  Eigen::Matrix2d G = Eigen::Matrix2d::Identity(), V = Eigen::Matrix2d::Zero();
  double signal = 0.0, window_power = 0.0, missing_power = 0.0;
  bool is_balanced = false;
  const auto window = [&](int x, int y) {
    return std::exp(-0.5 * (Eigen::Vector2d(x, y) - centre).squaredNorm() / (width * width));
  };
  for (int step = 0; step < kCentroidSteps && !is_balanced; ++step) {
    Eigen::Vector2d F = Eigen::Vector2d::Zero();
    G.setZero(), V.setZero();
    signal = window_power = missing_power = 0.0;
    for (int y = std::max(peak.v - reach, 0); y <= std::min(peak.v + reach, height_ - 1); ++y) {
      for (int x = std::max(peak.u - reach, 0); x <= std::min(peak.u + reach, width_ - 1); ++x) {
        if (mask_.isBad(at(x, y))) continue;
        const Eigen::Vector2d from_centre = Eigen::Vector2d(x, y) - centre;
        const double w = window(x, y);
        const double d = image_[at(x, y)] - patch.plane.dot(Eigen::Vector3d(1.0, x - peak.u, y - peak.v));
        F += w * d * from_centre;
        G += w * d * (from_centre * from_centre.transpose() / (width * width) - Eigen::Matrix2d::Identity());
        V += w * w * from_centre * from_centre.transpose();
        signal += w * d;
        window_power += w * w;
      }
    }
    const double amplitude = signal / window_power;
    double shown = signal;  // by good pixels and bad ones
    if (mask_.count() > 0) {
      for (int y = std::max(peak.v - reach, 0); y <= std::min(peak.v + reach, height_ - 1); ++y) {
        for (int x = std::max(peak.u - reach, 0); x <= std::min(peak.u + reach, width_ - 1); ++x) {
          if (!mask_.isBad(at(x, y))) continue;
          const Eigen::Vector2d from_centre = Eigen::Vector2d(x, y) - centre;
          const double w2 = std::pow(window(x, y), 2);
          F += amplitude * w2 * from_centre;
          G += amplitude * w2 *
               (2.0 * from_centre * from_centre.transpose() / (width * width) - Eigen::Matrix2d::Identity());
          missing_power += w2;
        }
      }
      if (missing_power > window_power) break;  // most of the spot is not seen
      shown += amplitude * missing_power;
    }
    // A spot bends F downhill: -G / signal is positive definite. Where it is not, the window sees something
    // else.
    const Eigen::Matrix2d slope = -G / shown;
    if (!(slope.determinant() > 1e-3) || !(slope.trace() > 0.0)) break;
    Eigen::Vector2d move = slope.inverse() * F / shown;
    if (move.norm() > kLongestCentroidStep) move *= kLongestCentroidStep / move.norm();
    is_balanced = move.norm() < kCentroidDone;
    if (!is_balanced) centre += move;
    if ((centre - start).norm() > reach) break;
  }
  const double noise = std::max(patch.variance, 1e-12);
  const double floor = params_.centroid_floor * params_.centroid_floor;
  spot.snr = std::abs(signal) / std::sqrt(noise * window_power);
  if (is_balanced) {
    const Eigen::Matrix2d G_inverse = G.inverse();  // `slope` had a positive determinant
    spot.pixel = centre;
    spot.covariance = noise * G_inverse * V * G_inverse.transpose() + floor * Eigen::Matrix2d::Identity();
  } else {  // the peak's pixel, known to the size of the spot
    spot.pixel = start;
    spot.covariance = (width * width + floor) * Eigen::Matrix2d::Identity();
  }
  spot.covariance = 0.5 * (spot.covariance + spot.covariance.transpose()).eval();
  return spot;
}

/// (S-89), still background.
void SpotDetector::learn() {
  ++frames_;
  if (params_.background == SpotDetectorParams::Background::spatial) return;
  const float rate = 1.0F / static_cast<float>(std::min(frames_, params_.memory));
  for (std::size_t i = 0; i < contrast_.size(); ++i) {
    if (!mask_.isKnown(i)) continue;
    const float share = taken_[i] == kBlob ? kSlowLearning * rate : rate;
    mean_[i] += share * (contrast_[i] - mean_[i]);
  }
}

}  // namespace sightline::core
