#include "sightline/core/tracking/live_track.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>

#include "sightline/core/association/log_sum.h"
#include "sightline/core/estimators/rate_prior.h"
#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kInnovationMemory = 0.1;    // share of the newest innovation in the running mean
constexpr double kLargestInnovation = 25.0;  // d^2 / 2 that one sighting may count for at most
constexpr double kNoiseMargin = 1.5;         // by which the noise found may be too small by chance

constexpr double kChangeOfRates = 0.5;  // of a tentative track, from look to look, as a share of the rates
constexpr double kOrdinaryRate = 0.3;   // standard deviation of a new target's rates in clutter [rad/s]
constexpr double kCertain = 0.95;       // probability from which a sighting is taken for the target's
constexpr double kReturns = 0.5;        // of targets that are lost, those that return
constexpr double kJumps = 0.05;         // of these, those that have jumped ...
constexpr double kJumpStretch = 25.0;   // ... so much farther

bool isUsable(const AngularState& state) {
  return state.mean.allFinite() && state.covariance.allFinite() &&
         Eigen::LLT<Eigen::Matrix4d>(state.covariance).info() == Eigen::Success;
}

/// Puts what several possible sightings say together in the place of one. The estimator multiplies the
/// covariance with the noise scale that it has learnt; that is in the possible ones already.
void joinTogether(const std::vector<PossibleSighting>& possible, const TrackPrediction& prediction,
                  Measurement& measurement) {
  const auto mostLikely = [](const PossibleSighting& a, const PossibleSighting& b) {
    return a.probability < b.probability;
  };
  const double most = std::max_element(possible.begin(), possible.end(), mostLikely)->probability;
  if (most > kCertain) return;  // that one, which tells of the noise and of the motion's model as well
  const auto equivalent = equivalentSighting(prediction.state.anglesCovariance(), possible);
  if (!equivalent) return;
  const Eigen::Vector2d unscaled = prediction.noise_scale.cwiseInverse();
  measurement.position = prediction.state.angles() + equivalent->innovation;
  measurement.covariance = noiseCovariance(equivalent->covariance, unscaled);
  measurement.sightings = equivalent->sightings;
  measurement.is_certain = false;
}

/// Log density of one state at another of which as little is known, as targets move, or jump now and then.
double logDensityWithJumps(const AngularState& expected, const AngularState& found) {
  Eigen::Vector4d difference = found.mean - expected.mean;
  difference.head<2>() = angleDifference(found.angles(), expected.angles());
  const Eigen::LLT<Eigen::Matrix4d> both(expected.covariance + found.covariance);
  if (both.info() != Eigen::Success) return -std::numeric_limits<double>::infinity();
  const double distance_squared = difference.dot(both.solve(difference));
  const double log_root = both.matrixLLT().diagonal().array().log().sum();  // of the determinant
  const auto logNormal = [&](double stretch) {  // with a covariance stretch^2 times as large
    return -0.5 * distance_squared / (stretch * stretch) - log_root - 4.0 * std::log(stretch) -
           2.0 * std::log(2.0 * kPi);
  };
  LogSum density;
  density.add(std::log(1.0 - kJumps) + logNormal(1.0));
  density.add(std::log(kJumps) + logNormal(kJumpStretch));
  return density.value();
}

}  // namespace

LiveTrack::LiveTrack(std::uint32_t id, const TrackOrigin& origin, const Scan& scan, const Sighting& sighting,
                     std::unique_ptr<Estimator> estimator, double odds, const RevisitTime& interval)
    : id_(id),
      origin_(origin),
      estimator_(std::move(estimator), scan, sighting),
      lifecycle_(scan.time, odds),
      last_covariance_(estimator_.chart().covarianceOf(sighting)),
      last_noise_scale_(scan.noise_scale) {
  noteSource(scan, Eigen::Vector2d::Zero());
  sensors_.noteInterval(scan.sensor, interval);
  lifecycle_.setUnit(sensors_.unit(scan.time, 1.0, 0.0));
}

double LiveTrack::gateScale(bool adapt_gate) const {
  return adapt_gate ? std::max(1.0, innovation_scale_) : 1.0;
}

/// The unit of the track's time, by the sensors that see it. It stays when they have all fallen silent.
void LiveTrack::updateUnit(Time time, const LifecycleParams& params) {
  const double unit = sensors_.unit(time, params.delete_silence, lifecycle_.leastSilence());
  if (unit > 0.0) lifecycle_.setUnit(unit);
}

