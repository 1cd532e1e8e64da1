#include "sightline/core/estimators/charted_estimator.h"

#include <utility>

namespace sightline::core {
ChartedEstimator::ChartedEstimator(std::unique_ptr<Estimator> estimator, const Tracklet& first)
    : chart_(Chart::around(first.sighting.direction)), estimator_(std::move(estimator)) {
  estimator_->update(measurementOf(first));
}

ChartedEstimator::ChartedEstimator(std::unique_ptr<Estimator> estimator, const Scan& scan,
                                   const Sighting& first)
    : chart_(Chart::around(first.direction)), estimator_(std::move(estimator)) {
  estimator_->update(measurementOf(scan, first));
}

ChartedEstimator::ChartedEstimator(const ChartedEstimator& other)
    : chart_(other.chart_), estimator_(other.estimator_->clone()), last_prediction_(other.last_prediction_) {}

bool ChartedEstimator::update(const Tracklet& tracklet, double stamp_variance) {
  const bool has_moved = follow(tracklet.time).has_value();
  Measurement measurement = measurementOf(tracklet);
  if (stamp_variance > 0.0) {
    const Eigen::Vector2d rates = stateInChart(tracklet.time).rates();
    measurement.covariance += stamp_variance * rates * rates.transpose();
  }
  update(measurement);
  return has_moved;
}

void ChartedEstimator::update(const Measurement& measurement) {
  estimator_->update(measurement);
  last_prediction_.reset();
}

AngularState ChartedEstimator::stateAt(Time time) const {
  return chart_.toTracking(stateInChart(time));
}

const AngularState& ChartedEstimator::stateInChart(Time time) const {
  if (!last_prediction_ || last_prediction_->time != time)
    last_prediction_ = Prediction{time, *estimator_->stateAt(time)};  // determined since the first sighting
  return last_prediction_->state;
}

std::optional<Eigen::Matrix2d> ChartedEstimator::follow(Time time) {  // (S-13)
  const Eigen::Vector2d expected = stateInChart(time).angles();
  if (chart_.holds(expected)) return std::nullopt;
  const Chart next = chart_.following(chart_.directionAt(expected));
  const Eigen::Matrix3d R_new_old = next.R_chart_tracking() * chart_.R_chart_tracking().transpose();
  estimator_->rotate(R_new_old);
  chart_ = next;
  last_prediction_.reset();
  return rotationJacobian(expected, R_new_old);
}

Measurement ChartedEstimator::measurementOf(const Scan& scan, const Sighting& sighting) const {
  Measurement measurement;
  measurement.time = scan.time;
  measurement.position = chart_.coordinatesOf(sighting.direction);
  measurement.covariance = chart_.covarianceOf(sighting);
  measurement.ifov = scan.ifov;
  return measurement;
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
