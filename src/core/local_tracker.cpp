#include "sightline/core/local_tracker.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <tuple>

namespace sightline::core {
namespace {

constexpr double kClockJump = 5.0;  // lateness that is no mere latency [s]
constexpr int kScansOfAJump = 20;   // so late in a row: the clock went back
constexpr int kStatesPerLag = 8;    // states kept over max_lag, from which a late scan can start
constexpr std::size_t kMostRemembered = 4096;

bool hasUsableNumbers(const Sighting& sighting) {
  return sighting.direction.allFinite() && std::abs(sighting.direction.squaredNorm() - 1.0) < 1e-6 &&
         sighting.covariance.allFinite() && sighting.covariance.trace() > 0.0;
}

/// Order in which scans are followed: by time; at one instant by sensor, then by content, so that the order
/// of arrival does not matter.
bool precedes(const Scan& a, const Scan& b) {
  if (a.time != b.time) return a.time < b.time;
  if (a.sensor != b.sensor) return a.sensor < b.sensor;
  return std::lexicographical_compare(
      a.sightings.begin(), a.sightings.end(), b.sightings.begin(), b.sightings.end(),
      [](const Sighting& x, const Sighting& y) {
        return std::make_tuple(x.direction.x(), x.direction.y(), x.direction.z()) <
               std::make_tuple(y.direction.x(), y.direction.y(), y.direction.z());
      });
}

bool isSameExposure(const Scan& a, const Scan& b) {
  return a.time == b.time && a.sensor == b.sensor && a.sightings.size() == b.sightings.size() &&
         !precedes(a, b) && !precedes(b, a);
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

}  // namespace

LocalTracker::LocalTracker(const LocalTrackerParams& params) : params_(params) {
  if (params.max_tracks < 1 || params.max_sightings < 1 || !(params.max_lag >= 0.0)) {
    throw std::invalid_argument(
        "LocalTrackerParams: max_tracks and max_sightings >= 1, max_lag >= 0 are required");
  }
  makeEstimator(params.estimator);  // refuses what cannot work before the first sighting comes
}

ScanReport LocalTracker::onScan(const Scan& scan) {
  Sifted sifted = sift(scan, static_cast<std::size_t>(params_.max_sightings));
  ScanReport result;
  if (clockWentBack(scan)) {
    std::ostringstream notice;
    notice << "stamps went back by " << seconds(state_.time - scan.time)
           << " s: tracks given up, tracking goes on from there";
    result.notice = notice.str();
    startAnew(scan.time);
  }
  result.dropped = refusalOf(sifted.scan);
  if (result.dropped.empty()) {
    std::vector<Association> decisions = putInPlace(sifted.scan);
    for (std::size_t k = 0; k < decisions.size(); ++k) {
      decisions[k].sighting = static_cast<std::uint32_t>(sifted.place[k]);
      sifted.verdicts[sifted.place[k]] = std::move(decisions[k]);
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
  const bool anything_before = !remembered_.empty();
  if (anything_before && lateness > params_.max_lag) {
    std::ostringstream why;
    why << "late: " << lateness << " s older than the newest scan, more than max_lag " << params_.max_lag
        << " s";
    return why.str();
  }
  if (anything_before && scan.time < remembered_.front().before->time) {
    return "late: more than " + std::to_string(kMostRemembered) + " scans have come after it";
  }
  for (auto it = remembered_.rbegin(); it != remembered_.rend() && it->scan.time >= scan.time; ++it) {
    if (isSameExposure(it->scan, scan))
      return "duplicate: this exposure of " + scan.sensor + " has been taken already";
  }
  return {};
}

bool LocalTracker::clockWentBack(const Scan& scan) {
  const bool far_late =
      !remembered_.empty() && seconds(state_.time - scan.time) > std::max(kClockJump, 4.0 * params_.max_lag);
  late_in_a_row_ = far_late ? late_in_a_row_ + 1 : 0;
  return late_in_a_row_ >= kScansOfAJump;
}

void LocalTracker::startAnew(Time time) {
  state_.tracks.clear();
  state_.time = time;
  remembered_.clear();
  late_in_a_row_ = 0;
}

/// Follows the scan at its place in time; what had been followed after it is followed again.
std::vector<Association> LocalTracker::putInPlace(const Scan& scan) {
  auto place = std::upper_bound(remembered_.begin(), remembered_.end(), scan,
                                [](const Scan& a, const Remembered& b) { return precedes(a, b.scan); });
  const auto index = static_cast<std::size_t>(place - remembered_.begin());
  remembered_.insert(place, {scan, nullptr});

  std::size_t from = index;
  if (index + 1 <
      remembered_.size()) {  // late: back to the nearest state that has seen nothing after the scan
    if (index == 0) remembered_[0].before = std::move(remembered_[1].before);
    while (!remembered_[from].before) --from;
    state_ = State(*remembered_[from].before);
    for (std::size_t k = from + 1; k < remembered_.size(); ++k) remembered_[k].before.reset();
  }
  std::vector<Association> decisions;
  for (std::size_t k = from; k < remembered_.size(); ++k) {
    if (isStateDue(k)) remembered_[k].before = std::make_unique<State>(state_);
    std::vector<Association> taken = follow(remembered_[k].scan);
    if (k == index) decisions = std::move(taken);
  }
  forgetOldScans();
  return decisions;
}

/// Whether the state before the k-th remembered scan should be kept: always the first one, then a few for
/// each lag.
bool LocalTracker::isStateDue(std::size_t k) const {
  if (remembered_[k].before) return false;
  for (std::size_t earlier = k; earlier-- > 0;) {
    if (!remembered_[earlier].before) continue;
    return seconds(remembered_[k].scan.time - remembered_[earlier].scan.time) >=
           params_.max_lag / kStatesPerLag;
  }
  return true;
}

/// Drops the scans before the last kept state that is older than max_lag: nothing can be put before it any
/// more.
void LocalTracker::forgetOldScans() {
  const Time oldest = state_.time - durationOf(params_.max_lag);
  std::size_t keep_from = 0;
  for (std::size_t k = 1; k < remembered_.size(); ++k) {
    const bool too_many = remembered_.size() - keep_from > kMostRemembered;
    if (remembered_[k].scan.time > oldest && !too_many) break;
    if (remembered_[k].before) keep_from = k;
  }
  remembered_.erase(remembered_.begin(), remembered_.begin() + static_cast<std::ptrdiff_t>(keep_from));
}

/// One scan in order of time: the whole of tracking.
std::vector<Association> LocalTracker::follow(const Scan& scan) {
  state_.time = scan.time;
  giveUpTheDead(scan.time);
  const std::vector<Expectation> expectations = predict(scan.time);
  Pairing pairing = associate(scan, expectations, params_.gate);
  update(scan, expectations, pairing);
  start(scan, pairing);
  giveUpTheDead(scan.time);
  return std::move(pairing.decisions);
}

std::vector<Expectation> LocalTracker::predict(Time time) {
  std::vector<Expectation> expectations;
  expectations.reserve(state_.tracks.size());
  for (LiveTrack& track : state_.tracks) expectations.push_back(track.expect(time, params_.adapt_gate));
  return expectations;
}

/// Tracks that were paired take their sighting, the others have missed.
void LocalTracker::update(const Scan& scan, const std::vector<Expectation>& expectations,
                          const Pairing& pairing) {
  for (std::size_t i = 0; i < state_.tracks.size(); ++i) {
    LiveTrack& track = state_.tracks[i];
    const int sighting = pairing.sighting_of[i];
    if (sighting < 0) {
      track.miss(scan, params_.lifecycle);
    } else {
      track.take(scan, scan.sightings[static_cast<std::size_t>(sighting)], expectations[i],
                 params_.lifecycle);
    }
  }
}

/// Sightings that nobody claims start tracks of their own, while there is room.
void LocalTracker::start(const Scan& scan, Pairing& pairing) {
  for (std::size_t j = 0; j < scan.sightings.size(); ++j) {
    if (!pairing.may_start[j] || state_.tracks.size() >= static_cast<std::size_t>(params_.max_tracks))
      continue;
    const std::uint32_t id = state_.next_id++;
    state_.tracks.emplace_back(id, scan, scan.sightings[j], makeEstimator(params_.estimator));
    pairing.decisions[j] = Association{};
    pairing.decisions[j].sighting = static_cast<std::uint32_t>(j);
    pairing.decisions[j].track = id;
    pairing.decisions[j].decision = Decision::started_track;
  }
}

void LocalTracker::giveUpTheDead(Time time) {
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
    tracks.push_back(track.report(state_.time, params_.gate, params_.adapt_gate, params_.lifecycle));
  }
  return tracks;
}

}  // namespace sightline::core
