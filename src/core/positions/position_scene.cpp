#include "sightline/core/positions/position_scene.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include <Eigen/Cholesky>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kRecent = 1.5;                 // [s] of measurements that are kept to start a target with
constexpr std::size_t kMostRecent = 64;         // of one local track
constexpr double kUnknownExistence = 0.5;       // of a track whose tracker states none
constexpr double kMisfitOfContradiction = 6.0;  // above which a lost target is dissolved and not remembered

Eigen::Matrix3d across(const Eigen::Vector3d& direction) {
  return Eigen::Matrix3d::Identity() - direction * direction.transpose();
}

PositionSceneParams checked(const PositionSceneParams& params) {
  const auto require = [](bool ok, const char* what) {
    if (!ok) throw std::invalid_argument(std::string("PositionSceneParams: ") + what + " is required");
  };
  require(params.decision_interval > 0.0, "decision_interval > 0 s");
  require(params.claim_gate > 0.0 && params.contradiction > 0.0 && params.merge_gate > 0.0,
          "claim_gate, contradiction and merge_gate > 0");
  require(params.claim_decisions >= 1, "claim_decisions >= 1");
  require(params.contradiction_time > 0.0, "contradiction_time > 0 s");
  require(params.confirm_after >= 0.0 && params.confirm_pair_after >= 0.0 && params.remember_for >= 0.0,
          "confirm_after, confirm_pair_after, remember_for >= 0 s");
  require(params.coast_after > 0.0 && params.delete_after > 0.0, "coast_after, delete_after > 0 s");
  require(params.max_local_tracks >= 1 && params.max_targets >= 1, "max_local_tracks, max_targets >= 1");
  return params;
}

}  // namespace

PositionScene::PositionScene(const PositionSceneParams& params)
    : params_(std::make_shared<const PositionSceneParams>(checked(params))),
      hypotheses_(params.hypotheses),
      review_(params.hypotheses),
      alignment_(params.alignment),
      common_alignment_(params.alignment),
      corrections_(params.correction, params.alignment) {
  // Both throw for a parameter out of range.
  static_cast<void>(PositionEstimator(params.estimator));
  static_cast<void>(StationNoise(params.noise));
}

int PositionScene::trackerNumber(const std::string& name) {
  const auto found =
      std::find_if(trackers_.begin(), trackers_.end(), [&](const Tracker& t) { return t.name == name; });
  if (found != trackers_.end()) return static_cast<int>(found - trackers_.begin());
  trackers_.emplace_back();
  trackers_.back().name = name;
  return static_cast<int>(trackers_.size()) - 1;
}

int PositionScene::sensorNumber(int tracker, const std::string& name) {
  const auto found = std::find_if(sensors_.begin(), sensors_.end(), [&](const Sensor& sensor) {
    return sensor.tracker == tracker && sensor.name == name;
  });
  if (found != sensors_.end()) return static_cast<int>(found - sensors_.begin());
  sensors_.push_back({tracker, name, StationNoise(params_->noise)});
  return static_cast<int>(sensors_.size()) - 1;
}

std::string PositionScene::nameOf(const ViewKey& key) const {
  return trackers_[static_cast<std::size_t>(key.station)].name + "/" + std::to_string(key.track);
}

