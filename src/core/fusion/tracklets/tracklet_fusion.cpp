#include "sightline/core/fusion/tracklets/tracklet_fusion.h"

#include <algorithm>
#include <sstream>

namespace sightline::core {
namespace {

constexpr double kOwnerSilence = 0.5;     // after which another supporter reports for a sensor [s]
constexpr double kMostBias = 6.0;         // of a sensor that still sees the same target [sigma]
constexpr std::size_t kMostOwners = 256;  // sensors; tracklets of further ones are not used

}  // namespace

TrackletFusion::TrackletFusion(const TrackletFusionParams& params)
    : track_(params.estimator, params.max_lag, params.guard) {}

void TrackletFusion::feed(const Supporter& supporter, const TrackletMemory& memory) {
  const auto* remembered = memory.find(supporter.key);
  if (remembered == nullptr) return;
  std::uint64_t& fed = fed_[supporter.key];
  const auto first_new = std::upper_bound(
      remembered->begin(), remembered->end(), fed,
      [](std::uint64_t number, const TrackletMemory::Remembered& it) { return number < it.number; });
  for (auto next = first_new; next != remembered->end(); ++next) {
    const TrackletMemory::Remembered& it = *next;
    if (it.tracklet.time > supporter.local.time) return;
    fed = it.number;
    if (reportsFor(supporter.key, it.tracklet) && !track_.add(supporter.key, it.number, it.tracklet)) ++late_;
  }
}

/// Whether the supporter is the one whose tracklets of this sensor are used.
bool TrackletFusion::reportsFor(const LocalKey& supporter, const Tracklet& tracklet) {
  if (owners_.size() >= kMostOwners && owners_.count(tracklet.sensor) == 0 &&
      !forgetOldestOwner(tracklet.time))
    return false;
  const auto [it, is_new] = owners_.try_emplace(tracklet.sensor, Owner{supporter, tracklet.time});
  Owner& owner = it->second;
  if (!(owner.supporter == supporter)) {
    if (seconds(tracklet.time - owner.newest) <= kOwnerSilence) return false;
    owner.supporter = supporter;
  }
  owner.newest = std::max(owner.newest, tracklet.time);
  return true;
}

/// Forgets the sensor that has been silent longest, if it may be reported for by anyone again.
bool TrackletFusion::forgetOldestOwner(Time now) {
  const auto oldest = std::min_element(owners_.begin(), owners_.end(), [](const auto& a, const auto& b) {
    return a.second.newest < b.second.newest;
  });
  if (seconds(now - oldest->second.newest) <= kOwnerSilence) return false;
  owners_.erase(oldest);
  return true;
}

void TrackletFusion::passOver(const LocalKey& supporter, Time before, const TrackletMemory& memory) {
  const auto* remembered = memory.find(supporter);
  if (remembered == nullptr) return;
  for (const TrackletMemory::Remembered& it : *remembered) {
    if (it.tracklet.time < before) fed_[supporter] = std::max(fed_[supporter], it.number);
  }
}

void TrackletFusion::takeBack(const LocalKey& supporter, Time since) {
  if (const auto least = track_.remove(supporter, since)) fed_[supporter] = *least - 1;
}

void TrackletFusion::leave(const LocalKey& supporter) {
  fed_.erase(supporter);
  for (auto it = owners_.begin(); it != owners_.end();)
    it = it->second.supporter == supporter ? owners_.erase(it) : std::next(it);
}

std::map<LocalKey, double> TrackletFusion::shares() const {
  std::map<LocalKey, double> shares = track_.informationBySource();
  double sum = 0.0;
  for (const auto& [key, information] : shares) sum += information;
  for (auto& [key, information] : shares) information /= sum;
  return shares;
}

/// Those for which this supporter reports.
std::vector<WatchedSensor> TrackletFusion::sensorsOf(const LocalKey& supporter) const {
  std::vector<WatchedSensor> sensors;
  for (WatchedSensor& watched : track_.sensors()) {
    const auto owner = owners_.find(watched.sensor);
    if (owner != owners_.end() && owner->second.supporter == supporter) sensors.push_back(std::move(watched));
  }
  return sensors;
}

std::optional<Refusal> TrackletFusion::exclusionOf(const LocalKey& supporter) const {
  if (!track_.holdsAnything()) return std::nullopt;
  const std::vector<WatchedSensor> sensors = sensorsOf(supporter);
  const auto is_off = [](const WatchedSensor& watched) {
    return watched.is_excluded && watched.last && watched.last->bias.matrix().norm() <= kMostBias;
  };
  if (sensors.empty() || !std::all_of(sensors.begin(), sensors.end(), is_off)) return std::nullopt;
  std::ostringstream detail;
  for (const WatchedSensor& watched : sensors) {
    detail << (&watched == &sensors.front() ? "" : ", ") << watched.sensor << " is off by ("
           << watched.last->bias(0) << ", " << watched.last->bias(1) << ") sigma from what the others see";
  }
  return Refusal{"biased", detail.str()};
}

double TrackletFusion::noiseScale(const LocalKey& supporter) const {
  if (!track_.holdsAnything()) return 1.0;
  double largest = 1.0;
  for (const WatchedSensor& watched : sensorsOf(supporter)) {
    if (!watched.is_excluded) largest = std::max(largest, watched.noise_scale);
  }
  return largest;
}

std::optional<Refusal> whyIncomplete(const std::vector<const Supporter*>& supporters,
                                     const TrackletMemory& memory, const TrackletFusionParams& params) {
  std::ostringstream why;
  double missing = 0.0;
  for (const Supporter* supporter : supporters) {
    const std::string& tracker = supporter->key.tracker;
    const auto newest = memory.newest(tracker);
    if (!newest) {
      why << "no tracklets from " << tracker;
      return Refusal{"no tracklets", why.str()};
    }
    const double lag = seconds(supporter->local.time - *newest);
    if (lag > params.max_lag) {
      why << "tracklets of " << tracker << " are " << lag << " s behind its tracks (max_lag "
          << params.max_lag << " s)";
      return Refusal{"tracklets behind", why.str()};
    }
    missing += memory.missing(tracker, *newest - durationOf(params.memory)) / params.memory;
  }
  const double share = missing / static_cast<double>(supporters.size());
  if (share <= params.max_missing) return std::nullopt;
  why << "tracklets lost: " << 100.0 * share << " % of the last " << params.memory << " s (max_missing "
      << 100.0 * params.max_missing << " %)";
  return Refusal{"tracklets lost", why.str()};
}

}  // namespace sightline::core
