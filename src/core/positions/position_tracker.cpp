#include "sightline/core/positions/position_tracker.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "sightline/core/model/name.h"
#include "sightline/core/model/usable_sighting.h"

namespace sightline::core {
namespace {

constexpr int kStatesPerLag = 8;  // that are kept for rolling back
constexpr std::size_t kMostItems = 100000;
constexpr std::size_t kMostNames = 1024;  // of trackers, and of their sensors: what is learnt of each is kept

TimelineParams timelineParams(double max_lag) {
  if (!(max_lag >= 0.0 && std::isfinite(max_lag)))
    throw std::invalid_argument("PositionTrackerParams: max_lag >= 0 s is required, got " +
                                std::to_string(max_lag));
  TimelineParams params;
  params.span = max_lag;
  params.interval = max_lag / kStatesPerLag;
  params.most_items = kMostItems;
  return params;
}

bool isUsable(const StationPose& pose) {
  const double unevenness =
      (pose.R_metric_station * pose.R_metric_station.transpose() - Eigen::Matrix3d::Identity()).norm();
  return pose.origin.allFinite() && pose.velocity.allFinite() && unevenness < 1e-6;
}

}  // namespace

bool PositionTracker::Item::isBefore(const Item& b) const {
  const Item& a = *this;
  if (a.time != b.time) return a.time < b.time;
  if (a.what.index() != b.what.index()) return a.what.index() < b.what.index();
  if (a.what.index() == 1) return std::get<1>(a.what).tracker < std::get<1>(b.what).tracker;
  const StationTracklet &x = std::get<0>(a.what), &y = std::get<0>(b.what);
  return std::tie(x.tracker, x.track, x.tracklet.sensor) < std::tie(y.tracker, y.track, y.tracklet.sensor);
}

PositionTracker::PositionTracker(const PositionTrackerParams& params)
    : max_lag_(params.max_lag), items_(timelineParams(params.max_lag)), scene_(params.scene) {}

std::optional<Refusal> PositionTracker::insert(Item item) {
  const Time time = item.time;
  const bool is_late = (closed_ && time < *closed_) || (newest_ && seconds(*newest_ - time) > max_lag_);
  if (is_late)
    return Refusal{"late", "older than max_lag = " + std::to_string(max_lag_) + " s before the newest"};
  if (items_.holds(item)) return Refusal{"duplicate", "the same was received before"};
  const std::size_t place = items_.insert(std::move(item));
  if (place < items_.next()) items_.restore(place, scene_);
  newest_ = std::max(newest_.value_or(time), time);
  return std::nullopt;
}

/// Why nothing under these names is taken; `sensor` is empty for a tracker's tracks.
std::optional<Refusal> PositionTracker::admit(const std::string& tracker, const std::string& sensor) {
  if (names_.count({tracker, sensor}) > 0) return std::nullopt;
  if (auto refusal = whyTooLong("the tracker's name", tracker)) return refusal;
  if (auto refusal = whyTooLong("the sensor's name", sensor)) return refusal;
  if (names_.size() >= kMostNames)
    return Refusal{"limit", "already " + std::to_string(names_.size()) +
                                " names of trackers and sensors: each must keep its name"};
  names_.insert({tracker, sensor});
  return std::nullopt;
}

std::optional<Refusal> PositionTracker::onTracks(const StationTracks& tracks) {
  if (!isUsable(tracks.pose))
    return Refusal{"invalid", "pose of the station is not finite, or its rotation is none: see its tf"};
  if (auto refusal = admit(tracks.tracker, "")) return refusal;
  auto refusal = insert({tracks.time, tracks});
  if (!refusal) has_tracks_ = true;
  return refusal;
}

std::vector<Refusal> PositionTracker::onTracklets(const std::vector<StationTracklet>& tracklets) {
  std::vector<Refusal> refusals;
  for (const StationTracklet& tracklet : tracklets) {
    const bool is_usable = isUsable(tracklet.pose) && isUsable(tracklet.tracklet.sighting);
    if (!is_usable) {
      refusals.push_back({"invalid", "pose, direction or covariance of the tracklet is not usable"});
      continue;
    }
    if (const auto refusal = admit(tracklet.tracker, tracklet.tracklet.sensor)) {
      refusals.push_back(*refusal);
      continue;
    }
    if (const auto refusal = insert({tracklet.tracklet.time, tracklet})) refusals.push_back(*refusal);
  }
  return refusals;
}

std::vector<TakenMeasurement> PositionTracker::handOut(bool all) {
  const Time end = all ? Time::max() : closed_.value_or(Time::min());
  std::vector<TakenMeasurement> out = scene_.handOut(handed_out_, end);
  handed_out_ = std::max(handed_out_, end);
  return out;
}

std::optional<PositionOutput> PositionTracker::report() {
  while (items_.next() < items_.size()) {
    items_.keepIfDue(scene_);
    std::visit([this](const auto& what) { scene_.take(what); }, items_[items_.next()].item.what);
    items_.advance();
  }
  if (newest_ && items_.close(*newest_)) {
    closed_ = items_[items_.open()].item.time;
    items_.dropClosed();
  }
  if (!has_tracks_) return std::nullopt;
  return scene_.output(*newest_);
}

}  // namespace sightline::core
