#include "sightline/core/tracking/live_track.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kPaces = 4.0;               // usual intervals that a silence may always last
constexpr double kIntervalMemory = 0.2;      // share of the newest interval in the usual one
constexpr double kInnovationMemory = 0.1;    // share of the newest innovation in the running mean
constexpr double kLargestInnovation = 25.0;  // d^2 / 2 that one sighting may count for at most
constexpr double kSourceMemory = 0.3;        // the same for the innovations of one sensor
constexpr std::size_t kMostSources = 64;
constexpr double kInformationMemory = 1.0;  // over which a sensor's share in a track is weighed [s]
constexpr double kNoiseMargin = 1.5;        // by which the noise found may be too small by chance
constexpr double kLookMemory = 50.0;        // scans over which a track's own share of sightings is taken ...
constexpr double kTrustInSensor = 10.0;     // ... against so many of the sensor's
constexpr double kHopeless = 0.01;          // share of its odds at the start that ends a tentative track
constexpr double kFirstVisibility = 0.5;    // that a sensor could see the target, before it has or has not
constexpr double kLeastVisibility = 0.01;   // after all: it may have been hidden
constexpr double kCertain = 0.95;           // probability from which a sighting is taken for the target's
constexpr double kReturns = 0.5;            // of targets that are lost, those that return
constexpr double kJumps = 0.05;             // of these, those that have jumped ...
constexpr double kJumpStretch = 25.0;       // ... so much farther
constexpr double kSeenAgain = 0.9;          // existence from which a lost track is shown again

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

}  // namespace

LiveTrack::LiveTrack(std::uint32_t id, const Scan& scan, const Sighting& sighting,
                     std::unique_ptr<Estimator> estimator, double odds)
    : id_(id),
      existence_(odds),
      chart_(Chart::around(sighting.direction)),
      estimator_(std::move(estimator)),
      last_covariance_(chart_.covarianceOf(sighting)),
      last_noise_scale_(scan.noise_scale),
      last_sighting_(scan.time),
      weighed_(scan.time) {
  const Measurement measurement = measurementOf(scan, sighting);
  estimator_->update(measurement);
  noteSource(scan, Eigen::Vector2d::Zero(), measurement.covariance);
}

LiveTrack::LiveTrack(const LiveTrack& other)
    : id_(other.id_),
      status_(other.status_),
      lost_(other.lost_),
      existence_(other.existence_),
      chart_(other.chart_),
      estimator_(other.estimator_->clone()),
      known_at_(other.known_at_),
      known_(other.known_),
      last_covariance_(other.last_covariance_),
      last_noise_scale_(other.last_noise_scale_),
      last_sighting_(other.last_sighting_),
      weighed_(other.weighed_),
      interval_(other.interval_),
      innovation_scale_(other.innovation_scale_),
      hits_(other.hits_),
      misses_(other.misses_),
      scans_(other.scans_),
      looked_(other.looked_),
      seen_(other.seen_),
      sources_(other.sources_),
      non_detecting_(other.non_detecting_) {}

Measurement LiveTrack::measurementOf(const Scan& scan, const Sighting& sighting) const {
  Measurement measurement;
  measurement.time = scan.time;
  measurement.position = chart_.coordinatesOf(sighting.direction);
  measurement.covariance = chart_.covarianceOf(sighting);
  measurement.ifov = scan.ifov;
  return measurement;
}

/// The estimator is asked for one instant several times in a scan, and it may be a whole bank of filters.
const AngularState& LiveTrack::stateAt(Time time) const {
  if (!known_at_ || *known_at_ != time) {
    known_ = *estimator_->stateAt(time);  // determined since the first sighting
    known_at_ = time;
  }
  return known_;
}

double LiveTrack::gateScale(bool adapt_gate) const {
  return adapt_gate ? std::max(1.0, innovation_scale_) : 1.0;
}

