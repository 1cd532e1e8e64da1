#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/imaging/grey_image.h"
#include "sightline/core/imaging/pixel_mask.h"

namespace sightline::core {

struct SpotDetectorParams {
  /// What is taken for the background of a pixel: its neighbourhood alone, or also its own past. `temporal`
  /// is for cameras that stand still: what stands still with them is no target.
  enum class Background { spatial, temporal };
  enum class Polarity { bright, dark, both };

  Background background = Background::spatial;
  Polarity polarity = Polarity::bright;
  /// Smallest contrast, in standard deviations of the noise around the spot, > 0. In plain noise 6 is enough
  /// (a false spot in thousands of images); clouds and trees are not plain noise.
  double threshold = 12.0;
  double min_contrast = 2.0;    ///< smallest contrast [grey levels], >= 0: against images without noise
  int guard = 6;                ///< half width of the square that a spot may fill [px], >= 1
  int neighbourhood = 12;       ///< half width of the square whose rest is the background [px], > guard
  int max_size = 12;            ///< larger things (width or height at half contrast) are no spots [px], >= 1
  int max_spots = 100;          ///< of a frame, >= 1: the strongest
  int memory = 100;             ///< of the temporal background [frames], >= 2
  int warm_up = 10;             ///< frames before the temporal background is used, in [1, memory]
  double centroid_floor = 0.1;  ///< sigma of the centroid that no noise explains: shape, pixels [px], >= 0
};

/// A small bright (or dark) thing in an image.
struct Spot {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< centre (u, v) [px]; that of the first pixel is (0, 0)
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of `pixel` [px^2]
  double snr = 0.0;       ///< amplitude over the noise's, both through a filter of the spot's own size
  double contrast = 0.0;  ///< of the smoothed image at the peak [grey levels]; negative = dark
  int area = 0;           ///< pixels above half of the contrast
};

/// Finds small targets frame by frame: background removal, a threshold that follows the local noise (constant
/// false alarm rate, Finn and Johnson 1968), (S-89); centre to a fraction of a pixel (windowed centroid,
/// Bertin and Arnouts 1996) with its covariance (Huber 1967), (S-90).
class SpotDetector {
 public:
  explicit SpotDetector(const SpotDetectorParams& params)
      : params_(params), mask_(params.guard, params.neighbourhood) {}

  /// The spots of the next frame, strongest first; valid until the next call. An image of another size than
  /// the last one starts anew. Bad pixels (NaN, infinite) are left out, and the rest is seen as without them,
  /// (S-105). No allocation once the size is known, but for the list of spots.
  const std::vector<Spot>& detect(const GreyImage& image);

  int badPixels() const { return mask_.count(); }  ///< of the last frame

  /// Whether the background is known; before, no spots are found.
  bool isReady() const;

 private:
  struct Peak {
    int u = 0, v = 0;
    float strength = 0.0F;  // contrast over noise
  };
  struct Blob {
    int area = 0;
    bool is_small = true;
  };
  /// The background round a spot, taken by itself.
  struct Patch {
    Eigen::Vector3d plane = Eigen::Vector3d::Zero();  // level at the peak, slope along u, slope along v
    double variance = 0.0;                            // of the pixels about the plane
  };

  void resize(const GreyImage& image);
  void smooth();
  void removeNeighbourhood();
  void measureNoise();
  template <typename Function>
  void ringMeans(const std::vector<float>& plane, std::vector<float>& means, const Function& function);
  void findPeaks();
  bool isOld(std::size_t pixel) const;
  bool isPeak(int u, int v) const;
  void takeSpots();
  Blob grow(const Peak& peak);
  Spot locate(const Peak& peak, const Blob& blob) const;
  Patch patchAround(int u, int v) const;
  void learn();

  int at(int u, int v) const { return v * width_ + u; }

  SpotDetectorParams params_;
  PixelMask mask_;
  int width_ = 0, height_ = 0;
  int frames_ = 0;                // from which the background was learned
  const float* image_ = nullptr;  // during `detect`
  std::vector<float> smoothed_;
  std::vector<float> contrast_, rough_,
      noise_;                         // smoothed_ less its neighbourhood; standard deviation of that there
  std::vector<float> mean_;           // of each pixel's contrast over time
  std::vector<unsigned char> taken_;  // pixels of things already looked at
  std::vector<float> row_;
  std::vector<double> column_sums_, prefix_;
  std::vector<Peak> peaks_;
  std::vector<int> front_;  // of a growing blob
  std::vector<Spot> spots_;
};

}  // namespace sightline::core
