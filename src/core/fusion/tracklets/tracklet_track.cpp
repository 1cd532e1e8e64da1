#include "sightline/core/fusion/tracklets/tracklet_track.h"

#include <algorithm>
#include <exception>
#include <utility>

namespace sightline::core {
namespace {

constexpr int kStatesPerLag = 8;  // that are kept for rolling back
constexpr std::size_t kMostReports = 8192;

TimelineParams timelineParams(double max_lag) {
  TimelineParams params;
  params.span = max_lag;
  params.interval = max_lag / kStatesPerLag;
  params.most_items = kMostReports;
  return params;
}

}  // namespace

TrackletTrack::TrackletTrack(const EstimatorParams& estimator, double max_lag, const GuardParams& guard)
    : thresholds_(guard.health), reports_(timelineParams(max_lag)), estimator_(estimator, guard, max_lag) {}

bool TrackletTrack::add(const LocalKey& source, std::uint64_t number, const Tracklet& tracklet) {
  if (closed_ && tracklet.time < *closed_) return false;
  Report report{source, number, tracklet};
  if (reports_.holds(report)) return true;
  const std::size_t place = reports_.insert(std::move(report));
  if (place < reports_.next()) reports_.restore(place, estimator_);
  return true;
}

std::optional<std::uint64_t> TrackletTrack::remove(const LocalKey& source, Time since) {
  std::optional<std::uint64_t> least;
  for (std::size_t i = reports_.open(); i < reports_.size();) {
    const Report& report = reports_[i].item;
    if (!(report.source == source) || report.tracklet.time < since) {
      ++i;
      continue;
    }
    least = std::min(least.value_or(report.number), report.number);
    if (i < reports_.next()) reports_.restore(i, estimator_);
    reports_.erase(i);
  }
  return least;
}

void TrackletTrack::setThresholds(const SensorHealthParams& health, Time after) {
  if (closed_) thresholds_.forgetBefore(*closed_);
  thresholds_.change(health, after);
}

void TrackletTrack::advanceTo(Time time) {
  while (reports_.next() < reports_.size() && reports_[reports_.next()].item.tracklet.time <= time) {
    try {
      processNext();
    } catch (const std::exception& problem) {
      dropNext(problem.what());
    }
  }
  forgetOld();
}

std::optional<AngularState> TrackletTrack::stateAt(Time time) const {
  return estimator_.stateAt(time);
}

void TrackletTrack::processNext() {
  const auto past = [this](std::size_t back) -> const Tracklet& {
    return reports_[reports_.next() - back].item.tracklet;
  };
  reports_.keepIfDue(estimator_);
  estimator_.setThresholds(thresholds_.at(reports_[reports_.next()].item.tracklet.time));
  estimator_.take(reports_[reports_.next()].item.tracklet, past);
  reports_.advance();
}

/// Takes the next tracklet out, and goes back to the state before it.
void TrackletTrack::dropNext(const std::string& why) {
  const std::size_t failed = reports_.next();
  ++failures_.count;
  failures_.latest = "tracklet of \"" + reports_[failed].item.tracklet.sensor + "\": " + why;
  reports_.restore(failed, estimator_);
  reports_.erase(failed);
}

/// Closes what is before the last kept state that is older than max_lag, and drops of it what that state does
/// not need for rolling back after an alarm.
void TrackletTrack::forgetOld() {
  if (reports_.next() == 0) return;
  if (!reports_.close(reports_[reports_.next() - 1].item.tracklet.time)) return;
  const auto& first_open = reports_[reports_.open()];
  closed_ = first_open.item.tracklet.time;
  reports_.dropClosed(first_open.before->reach());
}

std::map<LocalKey, double> TrackletTrack::informationBySource() const {
  std::vector<std::pair<const LocalKey*, double>> sums;  // of few sources; a map would be slower
  const std::size_t taken = reports_.next();
  for (std::size_t i = reports_.open(); i < reports_.size(); ++i) {
    const Report& report = reports_[i].item;
    const SensorUse use = i < taken ? estimator_.useOf(taken - i) : SensorUse{};
    const auto isIt = [&](const auto& sum) { return *sum.first == report.source; };
    auto sum = std::find_if(sums.begin(), sums.end(), isIt);
    if (sum == sums.end()) sum = sums.insert(sum, {&report.source, 0.0});
    if (use.is_excluded) continue;
    sum->second += 1.0 / (use.noise_scale * report.tracklet.sighting.covariance.trace());
  }
  std::map<LocalKey, double> information;
  for (const auto& [source, sum] : sums) information[*source] = sum;
  return information;
}

}  // namespace sightline::core
