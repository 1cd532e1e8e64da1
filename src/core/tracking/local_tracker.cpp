#include "sightline/core/tracking/local_tracker.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace sightline::core {
namespace {

/// Density of the rates of a new target, as far as is known: 0.3 rad/s in each angle [1/(rad/s)^2].
constexpr double kBirthRateDensity = 1.0 / (2.0 * 3.14159265358979 * 0.3 * 0.3);
constexpr std::size_t kMostScans = 4096;  // that can be processed again
constexpr int kStatesPerLag = 8;          // that are kept for rolling back
constexpr std::size_t kMostChanges = 64;  // of sensors' verdicts that are remembered

bool hasUsableNumbers(const Sighting& sighting) {
  return sighting.direction.allFinite() && std::abs(sighting.direction.squaredNorm() - 1.0) < 1e-6 &&
         sighting.covariance.allFinite() && sighting.covariance.trace() > 0.0;
}

bool isSame(const SensorChange& a, const SensorChange& b) {
  return a.sensor == b.sensor && a.change.time == b.change.time && a.change.verdict == b.change.verdict;
}

/// The last of a list of changes.
void keepTheLast(std::vector<SensorChange>& changes) {
  if (changes.size() > kMostChanges) changes.erase(changes.begin());
}

/// The scan with its noise taken for `noise_scale` times as large.
Scan withNoise(const Scan& scan, double noise_scale) {
  Scan scaled = scan;
  scaled.noise_scale *= noise_scale;
  for (Sighting& sighting : scaled.sightings) sighting.covariance *= noise_scale;
  return scaled;
}

/// A scan's usable sightings, with their places in it and the verdict on the others.
struct Sifted {
  Scan scan;
  std::vector<std::size_t> place;
  std::vector<Association> verdicts;
};

Sifted sift(const Scan& scan, std::size_t most) {
  Sifted sifted;
  sifted.scan = scan;
  sifted.scan.sightings.clear();
  sifted.verdicts.resize(scan.sightings.size());
  for (std::size_t j = 0; j < scan.sightings.size(); ++j) {
    Association& verdict = sifted.verdicts[j];
    verdict.sighting = static_cast<std::uint32_t>(j);
    verdict.decision = Decision::rejected_input;
    if (!hasUsableNumbers(scan.sightings[j])) {
      verdict.reason = "direction is no finite unit vector or its covariance is not finite and positive";
    } else if (sifted.scan.sightings.size() >= most) {
      verdict.reason = "scan has " + std::to_string(scan.sightings.size()) +
                       " sightings, more than max_sightings " + std::to_string(most) +
                       ": raise it, or the sensor's threshold";
    } else {
      sifted.place.push_back(j);
      sifted.scan.sightings.push_back(scan.sightings[j]);
    }
  }
  return sifted;
}

/// A late scan can be put up to max_lag back, and from there a sensor's scans are processed again over the
/// roll-back after an alarm.
TimelineParams timelineParams(const LocalTrackerParams& params) {
  const double roll_back = params.guard.enabled ? params.guard.roll_back : 0.0;
  TimelineParams timeline;
  timeline.span = params.max_lag + roll_back;
  timeline.interval = std::max(params.max_lag, roll_back / 2.0) / kStatesPerLag;
  timeline.most_items = kMostScans;
  return timeline;
}

}  // namespace

LocalTracker::LocalTracker(const LocalTrackerParams& params)
    : params_(params), state_(firstState(Time{}, 1)), scans_(timelineParams(params)) {
  if (params.max_tracks < 1 || params.max_sightings < 1 || !(params.max_lag >= 0.0)) {
    throw std::invalid_argument(
        "LocalTrackerParams: max_tracks and max_sightings >= 1, max_lag >= 0 are required");
  }
  makeEstimator(params.estimator);  // refuses what cannot work before the first sighting comes
}

