#include "sightline/core/smoothing/track_charts.h"

#include <algorithm>
#include <cmath>

namespace sightline::core {
namespace {

constexpr double kNoiseMargin = 1.5;        // by which the noise found may be too small by chance
constexpr double kInformationMemory = 1.0;  // over which a sensor's share in a track is weighed [s]

Measurement measurementIn(const Chart& chart, const Tracklet& tracklet) {
  Measurement measurement;
  measurement.time = tracklet.time;
  measurement.position = chart.coordinatesOf(tracklet.sighting.direction);
  measurement.covariance = chart.covarianceOf(tracklet.sighting);
  measurement.ifov = tracklet.ifov;
  measurement.sightings = tracklet.sightings;
  return measurement;
}

}  // namespace

void ChartedSightings::add(const TakenSighting& sighting) {
  const Eigen::Vector3d& direction = sighting.tracklet.sighting.direction;
  ChartedMeasurement measurement;
  if (charts_.empty()) {
    charts_.push_back(Chart::around(direction));
  } else {
    const Chart before = charts_.back();
    const bool stays = before.holds(before.coordinatesOf(direction));
    charts_.push_back(stays ? before : before.following(direction));
    if (!stays) {
      measurement.R_new_old = charts_.back().R_chart_tracking() * before.R_chart_tracking().transpose();
    }
  }
  measurement.measurement = measurementIn(charts_.back(), sighting.tracklet);
  measurements_.push_back(measurement);
}

ChartedSightings ChartedSightings::only(std::size_t k) const {
  ChartedSightings one;
  one.charts_ = {charts_[k]};
  one.measurements_ = {measurements_[k]};
  one.measurements_.front().R_new_old.reset();
  return one;
}

void SlowErrors::note(const TakenSighting& sighting) {
  const Tracklet& tracklet = sighting.tracklet;
  auto source = std::find_if(sources_.begin(), sources_.end(), [&](const Source& known) {
    return known.last.tracklet.sensor == tracklet.sensor;
  });
  if (source == sources_.end()) source = sources_.insert(source, Source{sighting, 0.0});
  source->information = faded(*source, tracklet.time) + 1.0 / tracklet.sighting.covariance.trace();
  source->last = sighting;
}

Eigen::Vector2d SlowErrors::variance(const Chart& chart, Time time,
                                     const Eigen::Vector2d& noise_scale) const {
  double sum = 0.0;
  Eigen::Vector2d variance = Eigen::Vector2d::Zero();
  for (const Source& source : sources_) {
    const double information = faded(source, time), scale = source.last.noise_scale;
    const Eigen::Vector2d R = chart.covarianceOf(source.last.tracklet.sighting).diagonal();
    const Eigen::Vector2d share =
        (Eigen::Vector2d::Ones() - kNoiseMargin * scale * noise_scale).cwiseMax(0.0);
    sum += information;
    variance += information * information / scale * share.cwiseProduct(R);
  }
  return sum > 0.0 ? Eigen::Vector2d(variance / (sum * sum)) : variance;
}

double SlowErrors::faded(const Source& source, Time time) {
  return source.information * std::exp(-seconds(time - source.last.tracklet.time) / kInformationMemory);
}

AngularState stateIn(const Chart& chart, const SmoothedMotion& motion, const SlowErrors& slow_errors,
                     Time time) {
  AngularState state = motion.state;
  state.covariance.diagonal().head<2>() += slow_errors.variance(chart, time, motion.noise_scale);
  return chart.toTracking(state);
}

}  // namespace sightline::core
