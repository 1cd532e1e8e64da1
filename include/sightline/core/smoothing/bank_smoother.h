#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/estimators/estimator.h"
#include "sightline/core/estimators/noga_consistent.h"
#include "sightline/core/model/sphere.h"
#include "sightline/core/model/time.h"

namespace sightline::core {

/// A sighting for the smoother, in a chart.
struct ChartedMeasurement {
  Measurement measurement;
  /// From the chart of the sighting before to this one's, where the two are not the same.
  std::optional<Eigen::Matrix3d> R_new_old;
};

/// Where a target was.
struct SmoothedMotion {
  AngularState state;                                     ///< in the chart of ...
  std::size_t chart_of = 0;                               ///< ... this sighting
  Eigen::Vector2d noise_scale = Eigen::Vector2d::Ones();  ///< of the sightings then, over the stated [1]
};

/// The motion of one target by sightings before and after, by a bank of NOGA's response models: a pass of the
/// filter forward, and the recursion of bank_smoothing.h back.
///
/// Memory: one bank (5 kB) for each of at most 4096 sightings and one for every 4096 of the rest, of which
/// the forward pass is taken twice. With a lag, one for each sighting within the lag.
class BankSmoother {
 public:
  /// Throws std::invalid_argument for parameters with which the filter cannot work.
  explicit BankSmoother(const NogaConsistentParams& params);

  /// The motions at `times`, ascending. `sightings` are those of one target in order of time. `lag`: only
  /// sightings up to so many seconds later are used [s], >= 0; nullopt = all. nullopt before the first
  /// sighting; after the last one that may be used, what the filter predicts.
  std::vector<std::optional<SmoothedMotion>> smooth(const std::vector<ChartedMeasurement>& sightings,
                                                    const std::vector<Time>& times,
                                                    std::optional<double> lag = std::nullopt) const;

 private:
  NogaConsistentParams params_;
};

}  // namespace sightline::core