LocalTracker::State LocalTracker::firstState(Time time, std::uint32_t next_id) const {
  return {time,
          next_id,
          {},
          NoiseCalibration(params_.noise_calibration),
          DetectionCalibration(params_.detection),
          {},
          SensorGuard(params_.guard),
          {}};
}

ScanReport LocalTracker::onScan(const Scan& scan) {
  Sifted sifted = sift(scan, static_cast<std::size_t>(params_.max_sightings));
  ScanReport result;
  result.dropped = refusalOf(sifted.scan);
  if (result.dropped.empty()) {
    putInPlace(sifted.scan, result);
    for (std::size_t k = 0; k < result.associations.size(); ++k) {
      result.associations[k].sighting = static_cast<std::uint32_t>(sifted.place[k]);
      sifted.verdicts[sifted.place[k]] = std::move(result.associations[k]);
    }
  } else {
    for (const std::size_t place : sifted.place) sifted.verdicts[place].reason = result.dropped;
  }
  result.associations = std::move(sifted.verdicts);
  result.time = state_.time;
  result.tracks = report();
  return result;
}

std::string LocalTracker::refusalOf(const Scan& scan) const {
  const double lateness = seconds(state_.time - scan.time);
  const bool anything_before = !scans_.empty();
  if (anything_before && lateness > params_.max_lag) {
    std::ostringstream why;
    why << "late: " << lateness << " s older than the newest scan, more than max_lag " << params_.max_lag
        << " s";
    return why.str();
  }
  if (anything_before && scan.time < scans_[0].before->time) {
    return "late: more than " + std::to_string(kMostScans) + " scans have come after it";
  }
  if (scans_.holds(scan)) return "duplicate: this exposure of " + scan.sensor + " has been taken already";
  return {};
}

void LocalTracker::startAnew(Time time) {
  state_ = firstState(time, state_.next_id);
  scans_.clear();
}

/// Processes the scan at its place in time; what had been processed after it is processed again.
void LocalTracker::putInPlace(const Scan& scan, ScanReport& result) {
  const std::size_t index = scans_.insert(scan);
  const bool is_late = index < scans_.next();
  // From the scan before it on, so that states are kept at the same places as in order.
  if (is_late) scans_.restore(index == 0 ? 0 : index - 1, state_);
  for (; scans_.next() < scans_.size(); scans_.advance()) {
    const std::size_t k = scans_.next();
    scans_.keepIfDue(state_);
    const double calibration = state_.calibration.scale(scans_[k].item.sensor);
    std::vector<Association> decisions = processNext();
    if (k != index) continue;
    result.associations = std::move(decisions);
    result.noise_scale = calibration * scans_[k].use;
  }
  scans_.close(state_.time);
  scans_.dropClosed();
  result.changes = newChanges();
}

/// The next scan in order of time: the whole of tracking.
std::vector<Association> LocalTracker::processNext() {
  const std::size_t k = scans_.next();
  const Scan scan = calibrated(scans_[k].item);
  scans_.use(k, state_.guard.noiseScale(scan.sensor));
  state_.time = scan.time;
  deleteTracks(scan.time);
  Look look = lookAt(scan, scans_[k].use);
  if (params_.guard.enabled) {
    state_.guard.watch(scan, look.predictions, look.pairing, look.corroboration);
    if (const auto change = state_.guard.judge(scan.time, scan.sensor)) {
      note(*change);
      const bool is_harmful = change->change.verdict != SensorVerdict::healthy && !change->undecided;
      if (is_harmful) return processAgain(*change);
    }
  }
  return settle(scan, scans_[k].use, look);
}

