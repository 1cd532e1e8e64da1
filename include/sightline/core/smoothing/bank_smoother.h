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

/// With a lag the times within so much of it are smoothed at once: their lags are up to 1.5 times as long,
/// and one way back serves them all.
constexpr double kLagBatch = 0.5;

/// A filter that has taken the first `next` of a target's sightings.
struct BankFilter {
  NogaConsistentEstimator estimator;
  std::size_t next = 0;
};

/// Takes `count` further sightings.
void advanceBy(BankFilter& filter, const std::vector<ChartedMeasurement>& sightings, std::size_t count);

/// The motions at `times`, ascending, none before the last sighting that the filter has taken, by all
/// sightings, of which there is at least one. `models`: of the filter's bank.
std::vector<std::optional<SmoothedMotion>> smoothedFrom(const BankFilter& filter,
                                                        const std::vector<ResponseModel>& models,
                                                        const std::vector<ChartedMeasurement>& sightings,
                                                        const std::vector<Time>& times);

/// The motion of one target by sightings before and after, by a bank of NOGA's response models: a pass of the
/// filter forward, and the recursion of bank_smoothing.h back.
///
/// Memory: one bank (5 kB) for each of at most 4096 sightings and one for every 4096 of the rest, of which
/// the forward pass is taken twice. With a lag, one for each sighting within 1.5 times the lag.
class BankSmoother {
 public:
  /// Throws std::invalid_argument for parameters with which the filter cannot work.
  explicit BankSmoother(const NogaConsistentParams& params);

  /// The motions at `times`, ascending. `sightings` are those of one target in order of time. `lag`: only
  /// sightings up to so many seconds later are used, or up to 1.5 times as many (kLagBatch) [s], >= 0;
  /// nullopt = all. nullopt before the first sighting; after the last one that may be used, what the filter
  /// predicts.
  std::vector<std::optional<SmoothedMotion>> smooth(const std::vector<ChartedMeasurement>& sightings,
                                                    const std::vector<Time>& times,
                                                    std::optional<double> lag = std::nullopt) const;

 private:
  NogaConsistentParams params_;
};

}  // namespace sightline::core
