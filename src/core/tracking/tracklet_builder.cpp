#include "sightline/core/tracking/tracklet_builder.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "sightline/core/model/usable_sighting.h"

namespace sightline::core {
namespace {

constexpr std::size_t kMostWaiting = 10000;  // sightings; beyond, they are reported at once

}  // namespace

std::vector<TrackTracklet> sightingsTaken(const Scan& scan, const ScanReport& tracked) {
  std::vector<TrackTracklet> taken;
  if (tracked.refusal || tracked.use.is_excluded) return taken;
  for (const Association& association : tracked.associations) {
    const bool is_taken =
        association.decision == Decision::accepted || association.decision == Decision::started_track;
    if (!is_taken) continue;
    TrackTracklet sighting;
    sighting.track = association.track;
    sighting.tracklet.time = scan.time;
    sighting.tracklet.sensor = scan.sensor;
    sighting.tracklet.ifov = scan.ifov;
    sighting.tracklet.sighting = scan.sightings[association.sighting];
    sighting.tracklet.sighting.covariance *= tracked.use.noise_scale;
    taken.push_back(std::move(sighting));
  }
  return taken;
}

TrackletBuilder::TrackletBuilder(const TrackletParams& params) : params_(params) {
  const CompressionParams& compression = params.compression;
  if (!(params.interval >= 0.0) || !(compression.span >= 0.0) || compression.nodes < 1 ||
      compression.nodes > kMostNodes) {
    throw std::invalid_argument("TrackletParams: interval >= 0 s, span >= 0 s and nodes in 1 to " +
                                std::to_string(kMostNodes) + " are required");
  }
}

std::optional<TrackletReport> TrackletBuilder::onScan(const Scan& scan, const ScanReport& tracked) {
  if (tracked.refusal) return std::nullopt;
  if (newest_ && tracked.time < *newest_) {  // the clock went back, and the tracker started again
    pending_.clear();
    waiting_ = 0;
    newest_.reset();
    reported_.reset();
  }
  collect(scan, tracked);
  const Time last = newest_.value_or(tracked.time);
  newest_ = tracked.time;
  const Time next = tracked.time + (tracked.time - last);
  const bool is_due = !reported_ || params_.interval == 0.0 || seconds(next - *reported_) > params_.interval;
  if (!is_due && waiting_ < kMostWaiting) return std::nullopt;
  return report();
}

std::optional<TrackletReport> TrackletBuilder::onTime(Time now) {
  if (waiting_ == 0 || seconds(now - *reported_) < params_.interval) return std::nullopt;
  return report();
}

void TrackletBuilder::collect(const Scan& scan, const ScanReport& tracked) {
  for (TrackTracklet& taken : sightingsTaken(scan, tracked)) {
    std::vector<Tracklet>& pending = pending_[{taken.track, scan.sensor}];
    const auto place = std::upper_bound(pending.begin(), pending.end(), taken.tracklet,
                                        [](const Tracklet& a, const Tracklet& b) { return a.time < b.time; });
    pending.insert(place, std::move(taken.tracklet));
    ++waiting_;
  }
}

TrackletReport TrackletBuilder::report() {
  TrackletReport report;
  report.time = *newest_;
  report.since = reported_;
  for (const auto& [key, sightings] : pending_) {
    for (Tracklet& tracklet : compress(sightings, params_.compression)) {
      if (!isUsable(tracklet.sighting)) continue;  // by the noise found it is as wide as the sphere
      report.tracklets.push_back({key.first, std::move(tracklet)});
    }
  }
  pending_.clear();
  waiting_ = 0;
  reported_ = newest_;
  return report;
}

}  // namespace sightline::core