void PositionScene::take(const StationTracklet& in) {
  const int tracker = trackerNumber(in.tracker);
  const ViewKey key{tracker, in.track};
  if (!locals_.count(key) && static_cast<int>(locals_.size()) >= params_->max_local_tracks) return;
  Local& local = locals_[key];
  const int sensor = sensorNumber(tracker, in.tracklet.sensor);
  if (std::find(local.sensors.begin(), local.sensors.end(), sensor) == local.sensors.end())
    local.sensors.push_back(sensor);
  const Sighting sighting = rotate(in.tracklet.sighting, in.pose.R_metric_station);
  // One sighting's variance, or what the local tracker says of its track: that has its slow errors in it.
  const double white = 0.5 * sighting.covariance.trace() * std::max(in.tracklet.sightings, 1.0);
  local.reference = slowReference(std::max(white, local.stated_variance), white);

  StationMeasurement measurement;
  measurement.time = in.tracklet.time;
  measurement.station = sensor;
  measurement.ray.origin = in.pose.origin;
  measurement.ray.direction = sighting.direction.normalized();
  measurement.ray.covariance = sighting.covariance;
  measurement.ray.motion = RayMotion{Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero(), in.pose.velocity};
  if (local.view.ray.motion) {  // of the track: what a wrong clock is put right with
    measurement.ray.motion->rate = local.view.ray.motion->rate;
    measurement.ray.motion->covariance = local.view.ray.motion->covariance;
  }
  measurement.slow = sensors_[static_cast<std::size_t>(sensor)].noise.slowError(local.reference);
  local.recent.push_back(measurement);
  const auto old = std::find_if(local.recent.begin(), local.recent.end(), [&](const StationMeasurement& m) {
    return seconds(in.tracklet.time - m.time) <= kRecent;
  });
  local.recent.erase(local.recent.begin(), old);
  if (local.recent.size() > kMostRecent) local.recent.erase(local.recent.begin());

  const auto target = targets_.find(local.target);
  if (target == targets_.end()) return;
  const StationMeasurement used = corrected(key, measurement);
  note(local.target, in.tracklet.time, used);
  feed(target->second, used, local.reference);
}

void PositionScene::note(std::uint32_t target, Time taken, const StationMeasurement& measurement) {
  if (keeps_measurements_) taken_.push_back({target, taken, measurement});
}

std::vector<TakenMeasurement> PositionScene::handOut(Time begin, Time end) {
  const auto first_kept = std::find_if(taken_.begin(), taken_.end(),
                                       [end](const TakenMeasurement& taken) { return taken.taken >= end; });
  std::vector<TakenMeasurement> out;
  std::copy_if(taken_.begin(), first_kept, std::back_inserter(out),
               [begin](const TakenMeasurement& taken) { return taken.taken >= begin; });
  taken_.erase(taken_.begin(), first_kept);
  return out;
}

/// One more measurement of a target; its estimator is copied first when a snapshot shares it.
void PositionScene::feed(Target& target, const StationMeasurement& measurement, double reference) {
  if (target.estimator.use_count() > 1)
    target.estimator = std::make_shared<PositionEstimator>(*target.estimator);
  PositionEstimator& estimator = *target.estimator;
  const double misfit = estimator.misfit();
  const MeasurementUse use = estimator.update(measurement);
  if (use == MeasurementUse::refused) return;
  target.last_sighting = measurement.time;
  if (use == MeasurementUse::restarted) {
    target.lost = measurement.time;
    if (misfit > kMisfitOfContradiction) target.contradicted.clear();
  }
  if (use == MeasurementUse::started) {
    target.lost.reset();
    target.since = measurement.time;
  }
  if (const auto slow = estimator.slowErrorOf(measurement.station))
    sensors_[static_cast<std::size_t>(measurement.station)].noise.noteSlowError(*slow, reference,
                                                                                slow->since);
}

void PositionScene::take(const StationTracks& in) {
  const int number = trackerNumber(in.tracker);
  Tracker& tracker = trackers_[static_cast<std::size_t>(number)];
  tracker.views = in.views;
  tracker.origin = in.pose.origin;
  tracker.time = in.time;
  std::set<std::uint32_t> reported;
  const Eigen::Matrix3d& R = in.pose.R_metric_station;
  for (const Track& track : in.tracks) {
    const ViewKey key{number, track.id};
    if (!track.state.mean.allFinite() || !track.state.covariance.allFinite()) continue;
    if (!locals_.count(key) && static_cast<int>(locals_.size()) >= params_->max_local_tracks) continue;
    reported.insert(track.id);
    Local& local = locals_[key];
    if (!local.is_reported) local.since = in.time;
    local.time = in.time;
    local.is_reported = track.status == TrackStatus::confirmed;
    local.existence =
        std::isfinite(track.existence) ? std::clamp(track.existence, 0.0, 1.0) : kUnknownExistence;
    local.view.key = key;
    Ray& ray = local.view.ray;
    ray.origin = in.pose.origin;
    const Eigen::Vector2d angles = track.state.angles();
    const Eigen::Matrix<double, 3, 2> D = R * directionJacobian(angles);
    ray.direction = R * directionOf(angles);
    ray.covariance = symmetric(D * track.state.anglesCovariance() * D.transpose());
    RayMotion motion;
    motion.rate = D * track.state.rates();
    motion.covariance = symmetric(D * track.state.covariance.bottomRightCorner<2, 2>() * D.transpose());
    motion.origin_velocity = in.pose.velocity;
    ray.motion = motion;
    local.stated_variance = 0.5 * ray.covariance.trace();
  }
  for (auto it = locals_.lower_bound({number, 0}); it != locals_.end() && it->first.station == number;) {
    const bool is_gone =
        !reported.count(it->first.track) &&
        (it->second.recent.empty() || seconds(in.time - it->second.recent.back().time) > kFreshestView);
    if (!is_gone) {
      if (!reported.count(it->first.track)) it->second.is_reported = false;
      ++it;
      continue;
    }
    if (it->second.target) release(it->second.target, it->first);
    it = locals_.erase(it);
  }
  if (!decided_ || seconds(in.time - *decided_) >= params_->decision_interval) decide(in.time);
}