/// After an alarm by the next scan: rolls back to when the change began, and processes the scans from there
/// to this one with what is known now of the sensor. The others are watched anew, against tracks that it no
/// longer harms; they are judged when their next scan comes.
std::vector<Association> LocalTracker::processAgain(const SensorChange& change) {
  const SensorGuard seen = state_.guard;
  std::vector<SensorChange> changes = state_.changes;
  const std::size_t alarm = scans_.next();
  const Time earliest = scans_[alarm].item.time - durationOf(params_.guard.roll_back);
  const std::size_t first = scans_.firstNotBefore(std::max(change.change.began, earliest));
  const std::size_t from = scans_.rollBack(first, state_);
  for (std::size_t k = first; k <= alarm; ++k) {
    if (scans_[k].item.sensor == change.sensor) scans_.use(k, seen.noiseScale(change.sensor));
  }
  const Time since = scans_[from].item.time;
  state_.guard.adopt(seen, since);
  std::vector<Association> decisions;
  for (std::size_t k = from; k <= alarm; ++k) {
    scans_.keepIfDue(state_);
    const Scan scan = calibrated(scans_[k].item);
    state_.time = scan.time;
    deleteTracks(scan.time);
    Look look = lookAt(scan, scans_[k].use);
    if (!seen.changedSince(scan.sensor, since))
      state_.guard.watch(scan, look.predictions, look.pairing, look.corroboration);
    decisions = settle(scan, scans_[k].use, look);
    if (k < alarm) scans_.advance();
  }
  state_.changes = std::move(changes);
  return decisions;
}

void LocalTracker::note(const SensorChange& change) {
  state_.changes.push_back(change);
  keepTheLast(state_.changes);
}

/// Changes that have not been reported; a scan that comes late must not report them twice.
std::vector<SensorChange> LocalTracker::newChanges() {
  std::vector<SensorChange> fresh;
  for (const SensorChange& change : state_.changes) {
    const auto isIt = [&](const SensorChange& told) { return isSame(told, change); };
    if (std::any_of(told_.begin(), told_.end(), isIt)) continue;
    fresh.push_back(change);
    told_.push_back(change);
    keepTheLast(told_);
  }
  return fresh;
}

/// What the tracks expect of a scan, and who would take what.
LocalTracker::Look LocalTracker::lookAt(const Scan& scan, double noise_scale) {
  const bool is_scaled = noise_scale != 1.0 && std::isfinite(noise_scale);
  Look look;
  look.predictions = predict(scan);
  if (const double variance = state_.guard.clockVariance(scan.sensor); variance > 0.0) {
    for (TrackPrediction& prediction : look.predictions) {
      const Eigen::Vector2d rates = prediction.state.rates();
      prediction.stamp_covariance = variance * rates * rates.transpose();
    }
  }
  look.pairing = associate(is_scaled ? withNoise(scan, noise_scale) : scan, look.predictions, params_.gate,
                           state_.detection.clutterDensity(scan), params_.association);
  if (!params_.guard.enabled) return look;
  look.corroboration.reserve(state_.tracks.size());
  for (const LiveTrack& track : state_.tracks)
    look.corroboration.push_back(track.corroborationOf(scan.sensor, scan.time, state_.guard));
  return look;
}

/// The tracks take what is theirs, the rest may start new ones.
std::vector<Association> LocalTracker::settle(const Scan& scan, double noise_scale, Look& look) {
  const bool is_excluded = std::isinf(noise_scale);
  if (is_excluded) leaveOut(scan, look);
  const bool is_scaled = noise_scale != 1.0 && !is_excluded;
  const Scan scaled = is_scaled ? withNoise(scan, noise_scale) : Scan{};
  const Scan& used = is_scaled ? scaled : scan;
  const std::vector<std::uint32_t> fresh = update(used, look, is_excluded);
  if (!is_excluded) learnDetection(scan, look);
  for (const std::uint32_t id : fresh) reacquire(scan, id, look.pairing);
  start(used, look.pairing);
  mergeDuplicates(look);
  deleteTracks(scan.time);
  return std::move(look.pairing.decisions);
}

