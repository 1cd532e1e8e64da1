#pragma once

#include <memory>
#include <optional>

#include "sightline/core/estimators/estimator.h"
#include "sightline/core/model/chart.h"
#include "sightline/core/model/sighting.h"
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

  /// Starts with the first sighting of a target.
  ChartedEstimator(std::unique_ptr<Estimator> estimator, const Scan& scan, const Sighting& first);

  ChartedEstimator(const ChartedEstimator& other);
  ChartedEstimator(ChartedEstimator&&) = default;
  ChartedEstimator& operator=(ChartedEstimator&&) = default;
  ChartedEstimator& operator=(const ChartedEstimator&) = delete;
  ~ChartedEstimator() = default;

  /// Takes a tracklet, not older than the last one. Moves to a new chart first when the target is expected to
  /// leave the present one. `stamp_variance`: mean square by which its stamp is off [s^2].
  /// Returns whether it moved.
  bool update(const Tracklet& tracklet, double stamp_variance = 0.0);

  /// Moves to a new chart when the target is expected to leave the present one at `time`. Returns the
  /// Jacobian of the new chart's angles by the old one's at the expected position; nullopt when it stays.
  std::optional<Eigen::Matrix2d> follow(Time time);

  /// The scan's sighting in the present chart.
  Measurement measurementOf(const Scan& scan, const Sighting& sighting) const;

  /// Updates with a measurement in the present chart, not older than the last one.
  void update(const Measurement& measurement);

  /// Motion expected at `time`, in the tracking frame's angles.
  AngularState stateAt(Time time) const;

  /// The same in the present chart, with the chart.
  ChartedState predict(Time time) const { return {chart_, stateInChart(time)}; }

  /// The same without the chart. It is remembered for the last `time` asked for: an estimator may be a whole
  /// bank of filters, and several steps ask for the same instant.
  const AngularState& stateInChart(Time time) const;

  /// The mixture of which that is mean and covariance, in the present chart: see Estimator::hypothesesAt.
  std::vector<Hypothesis> hypothesesInChart(Time time) const { return estimator_->hypothesesAt(time); }

  const Chart& chart() const { return chart_; }

  /// Whether anything is known of the target's rates: see Estimator::knowsRates.
  bool knowsRates() const { return estimator_->knowsRates(); }

  /// Variance of the sightings' white noise over the stated one, in each coordinate of the chart [1].
  Eigen::Vector2d noiseScale() const { return estimator_->noiseScale(); }

  /// Whether that is learnt from now on: see Estimator::learnNoise.
  void learnNoise(bool enabled) {
    estimator_->learnNoise(enabled);
    last_prediction_.reset();
  }

 private:
  struct Prediction {
    Time time;
    AngularState state;  // in the chart
  };

  Measurement measurementOf(const Tracklet& tracklet) const;

  Chart chart_;
  std::unique_ptr<Estimator> estimator_;
  mutable std::optional<Prediction> last_prediction_;
};

}  // namespace sightline::core