/// Its tracker reports it as confirmed, and did so just now.
bool PositionScene::speaksAt(const Local& local, Time now) {
  return local.is_reported && seconds(now - local.time) <= kFreshestView;
}

/// How many support it.
std::set<int> PositionScene::stationsOf(const Target& target) {
  std::set<int> stations;
  for (const ViewKey& key : target.supporters) stations.insert(key.station);
  return stations;
}

/// That its tracks are of one target, and not all of them false (P-17). `stations`: that look now.
double PositionScene::existenceOf(const Target& target, const Eigen::Vector3d& position,
                                  const std::vector<LookingStation>& stations) const {
  double all_false = 1.0;
  for (const ViewKey& key : target.supporters) all_false *= 1.0 - locals_.at(key).existence;
  const double missed =
      logMissed(position, stations, stationsOf(target), params_->hypotheses.detection_probability);
  const double log_odds = std::clamp(target.log_odds + missed, 0.0, kMostLogOdds);
  return (1.0 - all_false) / (1.0 + std::exp(-log_odds));
}

/// A local track no longer supports a target.
void PositionScene::release(std::uint32_t id, const ViewKey& key) {
  const auto local = locals_.find(key);
  if (local != locals_.end()) local->second.target = 0;
  const auto target = targets_.find(id);
  if (target == targets_.end()) return;
  target->second.supporters.erase(key);
  target->second.contradicted.erase(key);
}

void PositionScene::dissolve(std::uint32_t id) {
  const auto target = targets_.find(id);
  if (target == targets_.end()) return;
  for (const ViewKey& key : std::set<ViewKey>(target->second.supporters)) release(id, key);
  targets_.erase(id);
}

/// What a local track says `now`, put right by what is known of its station.
LocalView PositionScene::viewAt(const Local& local, Time now) const {
  LocalView view = statedViewAt(local, now);
  if (const StationCorrection* correction = corrections_.of(view.key.station))
    view.ray = core::corrected(view.ray, *correction);
  return view;
}

/// What a local track says `now`: moved on at its rates, slow errors of its sensors in the covariance.
LocalView PositionScene::statedViewAt(const Local& local, Time now) const {
  LocalView view = local.view;
  const double h = seconds(now - local.time);
  Ray& ray = view.ray;
  double slow = 0.0, time_constant = 1.0;
  for (const int sensor : local.sensors) {
    const SlowError error = sensors_[static_cast<std::size_t>(sensor)].noise.slowError(local.reference);
    if (error.variance <= slow) continue;
    slow = error.variance;
    time_constant = error.time_constant;
  }
  ray.direction = (ray.direction + h * ray.motion->rate).normalized();
  const Eigen::Matrix3d projection = across(ray.direction);
  ray.covariance = symmetric(projection * (ray.covariance + h * h * ray.motion->covariance) * projection) +
                   slow * projection;
  // What is learnt has a misalignment in it, which is what views are compared for.
  const double first = params_->noise.slow_scale * params_->noise.slow_scale * local.reference;
  view.slow = {std::min(slow, first), time_constant};
  ray.motion->rate = projection * ray.motion->rate;
  ray.motion->covariance = symmetric(projection * ray.motion->covariance * projection) +
                           2.0 * slow / (time_constant * time_constant) * projection;
  ray.origin += h * ray.motion->origin_velocity;
  return view;
}

