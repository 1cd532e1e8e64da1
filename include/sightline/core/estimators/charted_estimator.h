#pragma once

#include <memory>

#include "sightline/core/estimators/estimator.h"
#include "sightline/core/model/chart.h"
#include "sightline/core/model/sphere.h"
#include "sightline/core/model/time.h"
#include "sightline/core/model/track_prediction.h"
#include "sightline/core/model/tracklet.h"

namespace sightline::core {

/// An estimator and the chart it works in, which follows the target over the sphere. Copies are deep.
class ChartedEstimator {
 public:
  /// Starts with the first tracklet of a target.
  ChartedEstimator(std::unique_ptr<Estimator> estimator, const Tracklet& first);

  ChartedEstimator(const ChartedEstimator& other);
  ChartedEstimator(ChartedEstimator&&) = default;
  ChartedEstimator& operator=(ChartedEstimator&&) = default;
  ChartedEstimator& operator=(const ChartedEstimator&) = delete;
  ~ChartedEstimator() = default;

  /// Takes a tracklet, not older than the last one. Moves to a new chart first when the target is expected to
  /// leave the present one. `stamp_variance`: mean square by which its stamp is off [s^2].
  /// Returns whether it moved.
  bool update(const Tracklet& tracklet, double stamp_variance = 0.0);

  /// Motion expected at `time`, in the tracking frame's angles.
  AngularState stateAt(Time time) const;

  /// The same in the present chart, with the chart.
  ChartedState predict(Time time) const;

 private:
  bool follow(Time time);
  Measurement measurementOf(const Tracklet& tracklet) const;

  Chart chart_;
  std::unique_ptr<Estimator> estimator_;
};

}  // namespace sightline::core