/// Takes the sightings of an excluded sensor away from the tracks that others see too. What may be the ghost
/// of such a track starts no track of its own.
void LocalTracker::leaveOut(const Scan& scan, Look& look) const {
  for (std::size_t j = 0; j < scan.sightings.size(); ++j) {
    for (std::size_t i = 0; i < look.predictions.size(); ++i) {
      const Corroboration& corroboration = look.corroboration[i];
      const bool is_yardstick = look.predictions[i].believed && corroboration.others > 0;
      if (!is_yardstick) continue;
      const bool is_taken = look.pairing.sighting_of[i] == static_cast<int>(j);
      const bool may_be_ghost =
          look.pairing.may_start[j] &&
          state_.guard.isExplainedByBias(scan.sensor, look.predictions[i], scan.sightings[j]);
      if (!is_taken && !may_be_ghost) continue;
      if (is_taken) look.pairing.sighting_of[i] = -1;
      look.pairing.may_start[j] = false;
      Association& decision = look.pairing.decisions[j];
      decision.decision = Decision::rejected_input;
      decision.track = look.predictions[i].id;
      decision.reason = "sensor " + scan.sensor + " is excluded: biased";
    }
  }
}

std::vector<TrackPrediction> LocalTracker::predict(const Scan& scan) {
  const double detection_probability = state_.detection.probability(scan);
  std::vector<TrackPrediction> predictions;
  predictions.reserve(state_.tracks.size());
  for (LiveTrack& track : state_.tracks) {
    predictions.push_back(track.predict(scan, detection_probability, params_.lifecycle, params_.adapt_gate));
  }
  return predictions;
}

/// The scan with its sensor's noise as it has been learnt.
Scan LocalTracker::calibrated(const Scan& scan) const {
  return withNoise(scan, state_.calibration.scale(scan.sensor));
}

/// What a settled track's sighting tells of its sensor's noise, unless the sensor's verdict has changed it.
void LocalTracker::calibrate(const Scan& scan, const Sighting& sighting, const LiveTrack& track,
                             const TrackPrediction& prediction) {
  if (!track.isMature() || state_.guard.noiseScale(scan.sensor) != 1.0) return;
  const Eigen::Vector2d innovation =
      angleDifference(prediction.chart.coordinatesOf(sighting.direction), prediction.state.angles());
  const Eigen::Matrix2d S = prediction.state.anglesCovariance() + prediction.noiseOf(sighting);
  state_.calibration.take(scan.sensor, innovation.cwiseAbs2(), S.diagonal(), prediction.noise_scale);
}

/// Tracks that were paired take their sighting, the others have missed; where the sensor is left out it says
/// nothing either way.
/// Returns the ids of the tracks that have come to be believed by it.
std::vector<std::uint32_t> LocalTracker::update(const Scan& scan, const Look& look, bool is_excluded) {
  std::vector<std::uint32_t> fresh;
  for (std::size_t i = 0; i < state_.tracks.size(); ++i) {
    LiveTrack& track = state_.tracks[i];
    const TrackPrediction& prediction = look.predictions[i];
    const int taken = look.pairing.sighting_of[i];
    if (taken >= 0) {
      const Sighting& sighting = scan.sightings[static_cast<std::size_t>(taken)];
      calibrate(scan, sighting, track, prediction);
      const bool was_tentative = !track.isEstablished() && !track.isLost();
      track.take(scan, sighting, prediction, look.pairing.possible[i], look.pairing.evidence[i],
                 params_.lifecycle);
      if (was_tentative && track.isEstablished()) fresh.push_back(track.id());
    } else if (!is_excluded || look.corroboration[i].others == 0) {
      track.miss(scan, prediction, look.pairing.evidence[i], params_.lifecycle);
    }
  }
  return fresh;
}