TrackPrediction LiveTrack::predict(const Scan& scan, double detection_probability,
                                   const LifecycleParams& lifecycle, bool adapt_gate) {
  const Time time = scan.time;
  TrackPrediction prediction;
  prediction.id = id_;
  prediction.believed = isEstablished();
  prediction.guards = isEstablished() && status_ == TrackStatus::confirmed;
  prediction.state = stateAt(time);
  if (!chart_.holds(prediction.state.angles())) {
    const Chart next = chart_.following(chart_.directionAt(prediction.state.angles()));
    const Eigen::Matrix3d R_new_old = next.R_chart_tracking() * chart_.R_chart_tracking().transpose();
    const Eigen::Matrix2d J = rotationJacobian(prediction.state.angles(), R_new_old);
    last_covariance_ = symmetric(J * last_covariance_ * J.transpose());
    for (Source& source : sources_) source.innovation = J * source.innovation;
    estimator_->rotate(R_new_old);
    chart_ = next;
    known_at_ = std::nullopt;
    prediction.state = stateAt(time);
  }
  prediction.chart = chart_;
  prediction.noise_scale = estimator_->noiseScale();
  prediction.innovation_scale = gateScale(adapt_gate);
  prediction.direction = chart_.directionAt(prediction.state.angles());
  prediction.existence = existence_.probability();
  prediction.detection_probability =
      (seen_ + kTrustInSensor * detection_probability) / (looked_ + kTrustInSensor);
  const bool has_been_seen = hasBeenSeenBy(scan, lifecycle);
  const bool looks_there = !scan.view || scan.view->holds(prediction.direction);
  prediction.is_in_view = has_been_seen && looks_there;
  prediction.visibility = !looks_there ? 0.0 : has_been_seen ? 1.0 : visibilityFor(scan);
  return prediction;
}

double LiveTrack::visibilityFor(const Scan& scan) const {
  for (const NonDetectingSensor& stranger : non_detecting_) {
    if (stranger.sensor == scan.sensor) return stranger.visibility;
  }
  return kFirstVisibility;
}

void LiveTrack::noteNonDetection(const Scan& scan, double visibility) {
  for (NonDetectingSensor& stranger : non_detecting_) {
    if (stranger.sensor != scan.sensor) continue;
    stranger.visibility = std::max(visibility, kLeastVisibility);
    return;
  }
  if (non_detecting_.size() < kMostSources) non_detecting_.push_back({scan.sensor, visibility});
}

void LiveTrack::take(const Scan& scan, const Sighting& sighting, const TrackPrediction& prediction,
                     const std::vector<PossibleSighting>& possible, double evidence,
                     const LifecycleParams& lifecycle) {
  Measurement measurement = measurementOf(scan, sighting);
  measurement.covariance += prediction.stamp_covariance;
  last_covariance_ = measurement.covariance;
  if (!possible.empty()) joinTogether(possible, prediction, measurement);
  Gate stated;
  stated.covariance = prediction.state.anglesCovariance() + prediction.noiseOf(sighting);
  const Eigen::Vector2d innovation = angleDifference(measurement.position, prediction.state.angles());
  const double seen = std::min(distanceSquared(stated, innovation) / 2.0, kLargestInnovation);
  if (measurement.is_certain) innovation_scale_ += kInnovationMemory * (seen - innovation_scale_);

  const double since_last = seconds(scan.time - last_sighting_);
  weigh(scan.time, evidence, lifecycle);
  if (prediction.is_in_view) noteLook(true);
  if (prediction.visibility < 1.0) noteNonDetection(scan, kFirstVisibility);
  interval_ = hits_ == 1 ? since_last : interval_ + kIntervalMemory * (since_last - interval_);

  estimator_->update(measurement);
  known_at_ = std::nullopt;
  last_noise_scale_ = scan.noise_scale;
  last_sighting_ = scan.time;
  misses_ = 0;
  ++hits_;
  ++scans_;
  noteSource(scan, innovation, last_covariance_);
  if (status_ != TrackStatus::tentative || isConfirmedBy(lifecycle)) status_ = TrackStatus::confirmed;
  if (lost_ && (!lifecycle.by_existence || existence_.probability() >= kSeenAgain)) lost_ = false;
}

void LiveTrack::miss(const Scan& scan, const TrackPrediction& prediction, double evidence,
                     const LifecycleParams& lifecycle) {
  if (prediction.visibility <= 0.0) return;
  weigh(scan.time, evidence, lifecycle);
  if (prediction.is_in_view) {
    ++misses_;
    ++scans_;
    noteLook(false);
  } else {  // the sensor did not see it, or cannot
    const double missed = 1.0 - prediction.detection_probability;
    const double visibility = prediction.visibility;
    noteNonDetection(scan, visibility * missed / (1.0 - visibility + visibility * missed));
  }
}

