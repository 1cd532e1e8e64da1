// What PositionScene learns of the clocks and orientations of its stations, and how it puts them right.
#include <algorithm>
#include <memory>
#include <set>
#include <utility>

#include "sightline/core/positions/position_scene.h"

namespace sightline::core {
namespace {

constexpr double kYouth = 1.5;               // [s] in which a local track has not settled
constexpr double kCorrectionInterval = 1.0;  // [s] between decisions on which stations are off
constexpr double kClearMargin =
    9.0;  // of chi-square, between the best and the second best track of a station
constexpr std::size_t kFewestTargets = 2;  // that a station must see elsewhere before they tell something

}  // namespace

/// A measurement put right by what is known of its station; what is not known of that is slow.
StationMeasurement PositionScene::corrected(const ViewKey& key, const StationMeasurement& measurement) const {
  const StationCorrection* correction = corrections_.of(key.station);
  if (!correction) return measurement;
  StationMeasurement right = measurement;
  StationCorrection turned = *correction;  // the clock is put right by the estimator, which knows the motion
  turned.clock = 0.0;
  right.ray = core::corrected(measurement.ray, turned);
  right.ray.covariance = measurement.ray.covariance;
  right.age = correction->clock;
  const auto A = alignmentJacobian(measurement.ray.direction, measurement.ray.motion->rate);
  right.slow.variance += 0.5 * (A * correction->covariance * A.transpose()).trace();
  return right;
}

/// For each target the local tracks that see it, also those of a station that is too far off to support it: a
/// station whose tracks fit no target as they are, and more of which fit one by one clock and one orientation
/// that are within their priors. Less than two targets say nothing: a track of another one would look the
/// same.
std::vector<std::vector<ViewKey>> PositionScene::alignedViews(Time now) const {
  struct Seen {
    std::vector<ViewKey> views;
    std::set<int> stations;
    PositionState state;
  };
  std::vector<Seen> targets;
  std::vector<std::size_t> fitting(trackers_.size(), 0);  // targets that a station supports with two others
  for (const auto& [id, target] : targets_) {
    if (!target.is_confirmed || target.lost) continue;
    const auto state = target.estimator->stateAt(std::max(now, target.estimator->time().value_or(now)));
    if (!state) continue;
    Seen seen{{}, {}, *state};
    for (const ViewKey& key : target.supporters) {
      seen.stations.insert(key.station);
      const Local& local = locals_.at(key);
      if (local.is_reported && seconds(now - local.time) <= kFreshestView) seen.views.push_back(key);
    }
    if (seen.stations.size() > 2)
      for (const int station : seen.stations) ++fitting[static_cast<std::size_t>(station)];
    targets.push_back(std::move(seen));
  }
  std::vector<std::vector<ViewKey>> found;
  for (const Seen& seen : targets) found.push_back(seen.views);
  for (std::size_t tracker = 0; tracker < trackers_.size(); ++tracker) {
    const int station = static_cast<int>(tracker);
    const StationAlignment::Marginal marginal = alignment_.marginalOf(station);
    const StationCorrection wide{marginal.mean(0), marginal.mean.tail<3>(), marginal.covariance, true, true};
    std::vector<std::pair<std::size_t, ViewKey>> elsewhere;
    for (std::size_t i = 0; i < targets.size(); ++i) {
      if (targets[i].stations.count(station)) continue;
      double best = params_->claim_gate + kClearMargin, second = best;
      std::optional<ViewKey> nearest;
      for (auto it = locals_.lower_bound({station, 0}); it != locals_.end() && it->first.station == station;
           ++it) {
        const Local& local = it->second;
        if (!local.is_reported || seconds(now - local.time) > kFreshestView) continue;
        const auto other = targets_.find(local.target);
        if (other != targets_.end() &&
            !other->second.lost) {  // of a target that a common station sees beside
          const bool is_beside =
              std::any_of(other->second.supporters.begin(), other->second.supporters.end(),
                          [&](const ViewKey& key) { return targets[i].stations.count(key.station) > 0; });
          if (is_beside) continue;
        }
        const Ray ray = core::corrected(statedViewAt(local, now).ray, wide);
        const auto distance = distanceSquared(ray, targets[i].state.mean, targets[i].state.covariance, true);
        if (!distance || *distance >= second) continue;
        second = std::min(second, std::max(best, *distance));
        if (*distance >= best) continue;
        best = *distance;
        nearest = it->first;
      }
      if (nearest && best <= params_->claim_gate && second - best >= kClearMargin)
        elsewhere.emplace_back(i, *nearest);
    }
    if (elsewhere.size() < kFewestTargets || elsewhere.size() <= fitting[tracker]) continue;
    for (const auto& [i, key] : elsewhere) found[i].push_back(key);
  }
  return found;
}

/// Clocks and orientations from what is seen of each target (P-14). Only what two targets at once tell is
/// used: along the path of one alone, what a lens gets wrong looks like a clock or an orientation.
void PositionScene::learnAlignment(Time now) {
  const double h = decided_ ? std::max(seconds(now - *decided_), 0.0) : 0.0;
  alignment_.forget(h);
  common_alignment_.forget(h);
  std::vector<std::vector<LocalView>> targets;
  for (const std::vector<ViewKey>& keys : alignedViews(now)) {
    std::vector<LocalView> views;
    for (const ViewKey& key : keys)
      if (seconds(now - locals_.at(key).since) > kYouth) views.push_back(statedViewAt(locals_.at(key), now));
    std::sort(views.begin(), views.end(),
              [](const LocalView& a, const LocalView& b) { return a.key < b.key; });
    if (views.size() > 1) targets.push_back(std::move(views));
  }
  std::set<std::pair<ViewKey, ViewKey>>
      taken;  // two targets may be one that is seen by two pairs of stations
  for (const std::vector<LocalView>& views : targets) {
    const double share = 2.0 / static_cast<double>(views.size());  // pairs of n rays share errors
    for (std::size_t a = 0; a < views.size(); ++a) {
      for (std::size_t b = a + 1; b < views.size(); ++b) {
        if (!taken.insert({views[a].key, views[b].key}).second) continue;
        alignment_.take(now, views[a], views[b], share);
        if (targets.size() > 1) common_alignment_.take(now, views[a], views[b], share);
      }
    }
  }
}

/// Stations found off are put right from now on, those that are no longer are taken as they say (P-16).
void PositionScene::correctStations(Time now) {
  if (corrected_ && seconds(now - *corrected_) < kCorrectionInterval) return;
  corrected_ = now;
  if (!corrections_.decide(common_alignment_)) return;
  // What was learnt of slow errors, and what the targets' estimators took, had the misalignment in it.
  for (Sensor& sensor : sensors_) sensor.noise = StationNoise(params_->noise);
  for (auto& [id, target] : targets_) {
    if (target.lost) continue;
    auto estimator = estimatorFrom(target.supporters);
    if (!estimator->hasState()) continue;
    target.estimator = std::move(estimator);
    target.contradicted.clear();
  }
}

std::vector<StationReport> PositionScene::stationReports() const {
  std::vector<bool> is_wrong(trackers_.size(), false);
  for (std::size_t tracker = 0; tracker < trackers_.size(); ++tracker) {
    const StationCorrection* correction = corrections_.of(static_cast<int>(tracker));
    is_wrong[tracker] = correction && correction->has_clock;
  }
  const std::vector<int>& undecided = corrections_.undecided();
  std::vector<StationReport> reports;
  for (const Sensor& sensor : sensors_) {
    StationReport report;
    report.tracker = trackers_[static_cast<std::size_t>(sensor.tracker)].name;
    report.sensor = sensor.name;
    report.slow_scale = sensor.noise.slowScale();
    report.time_constant = sensor.noise.timeConstant();
    report.alignment = alignment_.of(sensor.tracker, is_wrong);
    if (const StationCorrection* correction = corrections_.of(sensor.tracker)) {
      report.is_corrected = true;
      if (!report.alignment) report.alignment.emplace();
      const Eigen::Vector4d sigma = correction->covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
      if (correction->has_clock) {
        report.alignment->clock = correction->clock;
        report.alignment->clock_sigma = sigma(0);
      }
      if (correction->has_orientation) {
        report.alignment->orientation = correction->orientation;
        report.alignment->orientation_sigma = sigma.tail<3>();
      }
    }
    report.is_undecided = std::binary_search(undecided.begin(), undecided.end(), sensor.tracker);
    reports.push_back(std::move(report));
  }
  std::sort(reports.begin(), reports.end(), [](const StationReport& a, const StationReport& b) {
    return std::tie(a.tracker, a.sensor) < std::tie(b.tracker, b.sensor);
  });
  return reports;
}

}  // namespace sightline::core