void PositionScene::decide(Time now) {
  forget(now);
  checkSupporters(now);
  claim(now);
  startTargets(now);
  merge(now);
  learnAlignment(now);
  correctStations(now);
  decided_ = now;
}

/// Life of the targets.
void PositionScene::forget(Time now) {
  for (auto it = targets_.begin(); it != targets_.end();) {
    const std::uint32_t id = it->first;
    Target& target = it->second;
    ++it;
    const bool is_silent = seconds(now - target.last_sighting) > params_->delete_after;
    const bool is_forgotten = target.lost && seconds(now - *target.lost) > params_->remember_for;
    if (is_silent || is_forgotten || target.supporters.empty()) {
      dissolve(id);
      continue;
    }
    const auto state = target.estimator->stateAt(std::max(now, target.estimator->time().value_or(now)));
    const bool is_position = state && target.estimator->isPosition(*state);
    const double confirm_after = stationsOf(target).size() > 2
                                     ? params_->confirm_after
                                     : std::max(params_->confirm_after, params_->confirm_pair_after);
    if (is_position && seconds(now - target.since) >= confirm_after) target.is_confirmed = true;
  }
}

PositionOutput PositionScene::output(Time time) const {
  PositionOutput out;
  out.tracks.time = time;
  const std::vector<LookingStation> stations = lookingStations(time);
  for (const auto& [id, target] : targets_) {
    const auto state = target.estimator->stateAt(time);
    if (!state || !target.estimator->isPosition(*state)) continue;
    PositionTrack track;
    track.id = id;
    track.status = target.is_confirmed ? TrackStatus::confirmed : TrackStatus::tentative;
    if (seconds(time - target.last_sighting) > params_->coast_after) track.status = TrackStatus::coasting;
    track.position = state->mean.head<3>();
    track.velocity = state->mean.tail<3>();
    track.covariance = state->covariance;
    track.existence = existenceOf(target, track.position, stations);
    track.last_sighting = target.last_sighting;
    track.parallax = state->parallax;
    for (const ViewKey& key : target.supporters) track.sources.push_back(nameOf(key));
    std::sort(track.sources.begin(), track.sources.end());
    out.tracks.tracks.push_back(track);
  }
  out.report.time = decided_.value_or(time);
  out.report.is_complete = decision_.is_complete;
  std::map<ViewKey, Refusal> reasons;
  for (const RefusedCrossing& refused : decision_.refused) {
    RefusedCrossingReport report;
    for (const ViewKey& key : refused.candidate.members) report.sources.push_back(nameOf(key));
    report.position = refused.candidate.at.point;
    report.score = refused.candidate.score;
    report.margin = refused.candidate.margin;
    switch (refused.reason) {
      case CrossingRefusal::unlikely:
        report.reason = {"unlikely", "its tracks are better explained as targets that one station sees"};
        break;
      case CrossingRefusal::ghost:
        report.reason = {"ghost", "its tracks are better explained by other crossings"};
        break;
      case CrossingRefusal::ambiguous:
        report.reason = {"ambiguous",
                         "other crossings explain its tracks as well: a third station or time must tell"};
        break;
    }
    for (const ViewKey& key : refused.candidate.members) reasons[key] = report.reason;
    out.report.refused.push_back(report);
  }
  for (const auto& [key, local] : locals_) {
    const bool has_position =
        std::any_of(out.tracks.tracks.begin(), out.tracks.tracks.end(),
                    [id = local.target](const PositionTrack& track) { return track.id == id; });
    if (!local.is_reported || has_position) continue;
    const auto target = targets_.find(local.target);
    const auto reason = reasons.find(key);
    Refusal why{"one station only", "no other station has a track that crosses it with enough parallax"};
    if (target != targets_.end() && target->second.supporters.size() > 1)
      why = {"parallax too small", "the rays of its stations do not tell the range well enough"};
    else if (reason != reasons.end())
      why = reason->second;
    out.report.unlocated.push_back({nameOf(key), why});
  }
  std::sort(out.report.unlocated.begin(), out.report.unlocated.end(),
            [](const UnlocatedTrack& a, const UnlocatedTrack& b) { return a.source < b.source; });
  out.report.stations = stationReports();
  return out;
}

}  // namespace sightline::core