void LiveTrack::weigh(Time time, double evidence, const LifecycleParams& lifecycle) {
  existence_.pass(seconds(time - weighed_), lifecycle.presence);
  existence_.weigh(evidence);
  weighed_ = time;
}

bool LiveTrack::isConfirmedBy(const LifecycleParams& lifecycle) const {
  return static_cast<int>(hits_) >= lifecycle.confirm_hits &&
         (!lifecycle.by_existence || existence_.probability() >= lifecycle.confirm_existence);
}

bool LiveTrack::hasBeenSeenBy(const Scan& scan, const LifecycleParams& lifecycle) const {
  return std::any_of(sources_.begin(), sources_.end(), [&](const Source& source) {
    return source.sensor == scan.sensor &&
           seconds(scan.time - source.last_sighting) <= limit(lifecycle.delete_silence);
  });
}

void LiveTrack::noteLook(bool is_seen) {
  constexpr double keep = 1.0 - 1.0 / kLookMemory;
  looked_ = keep * looked_ + 1.0;
  seen_ = keep * seen_ + (is_seen ? 1.0 : 0.0);
}

double LiveTrack::logDensityOfReturn(const LiveTrack& fresh, Time time) const {
  const AngularState mine = stateAt(time);
  const AngularState its = chart_.fromTracking(fresh.chart_.toTracking(fresh.stateAt(time)));
  Eigen::Vector4d difference = its.mean - mine.mean;
  difference.head<2>() = angleDifference(its.angles(), mine.angles());
  const Eigen::LLT<Eigen::Matrix4d> both(mine.covariance + its.covariance);
  if (both.info() != Eigen::Success) return -std::numeric_limits<double>::infinity();
  const double distance_squared = difference.dot(both.solve(difference));
  const double log_root = both.matrixLLT().diagonal().array().log().sum();  // of the determinant
  const auto logNormal = [&](double stretch) {  // with a covariance stretch^2 times as large
    return -0.5 * distance_squared / (stretch * stretch) - log_root - 4.0 * std::log(stretch) -
           2.0 * std::log(2.0 * kPi);
  };
  const double calm = std::log(1.0 - kJumps) + logNormal(1.0);
  const double jump = std::log(kJumps) + logNormal(kJumpStretch);
  const double larger = std::max(calm, jump);
  return std::log(kReturns) + larger + std::log(std::exp(calm - larger) + std::exp(jump - larger));
}

void LiveTrack::resume(const LiveTrack& lost) {
  id_ = lost.id_;
  hits_ += lost.hits_;
}

Corroboration LiveTrack::corroborationOf(const std::string& sensor, Time time,
                                         const SensorGuard& guard) const {
  Corroboration corroboration;
  std::array<std::array<double, kMostSources>, 2> innovations;
  for (const Source& source : sources_) {
    if (source.sensor == sensor) {
      corroboration.has_sensor = guard.sees(seconds(time - source.last_sighting));
    } else if (isMature() && guard.mayCorroborate(source.sensor, seconds(time - source.last_sighting))) {
      for (int channel = 0; channel < 2; ++channel)
        innovations[channel][corroboration.others] = source.innovation(channel);
      ++corroboration.others;
    }
  }
  for (int channel = 0; channel < 2; ++channel)
    corroboration.shared(channel) = signedMedian(innovations[channel].data(), corroboration.others);
  return corroboration;
}

/// `R`: covariance of the scan's sighting in the chart, by what is known of its sensor [rad^2].
void LiveTrack::noteSource(const Scan& scan, const Eigen::Vector2d& innovation, const Eigen::Matrix2d& R) {
  auto source = std::find_if(sources_.begin(), sources_.end(),
                             [&](const Source& known) { return known.sensor == scan.sensor; });
  if (source == sources_.end()) {
    if (sources_.size() >= kMostSources) return;
    source =
        sources_.insert(source, Source{scan.sensor, scan.time, innovation, 0.0, Eigen::Vector2d::Zero()});
  }
  source->innovation += kSourceMemory * (innovation - source->innovation);
  source->information *= std::exp(-seconds(scan.time - source->last_sighting) / kInformationMemory);
  source->information += 1.0 / R.trace();
  source->last_sighting = scan.time;

  // Sightings that are calmer than stated have a slowly varying error in the stated accuracy beside their
  // noise.
  const Eigen::Vector2d noise = scan.noise_scale * estimator_->noiseScale();
  const Eigen::Vector2d share = (Eigen::Vector2d::Ones() - kNoiseMargin * noise).cwiseMax(0.0);
  source->bias = share.cwiseProduct(R.diagonal()) / scan.noise_scale;
}

