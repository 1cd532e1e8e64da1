#include "sightline/core/smoothing/track_smoother.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "sightline/core/model/chart.h"
#include "sightline/core/smoothing/smoothing_bank.h"

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

/// What the sensors' positions have in them beside white noise, as a track takes it together (S-42).
class SlowErrors {
 public:
  void note(const TakenSighting& sighting) {
    const Tracklet& tracklet = sighting.tracklet;
    auto source = std::find_if(sources_.begin(), sources_.end(), [&](const Source& known) {
      return known.last->tracklet.sensor == tracklet.sensor;
    });
    if (source == sources_.end()) source = sources_.insert(source, Source{&sighting, 0.0});
    source->information = faded(*source, tracklet.time) + 1.0 / tracklet.sighting.covariance.trace();
    source->last = &sighting;
  }

  /// Variance of each coordinate of a chart [rad^2]. `noise_scale`: of white noise over that of the
  /// sightings.
  Eigen::Vector2d variance(const Chart& chart, Time time, const Eigen::Vector2d& noise_scale) const {
    double sum = 0.0;
    Eigen::Vector2d variance = Eigen::Vector2d::Zero();
    for (const Source& source : sources_) {
      const double information = faded(source, time), scale = source.last->noise_scale;
      const Eigen::Vector2d R = chart.covarianceOf(source.last->tracklet.sighting).diagonal();
      const Eigen::Vector2d share =
          (Eigen::Vector2d::Ones() - kNoiseMargin * scale * noise_scale).cwiseMax(0.0);
      sum += information;
      variance += information * information / scale * share.cwiseProduct(R);
    }
    return sum > 0.0 ? Eigen::Vector2d(variance / (sum * sum)) : variance;
  }

 private:
  struct Source {
    const TakenSighting* last;
    double information;  // of its sightings, fading [1/rad^2]
  };

  static double faded(const Source& source, Time time) {
    return source.information * std::exp(-seconds(time - source.last->tracklet.time) / kInformationMemory);
  }

  std::vector<Source> sources_;
};

}  // namespace

TrackSmoother::TrackSmoother(const EstimatorParams& params) : smoother_(smoothingBankOf(params)) {}

std::vector<std::optional<AngularState>> TrackSmoother::smooth(const std::vector<TakenSighting>& sightings,
                                                               const std::vector<Time>& times,
                                                               std::optional<double> lag) const {
  std::vector<Chart> charts;
  std::vector<ChartedMeasurement> measurements;
  charts.reserve(sightings.size());
  measurements.reserve(sightings.size());
  for (const TakenSighting& sighting : sightings) {
    const Eigen::Vector3d& direction = sighting.tracklet.sighting.direction;
    ChartedMeasurement measurement;
    if (charts.empty()) {
      charts.push_back(Chart::around(direction));
    } else {
      const Chart before = charts.back();
      const bool stays = before.holds(before.coordinatesOf(direction));
      charts.push_back(stays ? before : before.following(direction));
      if (!stays) {
        measurement.R_new_old = charts.back().R_chart_tracking() * before.R_chart_tracking().transpose();
      }
    }
    measurement.measurement = measurementIn(charts.back(), sighting.tracklet);
    measurements.push_back(measurement);
  }

  std::vector<std::optional<AngularState>> states;
  states.reserve(times.size());
  SlowErrors slow_errors;
  std::size_t next = 0, query = 0;
  for (const auto& motion : smoother_.smooth(measurements, times, lag)) {
    const Time time = times[query++];
    for (; next < sightings.size() && sightings[next].tracklet.time <= time; ++next)
      slow_errors.note(sightings[next]);
    if (!motion) {
      states.emplace_back();
      continue;
    }
    const Chart& chart = charts[motion->chart_of];
    AngularState state = motion->state;
    state.covariance.diagonal().head<2>() += slow_errors.variance(chart, time, motion->noise_scale);
    states.push_back(chart.toTracking(state));
  }
  return states;
}

}  // namespace sightline::core