/// A track that has just come to be believed may be of a target that was lost, or is about to be: then it
/// goes on as its track, if that is more likely than a new target there.
void LocalTracker::reacquire(const Scan& scan, std::uint32_t id, AssociationResult& pairing) {
  auto& tracks = state_.tracks;
  const auto fresh =
      std::find_if(tracks.begin(), tracks.end(), [&](const LiveTrack& track) { return track.id() == id; });
  auto nearest = tracks.end();
  double most = 0.0;
  for (auto missing = tracks.begin(); missing != tracks.end(); ++missing) {
    if (!missing->isMissing()) continue;
    const double births = state_.detection.birthDensity(scan, seconds(scan.time - missing->lastSighting()));
    const double gain = missing->logDensityOfReturn(*fresh, scan.time) - std::log(births * kBirthRateDensity);
    if (gain <= most) continue;
    most = gain;
    nearest = missing;
  }
  if (nearest == tracks.end()) return;
  fresh->resume(*nearest);
  for (Association& decision : pairing.decisions) {
    if (decision.track == id) decision.track = fresh->id();
  }
  tracks.erase(nearest);
  std::sort(tracks.begin(), tracks.end(),
            [](const LiveTrack& a, const LiveTrack& b) { return a.id() < b.id(); });
}

/// What the scan tells of how its sensor sees settled targets, and of its false sightings.
void LocalTracker::learnDetection(const Scan& scan, const Look& look) {
  int looked = 0, seen = 0;
  std::vector<double> falseness(scan.sightings.size(), 1.0);
  for (std::size_t i = 0; i < look.predictions.size(); ++i) {
    const int taken = look.pairing.sighting_of[i];
    if (taken >= 0) falseness[static_cast<std::size_t>(taken)] = 1.0 - look.predictions[i].existence;
    if (!state_.tracks[i].isMature() || !look.predictions[i].is_in_view) continue;
    ++looked;
    if (taken >= 0) ++seen;
  }
  state_.detection.take(scan, looked, seen, falseness);
}

/// Sightings that nobody claims start tracks of their own, while there is room.
void LocalTracker::start(const Scan& scan, AssociationResult& pairing) {
  const double odds = state_.detection.newTargetOdds(scan);
  for (std::size_t j = 0; j < scan.sightings.size(); ++j) {
    if (!pairing.may_start[j] || state_.tracks.size() >= static_cast<std::size_t>(params_.max_tracks))
      continue;
    const std::uint32_t id = state_.next_id++;
    state_.tracks.emplace_back(id, scan, scan.sightings[j], makeEstimator(params_.estimator), odds);
    pairing.decisions[j] = Association{};
    pairing.decisions[j].sighting = static_cast<std::uint32_t>(j);
    pairing.decisions[j].track = id;
    pairing.decisions[j].decision = Decision::started_track;
  }
}

/// Of tracks that follow one target the oldest goes on.
void LocalTracker::mergeDuplicates(const Look& look) {
  const std::vector<std::uint32_t> duplicates =
      state_.duplicates.watch(look.predictions, look.pairing, params_.lifecycle.merge_scans);
  if (duplicates.empty()) return;
  auto& tracks = state_.tracks;
  tracks.erase(std::remove_if(tracks.begin(), tracks.end(),
                              [&](const LiveTrack& track) {
                                return std::binary_search(duplicates.begin(), duplicates.end(), track.id());
                              }),
               tracks.end());
}

void LocalTracker::deleteTracks(Time time) {
  auto& tracks = state_.tracks;
  tracks.erase(std::remove_if(tracks.begin(), tracks.end(),
                              [&](LiveTrack& track) {
                                return track.isDead(time, params_.lifecycle, params_.adapt_gate);
                              }),
               tracks.end());
}

std::vector<Track> LocalTracker::report() const {
  std::vector<Track> tracks;
  tracks.reserve(state_.tracks.size());
  for (const LiveTrack& track : state_.tracks) {
    if (track.isLost()) continue;
    tracks.push_back(track.report(state_.time, params_.gate, params_.adapt_gate, params_.lifecycle));
  }
  return tracks;
}

}  // namespace sightline::core