/// Variance of the slowly varying error of the position, in the chart [rad^2]: each sensor's by its share in
/// the information of the last seconds.
Eigen::Vector2d LiveTrack::biasVariance(Time time) const {
  double sum = 0.0;
  Eigen::Vector2d variance = Eigen::Vector2d::Zero();
  for (const Source& source : sources_) {
    const double information =
        source.information * std::exp(-seconds(time - source.last_sighting) / kInformationMemory);
    sum += information;
    variance += information * information * source.bias;
  }
  return sum > 0.0 ? Eigen::Vector2d(variance / (sum * sum)) : variance;
}

double LiveTrack::limit(double silence) const {
  return std::max(silence, kPaces * interval_);
}

bool LiveTrack::isDeadTentative(const LifecycleParams& lifecycle) const {
  if (lifecycle.by_existence) return existence_.gain() < kHopeless;
  return scans_ - static_cast<int>(hits_) > lifecycle.confirm_scans - lifecycle.confirm_hits;
}

bool LiveTrack::isDead(Time time, const LifecycleParams& lifecycle, bool adapt_gate) {
  const double silence = seconds(time - last_sighting_);
  const auto misses = static_cast<int>(misses_);
  const bool is_given_up = silence > limit(lifecycle.delete_silence) ||
                           (!lifecycle.by_existence && misses >= lifecycle.delete_misses);
  if (status_ == TrackStatus::tentative && (is_given_up || isDeadTentative(lifecycle))) return true;
  const AngularState& state = stateAt(time);
  if (!isUsable(state)) return true;
  if (status_ == TrackStatus::tentative) return false;

  const Eigen::Matrix2d R = noiseCovariance(last_covariance_, estimator_->noiseScale());
  const Eigen::Matrix2d S = gateScale(adapt_gate) * (state.anglesCovariance() + R);
  const Eigen::Vector2d stated = (last_covariance_ / last_noise_scale_).diagonal();
  const Eigen::Vector2d spread = S.diagonal().cwiseQuotient(R.diagonal().cwiseMax(stated)).cwiseSqrt();
  if (spread.maxCoeff() > lifecycle.max_spread) return true;
  const bool coasts = silence > limit(lifecycle.coast_silence) || misses >= lifecycle.coast_misses;
  status_ = coasts ? TrackStatus::coasting : TrackStatus::confirmed;

  const double existence = lifecycle.by_existence ? existence_.probability() : 1.0;
  if (is_given_up || existence < lifecycle.show_existence) lost_ = true;
  return lost_ && silence > limit(lifecycle.remember);
}

Track LiveTrack::report(Time time, const GateParams& gate, bool adapt_gate,
                        const LifecycleParams& lifecycle) const {
  Track track;
  track.id = id_;
  track.status = status_;
  AngularState state = stateAt(time);
  state.covariance.diagonal().head<2>() += biasVariance(time);
  track.state = chart_.toTracking(state);
  track.last_sighting = last_sighting_;
  track.hits = hits_;
  track.misses = misses_;
  track.existence = existence_.probability();

  // The next sighting is expected one usual interval later.
  AngularState next = *estimator_->stateAt(time + durationOf(interval_));
  const Eigen::Matrix2d R = noiseCovariance(last_covariance_, estimator_->noiseScale());
  const Gate in_chart = gateOf(next, R, gate, gateScale(adapt_gate));
  next.covariance.topLeftCorner<2, 2>() = in_chart.covariance;
  const AngularState in_tracking = chart_.toTracking(next);
  track.gate.centre = in_tracking.angles();
  track.gate.covariance = in_tracking.anglesCovariance();
  track.gate.half_width =
      (gateThreshold(gate) * track.gate.covariance.diagonal()).cwiseSqrt().cwiseMin(gate.max_half_width);

  for (const Source& source : sources_) {
    if (seconds(time - source.last_sighting) <= limit(lifecycle.delete_silence))
      track.sources.push_back(source.sensor);
  }
  std::sort(track.sources.begin(), track.sources.end());
  return track;
}

}  // namespace sightline::core
