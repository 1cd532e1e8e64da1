#include "sightline/core/estimators/charted_estimator.h"

#include <utility>

namespace sightline::core {

ChartedEstimator::ChartedEstimator(std::unique_ptr<Estimator> estimator, const Tracklet& first)
    : chart_(Chart::around(first.sighting.direction)), estimator_(std::move(estimator)) {
  estimator_->update(measurementOf(first));
}

ChartedEstimator::ChartedEstimator(const ChartedEstimator& other)
    : chart_(other.chart_), estimator_(other.estimator_->clone()) {}

bool ChartedEstimator::update(const Tracklet& tracklet, double stamp_variance) {
  const bool has_moved = follow(tracklet.time);
  Measurement measurement = measurementOf(tracklet);
  if (stamp_variance > 0.0) {
    const Eigen::Vector2d rates = estimator_->stateAt(tracklet.time)->rates();
    measurement.covariance += stamp_variance * rates * rates.transpose();
  }
  estimator_->update(measurement);
  return has_moved;
}

AngularState ChartedEstimator::stateAt(Time time) const {
  return chart_.toTracking(*estimator_->stateAt(time));  // determined since the first tracklet
}

ChartedState ChartedEstimator::predict(Time time) const {
  return {chart_, *estimator_->stateAt(time)};
}

bool ChartedEstimator::follow(Time time) {  // (S-13)
  const Eigen::Vector2d expected = estimator_->stateAt(time)->angles();
  if (chart_.holds(expected)) return false;
  const Chart next = chart_.following(chart_.directionAt(expected));
  estimator_->rotate(next.R_chart_tracking() * chart_.R_chart_tracking().transpose());
  chart_ = next;
  return true;
}

Measurement ChartedEstimator::measurementOf(const Tracklet& tracklet) const {
  Measurement measurement;
  measurement.time = tracklet.time;
  measurement.position = chart_.coordinatesOf(tracklet.sighting.direction);
  measurement.covariance = chart_.covarianceOf(tracklet.sighting);
  measurement.ifov = tracklet.ifov;
  measurement.sightings = tracklet.sightings;
  return measurement;
}

}  // namespace sightline::core
