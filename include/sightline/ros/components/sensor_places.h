#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <tf2/buffer_core.h>

#include "sightline/core/model/refusal.h"

namespace sightline_ros {

/// Where the sensors of several local trackers stand, as far as tf says it: directions of targets seen from
/// places that stand apart differ by the parallax and cannot be fused. A sensor's frame is that of its name,
/// or what was set. Of a sensor without a frame in tf nothing is said. What is kept is bounded.
class SensorPlaces {
 public:
  /// `max_baseline`: largest distance of two sensors [m]; 0 = any. `transforms` must outlive this.
  SensorPlaces(double max_baseline, const tf2::BufferCore& transforms)
      : max_baseline_(max_baseline), transforms_(&transforms) {}

  void setFrame(const std::string& sensor, const std::string& frame) { frames_[sensor] = frame; }

  /// Why a tracker over these sensors is left out: one of them stands apart from the reference, which is the
  /// first sensor heard of whose place is known. `sigma`: the smallest of the tracker's tracks [rad], to say
  /// what the distance means; 0 = not known.
  std::optional<sightline::core::Refusal> take(const std::string& tracker,
                                               const std::vector<std::string>& sensors, double sigma);

  /// Largest distance of a sensor from the reference so far [m].
  double spread() const { return spread_; }

 private:
  std::string frameOf(const std::string& sensor) const;
  std::optional<double> distance(const std::string& frame) const;

  double max_baseline_;
  const tf2::BufferCore* transforms_;
  std::map<std::string, std::string> frames_;  // by sensor, of those that were set
  std::string reference_;                      // sensor; empty = none yet
  double spread_ = 0.0;
};

}  // namespace sightline_ros