TrackPrediction LiveTrack::predict(const Scan& scan, const ScanSensor& sensor, const LifecycleParams& params,
                                   bool adapt_gate) {
  sensors_.noteInterval(scan.sensor, sensor.interval);
  updateUnit(scan.time, params);
  if (const auto J = estimator_.follow(scan.time)) {
    last_covariance_ = symmetric(*J * last_covariance_ * J->transpose());
    sensors_.rotate(*J);
  }
  TrackPrediction prediction;
  prediction.id = id_;
  prediction.believed = lifecycle_.isEstablished();
  prediction.guards = lifecycle_.isEstablished() && lifecycle_.status() == TrackStatus::confirmed;
  prediction.chart = estimator_.chart();
  prediction.state = estimator_.stateInChart(scan.time);
  if (!estimator_.knowsRates()) expectSecondLook(scan.time, sensor.is_clear, prediction);
  if (lifecycle_.isTentative() && lifecycle_.hits() >= 2 && (sensor.is_clear || lifecycle_.unit() > 1.0)) {
    const double h = seconds(scan.time - lifecycle_.lastSighting());
    prediction.change_sigma = kChangeOfRates * prediction.state.rates().norm() * h;
  }
  prediction.noise_scale = estimator_.noiseScale();
  prediction.innovation_scale = gateScale(adapt_gate);
  prediction.direction = prediction.chart.directionAt(prediction.state.angles());
  prediction.existence = lifecycle_.existence();
  prediction.detection_probability = lifecycle_.detectionProbability(sensor.detection_probability);
  const bool has_been_seen =
      sensors_.hasSeen(scan.sensor, scan.time, params.delete_silence, lifecycle_.leastSilence());
  const bool looks_there = !scan.view || scan.view->holds(prediction.direction);
  prediction.is_in_view = has_been_seen && looks_there;
  prediction.visibility = !looks_there ? 0.0 : has_been_seen ? 1.0 : sensors_.visibility(scan.sensor);
  return prediction;
}

/// What is expected of a target that has been seen once. Among many false sightings, and often looked at,
/// neither a very fast target nor one at rest can be told from two of them: there its rates are taken to be
/// ordinary.
// (S-93)
void LiveTrack::expectSecondLook(Time time, bool is_clear, TrackPrediction& prediction) const {
  const double h = seconds(time - lifecycle_.lastSighting());
  const bool is_slow = lifecycle_.unit() > 1.0;
  if (!is_clear && !is_slow) {
    const InitialRate ordinary(kOrdinaryRate);
    prediction.state = ordinary.stateAfter(h, prediction.state.angles(), last_covariance_);
  } else if (h > 0.0) {
    prediction.since_only_sighting = h;
    prediction.only_sighting = last_covariance_;
  }
}

void LiveTrack::update(const Scan& scan, const Sighting& sighting, const TrackPrediction& prediction,
                       const std::vector<PossibleSighting>& possible, double likelihood_ratio,
                       const LifecycleParams& params) {
  Measurement measurement = estimator_.measurementOf(scan, sighting);
  measurement.covariance += prediction.stamp_covariance;
  last_covariance_ = measurement.covariance;
  last_noise_scale_ = scan.noise_scale;
  if (!possible.empty()) joinTogether(possible, prediction, measurement);
  Gate stated;
  stated.covariance = prediction.state.anglesCovariance() + prediction.noiseOf(sighting);
  const Eigen::Vector2d innovation = angleDifference(measurement.position, prediction.state.angles());
  const double seen = std::min(distanceSquared(stated, innovation) / 2.0, kLargestInnovation);
  // (S-41); of a target seen once nothing was predicted
  const bool tells = measurement.is_certain && prediction.since_only_sighting == 0.0;
  if (tells) innovation_scale_ += kInnovationMemory * (seen - innovation_scale_);

  estimator_.update(measurement);
  lifecycle_.noteSighting(scan.time, likelihood_ratio, prediction.is_in_view, params);
  if (prediction.visibility < 1.0) sensors_.noteVisible(scan.sensor);
  noteSource(scan, innovation);
}

void LiveTrack::miss(const Scan& scan, const TrackPrediction& prediction, double likelihood_ratio,
                     const LifecycleParams& params) {
  if (prediction.visibility <= 0.0) return;
  lifecycle_.noteMiss(scan.time, likelihood_ratio, prediction.is_in_view, params);
  if (!prediction.is_in_view)
    sensors_.noteMiss(scan.sensor, prediction.visibility, prediction.detection_probability);
}

