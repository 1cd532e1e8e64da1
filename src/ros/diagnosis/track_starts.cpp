#include "sightline/ros/diagnosis/track_starts.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "sightline/core/model/sphere.h"
#include "sightline/report/value_text.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {

namespace core = sightline::core;
using sightline::report::valueOf;

namespace {

constexpr std::size_t kMostStartingSensors = 1000;
constexpr std::size_t kMostPending = 10000;
constexpr std::size_t kLeastSightings = 8;  // below, nothing is said
constexpr std::size_t kLeastStarts = 3;
constexpr double kNearer =
    0.5;  // a start is near the last one within this share of the distance to an old one
constexpr double kSameSigmas = 10.0;     // or when even the old one is within so many stated sigmas
constexpr double kMostNear = 0.6;        // share of such starts beyond which they are a target's
constexpr double kTooSmallStates = 2.0;  // scatter over the stated sigma

}  // namespace

void TrackStarts::take(const sightline::AssociationArray& associations) {
  if (sensors_.size() >= kMostStartingSensors && sensors_.count(associations.sensor) == 0) return;
  Sensor& sensor = sensors_[associations.sensor];
  if (isUsed(associations)) return noteUse(sensor);
  const core::Time time = toCore(associations.header.stamp);
  for (const sightline::Association& association : associations.associations) {
    sensor.sightings += association.decision == sightline::Association::REJECTED_INPUT ? 0 : 1;
    if (association.decision != sightline::Association::STARTED_TRACK) continue;
    ++sensor.started;
    const auto place = places_.find(association.track);
    if (place != places_.end()) locate(sensor, place->second, time);
    if (pending_.size() >= kMostPending) pending_.erase(pending_.begin());
    pending_[association.track] = {associations.sensor, time, place != places_.end()};
  }
}

/// Whether a confirmed track took one of the scan's sightings.
bool TrackStarts::isUsed(const sightline::AssociationArray& associations) const {
  return std::any_of(associations.associations.begin(), associations.associations.end(),
                     [this](const sightline::Association& association) {
                       return association.decision == sightline::Association::ACCEPTED &&
                              std::binary_search(established_.begin(), established_.end(), association.track);
                     });
}

void TrackStarts::noteUse(Sensor& sensor) {
  if (sensor.sightings > 0) sensor = Sensor();
  sensor.was_used = true;
}

void TrackStarts::take(const sightline::TrackArray& tracks) {
  const core::Time time = toCore(tracks.header.stamp);
  established_.clear();
  places_.clear();
  std::size_t waiting = 0;  // of the pending ones, those that are still tentative
  for (const sightline::Track& track : tracks.tracks) {
    const bool is_established = track.status != sightline::Track::TENTATIVE;
    if (is_established) established_.push_back(track.id);
    if (track.hits == 1 && places_.size() < kMostPending) places_[track.id] = placeOf(track);
    const auto start = pending_.empty() ? pending_.end() : pending_.find(track.id);
    if (start == pending_.end()) continue;
    Sensor& sensor = sensors_[start->second.sensor];
    if (is_established) {
      noteUse(sensor);
      pending_.erase(start);
      continue;
    }
    ++waiting;
    start->second.last_seen = time;
    if (start->second.is_located || track.hits != 1) continue;
    locate(sensor, placeOf(track), start->second.time);
    start->second.is_located = true;
  }
  std::sort(established_.begin(), established_.end());
  if (waiting == pending_.size()) return;
  for (auto start = pending_.begin(); start != pending_.end();) {
    const bool is_over = start->second.last_seen != time && start->second.time <= time;
    start = is_over ? pending_.erase(start) : std::next(start);
  }
}

TrackStarts::Place TrackStarts::placeOf(const sightline::Track& track) {
  Place place{{track.azimuth, track.elevation}, Eigen::Matrix2d::Zero()};
  place.covariance << track.covariance[0], track.covariance[1], track.covariance[4], track.covariance[5];
  return place;
}

/// A start, where the track still is where its first sighting was.
void TrackStarts::locate(Sensor& sensor, const Place& place, core::Time time) {
  const Eigen::Vector3d direction = core::directionOf(place.angles);
  const double sigma = std::sqrt(place.covariance.trace() / 2.0);
  sensor.sigmas.add(sigma);
  const std::size_t count = sensor.last.size();
  if (sensor.located > 0) {
    const double step = core::angleBetween(direction, sensor.last[(sensor.located - 1) % count]);
    sensor.steps.add(step);
    if (time > sensor.last_start) sensor.intervals.add(core::seconds(time - sensor.last_start));
    const std::size_t oldest = sensor.located < count ? 0 : sensor.located % count;
    if (sensor.located >= 2) {
      const double far = core::angleBetween(direction, sensor.last[oldest]);
      ++sensor.compared;
      sensor.near += step < kNearer * far || far < kSameSigmas * sigma ? 1 : 0;
    }
  }
  sensor.scatter.add(sensor.chain, time, place.angles, place.covariance);
  sensor.last[sensor.located % count] = direction;
  ++sensor.located;
  sensor.last_start = time;
}

std::optional<Finding> TrackStarts::findingOf(const std::string& name, const Sensor& sensor) {
  if (sensor.sightings < kLeastSightings || sensor.started < kLeastStarts) return std::nullopt;
  const bool is_a_target = sensor.compared > 0 && static_cast<double>(sensor.near) >
                                                      kMostNear * static_cast<double>(sensor.compared);
  if (!is_a_target && sensor.was_used) return std::nullopt;
  std::ostringstream words;
  words << sensor.started << " of " << sensor.sightings << " sightings started a track, none was confirmed";
  const auto interval = sensor.intervals.quantile(0.5), step = sensor.steps.quantile(0.5),
             sigma = sensor.sigmas.quantile(0.5), ratio = sensor.scatter.ratio();
  if (interval && step && sigma) {
    words << ": they come every " << valueOf(*interval, "s") << ", state a sigma of "
          << valueOf(*sigma, "rad") << " and lie " << valueOf(*step, "rad") << " apart";
    if (is_a_target && ratio && *ratio >= kTooSmallStates) {
      words << ", scattered by " << valueOf(*ratio * *sigma, "rad") << ", " << valueOf(*ratio, "times")
            << " as much as they state; state that sigma (variances are in rad^2)";
    } else if (is_a_target) {
      words << ", as those of a target; state the sigma that they have, send scans more often, or state how "
               "rare "
               "false sightings are (clutter_density)";
    } else {
      words << ", as false sightings do; if there is a target, raise the detector's threshold";
    }
  }
  return Finding{name, words.str(), !is_a_target};
}

std::map<std::string, std::optional<Finding>> TrackStarts::findings() const {
  std::map<std::string, std::optional<Finding>> found;
  for (const auto& [name, sensor] : sensors_) found[name] = findingOf(name, sensor);
  return found;
}

}  // namespace sightline_ros
