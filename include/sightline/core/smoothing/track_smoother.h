#pragma once

#include <optional>
#include <vector>

#include "sightline/core/estimators/estimators.h"
#include "sightline/core/model/sphere.h"
#include "sightline/core/model/time.h"
#include "sightline/core/model/tracklet.h"
#include "sightline/core/smoothing/bank_smoother.h"

namespace sightline::core {

/// A sighting that a track was updated with.
struct TakenSighting {
  Tracklet tracklet;         ///< in the tracking frame, with the noise that was used
  double noise_scale = 1.0;  ///< factor on the stated variances that it has in it already, > 0
};

/// Where a target was, given the sightings of its track before and after: on the sphere what BankSmoother is
/// in one chart. Charts follow the target as those of its filter do.
///
/// The covariance of a position has the slowly varying error of the sensors in it (S-42), which no sighting
/// averages out.
class TrackSmoother {
 public:
  /// By the models of the estimator: see smoothingBankOf, which says what is refused.
  explicit TrackSmoother(const EstimatorParams& params);

  /// The motions at `times` (ascending) in the tracking frame's angles, by the track's `sightings` (in order
  /// of time); `lag` as in BankSmoother. nullopt before the first sighting.
  std::vector<std::optional<AngularState>> smooth(const std::vector<TakenSighting>& sightings,
                                                  const std::vector<Time>& times,
                                                  std::optional<double> lag = std::nullopt) const;

 private:
  BankSmoother smoother_;
};

}  // namespace sightline::core
