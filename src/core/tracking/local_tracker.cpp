#include "sightline/core/tracking/local_tracker.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "sightline/core/tracking/new_beginning.h"
#include "sightline/core/tracking/published_tracks.h"
#include "sightline/core/tracking/second_looks.h"
#include "sightline/core/tracking/usable_sightings.h"

namespace sightline::core {
namespace {

constexpr std::size_t kMostScans = 4096;      // that can be processed again
constexpr std::uint32_t kHitsOfTracking = 6;  // of a track that is none by chance
constexpr int kStatesPerLag = 8;              // that are kept for rolling back

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
    : settings_(params), state_(firstState(Time{}, TrackIds())), scans_(timelineParams(params)) {
  if (params.max_tracks < 1 || params.max_sightings < 1 || !(params.max_lag >= 0.0)) {
    throw std::invalid_argument(
        "LocalTrackerParams: max_tracks and max_sightings >= 1, max_lag >= 0 are required");
  }
  makeEstimator(params.estimator);  // refuses what cannot work before the first sighting comes
}

ScanReport LocalTracker::onScan(const Scan& scan) {
  UsableSightings usable = usableSightings(scan, static_cast<std::size_t>(params().max_sightings));
  ScanReport result;
  result.refusal = refusalOf(usable.scan);
  if (result.refusal) {
    usable.rejectAll(textOf(*result.refusal));
  } else {
    usable.enter(putInPlace(usable.scan, result));
  }
  result.associations = std::move(usable.decisions);
  result.time = state_.time;
  result.tracks = report();
  if (!result.tracks.empty()) highest_id_ = std::max(highest_id_, result.tracks.back().id);
  return result;
}

std::optional<Refusal> LocalTracker::refusalOf(const Scan& scan) const {
  const double lateness = seconds(state_.time - scan.time);
  const bool anything_before = !scans_.empty();
  if (anything_before && lateness > params().max_lag) {
    std::ostringstream detail;
    detail << lateness << " s older than the newest scan, more than max_lag " << params().max_lag
           << " s: synchronise the clock of " << scan.sensor << ", bring its scans sooner, or raise max_lag";
    return Refusal{"late", detail.str()};
  }
  if (anything_before && scan.time < scans_[0].before->time) {
    return Refusal{"late", "more than " + std::to_string(kMostScans) + " scans have come after it"};
  }
  if (auto missing = whyNotWeighable(scan, params().estimator)) return missing;
  if (scans_.holds(scan))
    return Refusal{"duplicate",
                   "this exposure of " + scan.sensor + " has been taken already: publish each exposure once"};
  return std::nullopt;
}

/// Processes the scan at its place in time; what had been processed after it is processed again. Returns the
/// decisions on its sightings.
std::vector<Association> LocalTracker::putInPlace(const Scan& scan, ScanReport& result) {
  const std::size_t index = scans_.insert(scan);
  const bool is_late = index < scans_.next();
  // From the scan before it on, so that states are kept at the same places as in order.
  if (is_late) scans_.restore(index == 0 ? 0 : index - 1, state_);
  std::vector<Association> decisions;
  for (; scans_.next() < scans_.size(); scans_.advance()) {
    const std::size_t k = scans_.next();
    scans_.keepIfDue(state_);
    const double calibration = state_.calibration.scale(scans_[k].item.sensor);
    std::vector<Association> made = processNext();
    if (k != index) continue;
    decisions = std::move(made);
    result.use = scans_[k].use;
    result.use.noise_scale *= calibration;
  }
  scans_.close(state_.time);
  scans_.dropClosed();
  result.changes = reporter_.unreported(state_.changes);
  return decisions;
}

/// The next scan in order of time: the whole of tracking.
std::vector<Association> LocalTracker::processNext() {
  const std::size_t k = scans_.next();
  const std::string& sensor = scans_[k].item.sensor;
  followSettings(scans_[k].item.time);
  scans_.use(k, state_.guard.useOf(sensor));
  AssociatedScan associated = predictAndAssociate(k);
  if (settings().guard.enabled) {
    watch(associated);
    if (const auto change = state_.guard.judge(state_.time, sensor)) {
      remember(state_.changes, *change);
      const bool is_harmful = change->change.verdict != SensorVerdict::healthy && !change->undecided;
      if (is_harmful) return processAgain(*change);
    }
  }
  return updateTracks(associated);
}

/// After an alarm by the next scan: rolls back to when the change began, and processes the scans from there
/// to this one with what is known now of the sensor. The others are watched anew, against tracks that it no
/// longer harms; they are judged when their next scan comes.
std::vector<Association> LocalTracker::processAgain(const SensorChange& change) {
  const SensorGuard known = state_.guard;
  std::vector<SensorChange> changes = state_.changes;
  TrackIds ids = state_.ids;
  ids.remember(state_.tracks);
  const std::size_t alarm = scans_.next();
  const Time earliest = scans_[alarm].item.time - durationOf(settings().guard.roll_back);
  const std::size_t first = scans_.firstNotBefore(std::max(change.change.began, earliest));
  const std::size_t from = scans_.rollBack(first, state_);
  state_.ids = std::move(ids);
  for (std::size_t k = first; k <= alarm; ++k) {
    if (scans_[k].item.sensor == change.sensor) scans_.use(k, known.useOf(change.sensor));
  }
  const Time since = scans_[from].item.time;
  state_.guard.adopt(known, since);
  state_.guard.setThresholds(settings().guard.health);
  std::vector<Association> decisions;
  for (std::size_t k = from; k <= alarm; ++k) {
    scans_.keepIfDue(state_);
    followSettings(scans_[k].item.time);
    AssociatedScan associated = predictAndAssociate(k);
    if (!known.changedSince(associated.scan.sensor, since)) watch(associated);
    decisions = updateTracks(associated);
    if (k < alarm) scans_.advance();
  }
  state_.changes = std::move(changes);
  state_.ids.forget();
  return decisions;
}

/// What the tracks expect of scan k, by what has been learnt of its sensor's noise, and which sighting is
/// whose.
LocalTracker::AssociatedScan LocalTracker::predictAndAssociate(std::size_t k) {
  AssociatedScan associated;
  Scan& scan = associated.scan = calibrated(scans_[k].item);
  associated.is_excluded = scans_[k].use.is_excluded;
  associated.used = withNoise(scan, scans_[k].use.noise_scale);
  state_.time = scan.time;
  deleteTracks();
  associated.predictions = predict(scan);
  associated.result = associate(associated.used, associated.predictions, settings().gate,
                                state_.detection.clutterDensity(scan), settings().association,
                                isClear(scan, state_.tracks, state_.detection.clutter(scan)));
  if (!settings().guard.enabled) return associated;
  associated.corroboration.reserve(state_.tracks.size());
  for (const LiveTrack& track : state_.tracks)
    associated.corroboration.push_back(track.corroborationOf(scan.sensor, scan.time, state_.guard));
  return associated;
}

/// The tracks are updated with what is theirs, the rest may start new ones. Returns the decisions.
std::vector<Association> LocalTracker::updateTracks(AssociatedScan& associated) {
  if (associated.is_excluded) leaveOut(associated);
  const std::vector<std::uint32_t> confirmed = updateOrMiss(associated);
  if (!associated.is_excluded) learnDetection(associated);
  for (const std::uint32_t id : confirmed) reacquire(id, associated);
  startBranches(associated);
  startTracks(associated);
  std::sort(state_.tracks.begin(), state_.tracks.end(),
            [](const LiveTrack& a, const LiveTrack& b) { return a.id() < b.id(); });
  deleteDuplicates(associated);
  deleteTracks();
  const bool is_tracking =
      std::any_of(state_.tracks.begin(), state_.tracks.end(), [](const LiveTrack& track) {
        return !track.lifecycle().isTentative() && track.lifecycle().hitsSinceFound() >= kHitsOfTracking;
      });
  if (!is_tracking && state_.calibration.takeUntracked(scans_[scans_.next()].item)) beginAnew(associated);
  return std::move(associated.result.decisions);
}

/// Takes the sightings of an excluded sensor away from the tracks that others see too. What is explained by
/// the sensor's bias as a sighting of such a track starts no track of its own.
void LocalTracker::leaveOut(AssociatedScan& associated) const {
  const Scan& scan = associated.scan;
  AssociationResult& result = associated.result;
  for (std::size_t j = 0; j < scan.sightings.size(); ++j) {
    for (std::size_t i = 0; i < associated.predictions.size(); ++i) {
      const TrackPrediction& prediction = associated.predictions[i];
      const bool is_corroborated = prediction.believed && associated.corroboration[i].others > 0;
      if (!is_corroborated) continue;
      const bool is_taken = result.sighting_of[i] == static_cast<int>(j);
      const bool may_be_its_own =
          result.may_start[j] && state_.guard.isExplainedByBias(scan.sensor, prediction, scan.sightings[j]);
      if (!is_taken && !may_be_its_own) continue;
      if (is_taken) result.sighting_of[i] = -1;
      result.may_start[j] = false;
      Association& decision = result.decisions[j];
      decision.decision = Decision::rejected_input;
      decision.track = prediction.id;
      decision.reason = "sensor " + scan.sensor + " is excluded: biased";
    }
  }
}

std::vector<TrackPrediction> LocalTracker::predict(const Scan& scan) {
  const ScanSensor sensor{state_.detection.probability(scan), state_.detection.interval(scan),
                          isClear(scan, state_.tracks, state_.detection.clutter(scan))};
  const double stamp_variance = state_.guard.clockVariance(scan.sensor);
  std::vector<TrackPrediction> predictions;
  predictions.reserve(state_.tracks.size());
  for (LiveTrack& track : state_.tracks) {
    predictions.push_back(track.predict(scan, sensor, settings().lifecycle, settings().adapt_gate));
    if (stamp_variance <= 0.0) continue;
    const Eigen::Vector2d rates = predictions.back().state.rates();
    predictions.back().stamp_covariance = stamp_variance * rates * rates.transpose();
  }
  keepApart(predictions);
  return predictions;
}

/// The scan with its sensor's noise as it has been learnt.
Scan LocalTracker::calibrated(const Scan& scan) const {
  return withNoise(scan, state_.calibration.scale(scan.sensor));
}

void LocalTracker::watch(const AssociatedScan& associated) {
  state_.guard.watch(associated.scan, associated.predictions, associated.result, associated.corroboration);
}

/// Associated tracks are updated with their sighting, the others have missed; where the sensor is left out it
/// says nothing either way. Returns the ids of the tracks that have been confirmed by it.
std::vector<std::uint32_t> LocalTracker::updateOrMiss(const AssociatedScan& associated) {
  const Scan& scan = associated.used;
  const AssociationResult& result = associated.result;
  std::vector<std::uint32_t> confirmed;
  for (std::size_t i = 0; i < state_.tracks.size(); ++i) {
    LiveTrack& track = state_.tracks[i];
    const TrackPrediction& prediction = associated.predictions[i];
    const int own = result.sighting_of[i];
    if (own >= 0) {
      const Sighting& sighting = scan.sightings[static_cast<std::size_t>(own)];
      calibrate(scan, sighting, track, prediction);
      const bool was_tentative = track.lifecycle().isTentative();
      track.update(scan, sighting, prediction, result.possible[i], result.evidence[i], settings().lifecycle);
      if (was_tentative && track.lifecycle().isEstablished()) confirmed.push_back(track.id());
    } else if (!associated.is_excluded || associated.corroboration[i].others == 0) {
      track.miss(scan, prediction, result.evidence[i], settings().lifecycle);
    }
  }
  return confirmed;
}

/// What a mature track's sighting tells of its sensor's noise, unless the sensor's verdict has changed it.
void LocalTracker::calibrate(const Scan& scan, const Sighting& sighting, const LiveTrack& track,
                             const TrackPrediction& prediction) {
  if (!track.lifecycle().isMature() || !state_.guard.useOf(scan.sensor).isAsStated()) return;
  const Eigen::Vector2d innovation =
      angleDifference(prediction.chart.coordinatesOf(sighting.direction), prediction.state.angles());
  const Eigen::Matrix2d S = prediction.state.anglesCovariance() + prediction.noiseOf(sighting);
  state_.calibration.take(scan.sensor, innovation.cwiseAbs2(), S.diagonal(), prediction.noise_scale);
}

/// What the scan tells of how its sensor sees the targets of mature tracks, and of its false sightings.
void LocalTracker::learnDetection(const AssociatedScan& associated) {
  int looked = 0, seen = 0;
  std::vector<double> falseness(associated.scan.sightings.size(), 1.0);
  for (std::size_t i = 0; i < associated.predictions.size(); ++i) {
    const TrackPrediction& prediction = associated.predictions[i];
    const int own = associated.result.sighting_of[i];
    if (own >= 0) falseness[static_cast<std::size_t>(own)] = 1.0 - prediction.existence;
    if (!state_.tracks[i].lifecycle().isMature() || !prediction.is_in_view) continue;
    ++looked;
    if (own >= 0) ++seen;
  }
  state_.detection.take(associated.scan, looked, seen, falseness);
}

/// (S-43): a track that has just been confirmed may be of a target that was lost, or is about to be: then it
/// goes on as that track, if that is more likely than a new target there.
void LocalTracker::reacquire(std::uint32_t id, AssociatedScan& associated) {
  const Scan& scan = associated.scan;
  auto& tracks = state_.tracks;
  const auto fresh =
      std::find_if(tracks.begin(), tracks.end(), [&](const LiveTrack& track) { return track.id() == id; });
  const double noise = state_.calibration.suspectedScale(scan.sensor);
  auto likeliest = tracks.end();
  double most = 0.0;
  for (auto missing = tracks.begin(); missing != tracks.end(); ++missing) {
    if (!missing->lifecycle().isMissing()) continue;
    const double silence = seconds(scan.time - missing->lifecycle().lastSighting());
    const double births = state_.detection.birthDensity(scan, silence);
    const double gain =
        missing->logDensityOfReturn(*fresh, scan.time, noise) - fresh->logDensityOfBirth(scan.time, births);
    if (gain <= most) continue;
    most = gain;
    likeliest = missing;
  }
  if (likeliest == tracks.end()) return;
  fresh->resume(*likeliest);
  for (Association& decision : associated.result.decisions) {
    if (decision.track == id) decision.track = fresh->id();
  }
  tracks.erase(likeliest);
}

/// (S-96): the noise that a sensor with one target states has been found far too small.
void LocalTracker::beginAnew(AssociatedScan& associated) {
  const Scan scan = calibrated(scans_[scans_.next()].item);
  Association& decision = associated.result.decisions.front() = Association{};
  decision.decision = Decision::started_track;
  decision.track =
      begunAnew(state_.tracks, scan, makeEstimator(settings().estimator),
                state_.detection.newTargetOdds(scan), state_.detection.interval(scan), state_.ids);
}

/// Second tracks of targets seen once, for sightings that may be theirs.
void LocalTracker::startBranches(const AssociatedScan& associated) {
  std::vector<LiveTrack> branches = branchesOf(state_.tracks, associated.used, associated.predictions,
                                               associated.result, settings().lifecycle, state_.ids);
  for (LiveTrack& branch : branches)
    if (state_.tracks.size() < static_cast<std::size_t>(settings().max_tracks))
      state_.tracks.push_back(std::move(branch));
}

/// Sightings that nobody claims start tracks of their own, while there is room.
void LocalTracker::startTracks(AssociatedScan& associated) {
  const Scan& scan = associated.used;
  const double odds = state_.detection.newTargetOdds(scan);
  const RevisitTime interval = state_.detection.interval(scan);
  for (std::size_t j = 0; j < scan.sightings.size(); ++j) {
    const bool has_room = state_.tracks.size() < static_cast<std::size_t>(settings().max_tracks);
    if (!associated.result.may_start[j]) continue;
    Association& decision = associated.result.decisions[j] = Association{};
    decision.sighting = static_cast<std::uint32_t>(j);
    if (!has_room) {
      decision.decision = Decision::rejected_input;
      decision.reason = "limit: there are max_tracks " + std::to_string(settings().max_tracks) +
                        " tracks already, it starts none: raise max_tracks";
      continue;
    }
    const TrackOrigin origin{scan.time, scan.sensor, decision.sighting};
    const std::uint32_t id = state_.ids.idOf(origin);
    state_.tracks.emplace_back(id, origin, scan, scan.sightings[j], makeEstimator(settings().estimator), odds,
                               interval);
    decision.track = id;
    decision.decision = Decision::started_track;
  }
}

/// Of tracks that follow one target the oldest goes on.
void LocalTracker::deleteDuplicates(const AssociatedScan& associated) {
  const std::vector<std::uint32_t> duplicates =
      state_.duplicates.watch(associated.predictions, associated.result, settings().lifecycle.merge_scans);
  const auto isDuplicate = [&](const LiveTrack& track) {
    return std::binary_search(duplicates.begin(), duplicates.end(), track.id());
  };
  auto& tracks = state_.tracks;
  tracks.erase(std::remove_if(tracks.begin(), tracks.end(), isDuplicate), tracks.end());
}

/// Brings every track's status up to date and deletes those that are over.
void LocalTracker::deleteTracks() {
  auto& tracks = state_.tracks;
  for (LiveTrack& track : tracks) track.updateStatus(state_.time, settings().lifecycle);
  const auto isOver = [this](const LiveTrack& track) {
    return track.isOver(state_.time, settings().lifecycle, settings().adapt_gate, state_.calibration);
  };
  tracks.erase(std::remove_if(tracks.begin(), tracks.end(), isOver), tracks.end());
}

std::vector<Track> LocalTracker::report() const {
  std::vector<Track> tracks;
  tracks.reserve(state_.tracks.size());
  for (const LiveTrack& track : state_.tracks) {
    if (track.lifecycle().isLost()) continue;
    Track reported = track.report(state_.time, params().gate, params().adapt_gate, params().lifecycle);
    if (isTrack(reported))
      tracks.push_back(std::move(reported));  // else unseen, until a sighting makes it one
  }
  return tracks;
}

}  // namespace sightline::core