/// Sightings that are calmer than stated have a slowly varying error in the stated accuracy beside their
/// noise, (S-42). `innovation`: of the last sighting, in the chart [rad].
void LiveTrack::noteSource(const Scan& scan, const Eigen::Vector2d& innovation) {
  const Eigen::Vector2d noise = scan.noise_scale * estimator_.noiseScale();
  const Eigen::Vector2d share = (Eigen::Vector2d::Ones() - kNoiseMargin * noise).cwiseMax(0.0);
  const Eigen::Vector2d slow_error = share.cwiseProduct(last_covariance_.diagonal()) / scan.noise_scale;
  sensors_.noteSighting(scan.sensor, scan.time, innovation, last_covariance_, slow_error);
}

// (S-43)
double LiveTrack::logDensityOfReturn(const LiveTrack& fresh, Time time, double noise_scale) const {
  const AngularState its = estimator_.chart().fromTracking(fresh.estimator_.stateAt(time));
  LogSum density;
  for (Hypothesis& mine : estimator_.hypothesesInChart(time)) {
    mine.state.covariance *= growth(noise_scale);
    density.add(std::log(mine.probability) + logDensityWithJumps(mine.state, its));
  }
  return std::log(kReturns) + density.value();
}

// (S-43), (S-92)
double LiveTrack::logDensityOfBirth(Time time, double births) const {
  const AngularState& state = estimator_.stateInChart(time);
  const double log_position = std::log(births * std::cos(state.angles().y()));
  return log_position +
         rate_prior::logDensityOfRates(state.rates(), state.covariance.bottomRightCorner<2, 2>());
}

LiveTrack LiveTrack::branch(std::uint32_t id, const TrackOrigin& origin) const {
  LiveTrack branch(*this);
  branch.id_ = id;
  branch.origin_ = origin;
  return branch;
}

void LiveTrack::resume(const LiveTrack& lost) {
  id_ = lost.id_;
  origin_ = lost.origin_;
  lifecycle_.resume(lost.lifecycle_);
}

Corroboration LiveTrack::corroborationOf(const std::string& sensor, Time time,
                                         const SensorGuard& guard) const {
  return sensors_.corroborationOf(sensor, time, guard, lifecycle_.isMature());
}

/// Covariance of the last sighting's noise, by what the estimator has found, in the chart [rad^2].
Eigen::Matrix2d LiveTrack::lastNoise() const {
  return noiseCovariance(last_covariance_, estimator_.noiseScale());
}

/// How many times as wide as the sightings' own sigma makes it the gate is, (S-41).
double LiveTrack::spread(const AngularState& state, bool adapt_gate) const {
  const Eigen::Matrix2d R = lastNoise();
  const Eigen::Matrix2d S = gateScale(adapt_gate) * (state.anglesCovariance() + R);
  const Eigen::Vector2d stated = (last_covariance_ / last_noise_scale_).diagonal();
  return S.diagonal().cwiseQuotient(R.diagonal().cwiseMax(stated)).cwiseSqrt().maxCoeff();
}

bool LiveTrack::isOver(Time time, const LifecycleParams& params, bool adapt_gate,
                       const NoiseCalibration& calibration) const {
  if (lifecycle_.isOver(time, params)) return true;
  const AngularState& state = estimator_.stateInChart(time);
  if (!isUsable(state)) return true;
  if (!lifecycle_.isEstablished()) return false;
  const double widest = params.max_spread * lifecycle_.unit(), width = spread(state, adapt_gate);
  return width > widest &&
         width > widest * std::sqrt(growth(calibration.suspectedScale(origin_.sensor)));  // (S-96)
}

Track LiveTrack::report(Time time, const GateParams& gate, bool adapt_gate,
                        const LifecycleParams& params) const {
  Track track;
  track.id = id_;
  track.status = lifecycle_.status();
  track.last_sighting = lifecycle_.lastSighting();
  track.hits = lifecycle_.hits();
  track.misses = lifecycle_.misses();
  track.existence = lifecycle_.existence();
  track.sources = sensors_.names(time, params.delete_silence, lifecycle_.leastSilence());

  AngularState state = estimator_.stateInChart(time);
  state.covariance.diagonal().head<2>() += sensors_.slowErrorVariance(time);
  track.state = estimator_.chart().toTracking(state);

  // The next sighting is expected one usual interval later.
  AngularState next = estimator_.stateInChart(time + durationOf(lifecycle_.interval()));
  const Gate in_chart = gateOf(next, lastNoise(), gate, gateScale(adapt_gate));
  next.covariance.topLeftCorner<2, 2>() = in_chart.covariance;
  const AngularState in_tracking = estimator_.chart().toTracking(next);
  track.gate.centre = in_tracking.angles();
  track.gate.covariance = in_tracking.anglesCovariance();
  track.gate.half_width =
      (gateThreshold(gate) * track.gate.covariance.diagonal()).cwiseSqrt().cwiseMin(gate.max_half_width);
  return track;
}

}  // namespace sightline::core
