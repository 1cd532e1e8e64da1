// Which crossings PositionScene takes for targets, and which of them it takes back.
#include <algorithm>
#include <cstddef>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "sightline/core/positions/position_scene.h"

namespace sightline::core {
namespace {

/// How many of the candidate's tracks are among the supporters.
std::size_t sharedWith(const std::set<ViewKey>& supporters, const Candidate& candidate) {
  return static_cast<std::size_t>(
      std::count_if(candidate.members.begin(), candidate.members.end(),
                    [&](const ViewKey& key) { return supporters.count(key) > 0; }));
}

}  // namespace

/// An estimator that has taken the last measurements of all members, in order.
std::shared_ptr<PositionEstimator> PositionScene::estimatorFrom(const std::set<ViewKey>& members) const {
  std::vector<std::pair<ViewKey, const StationMeasurement*>> all;
  for (const ViewKey& key : members)
    for (const StationMeasurement& measurement : locals_.at(key).recent) all.emplace_back(key, &measurement);
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
    if (a.second->time != b.second->time) return a.second->time < b.second->time;
    return a.first == b.first ? a.second->station < b.second->station : a.first < b.first;
  });
  auto estimator = std::make_shared<PositionEstimator>(params_->estimator);
  for (const auto& [key, measurement] : all) estimator->update(corrected(key, *measurement));
  return estimator;
}

/// Two stations alone support it, and it is not confirmed yet.
bool PositionScene::isOnProbation(const Target& target) {
  return !target.is_confirmed && !target.lost && stationsOf(target).size() == 2;
}

/// Targets on probation are taken back when their tracks are explained as well, or better, by
/// other crossings; what supports them besides is added.
void PositionScene::reviewProbation() {
  std::vector<std::uint32_t> wrong;
  for (auto& [id, target] : targets_) {
    if (!isOnProbation(target)) continue;
    const std::vector<ViewKey> supporters(target.supporters.begin(), target.supporters.end());
    const auto contradicts = [&, &supporters = target.supporters](const Candidate& candidate) {
      const std::size_t shared = sharedWith(supporters, candidate);
      return shared > 0 && shared < candidate.members.size();
    };
    const auto larger =
        std::find_if(decision_.targets.begin(), decision_.targets.end(), [&](const Candidate& candidate) {
          return std::includes(candidate.members.begin(), candidate.members.end(), supporters.begin(),
                               supporters.end());
        });
    if (larger != decision_.targets.end()) {
      for (const ViewKey& key : larger->members) {
        std::uint32_t& owner = locals_.at(key).target;
        if (owner != 0 && owner != id) release(owner, key);
        owner = id;
        target.supporters.insert(key);
      }
      continue;
    }
    const bool is_refused =
        std::any_of(decision_.refused.begin(), decision_.refused.end(), [&](const RefusedCrossing& refused) {
          return refused.reason != CrossingRefusal::unlikely && refused.candidate.members == supporters;
        });
    if (is_refused || std::any_of(decision_.targets.begin(), decision_.targets.end(), contradicts))
      wrong.push_back(id);
  }
  for (const std::uint32_t id : wrong) dissolve(id);
}

std::vector<LookingStation> PositionScene::lookingStations(Time now) const {
  std::vector<LookingStation> stations;
  for (std::size_t i = 0; i < trackers_.size(); ++i) {
    if (seconds(now - trackers_[i].time) <= kFreshestView)
      stations.push_back({static_cast<int>(i), trackers_[i].origin, trackers_[i].views});
  }
  return stations;
}

/// Positions of two stations may be ghosts that nothing contradicted when they were confirmed. They are given
/// up when tracks of a third station show for long that their tracks belong to other crossings.
void PositionScene::reviewPairs(Time now, const std::vector<LookingStation>& stations) {
  if (stations.size() < 3) return;
  const double h = decided_ ? std::max(seconds(now - *decided_), 0.0) : 0.0;
  std::vector<LocalView> views;  // free ones first
  for (const auto& [key, local] : locals_)
    if (local.target == 0 && speaksAt(local, now)) views.push_back(viewAt(local, now));
  const std::size_t free = views.size();
  const double gate = params_->hypotheses.gate * params_->hypotheses.gate;
  const auto crossesFreeOne = [&](const LocalView& view) {
    return std::any_of(views.begin(), views.begin() + static_cast<std::ptrdiff_t>(free),
                       [&](const auto& other) {
                         if (other.key.station == view.key.station) return false;
                         const auto test = planeTest(view.ray, other.ray);
                         return test && test->isAhead() && test->distanceSquared() <= gate * test->degrees();
                       });
  };
  std::vector<std::uint32_t> reviewed;
  for (const auto& [id, target] : targets_) {
    if (free == 0 || !target.is_confirmed || target.lost || stationsOf(target).size() != 2) continue;
    std::vector<LocalView> supporters;
    for (const ViewKey& key : target.supporters) {
      const Local& local = locals_.at(key);
      if (speaksAt(local, now)) supporters.push_back(viewAt(local, now));
    }
    if (supporters.size() < 2 || std::none_of(supporters.begin(), supporters.end(), crossesFreeOne)) continue;
    reviewed.push_back(id);
    views.insert(views.end(), supporters.begin(), supporters.end());
  }
  HypothesisDecision decision;
  if (!reviewed.empty()) decision = review_.decide(now, std::move(views), stations);
  std::vector<std::uint32_t> wrong;
  for (auto& [id, target] : targets_) {
    const std::set<ViewKey>& supporters = target.supporters;
    const bool is_doubted =
        std::binary_search(reviewed.begin(), reviewed.end(), id) &&
        std::any_of(decision.targets.begin(), decision.targets.end(), [&](const Candidate& candidate) {
          const std::size_t shared = sharedWith(supporters, candidate);
          return candidate.members.size() > 2 && shared > 0 && shared < supporters.size();
        });
    target.doubted = is_doubted ? target.doubted + h : std::max(target.doubted - h, 0.0);
    if (target.doubted > params_->contradiction_time) wrong.push_back(id);
  }
  for (const std::uint32_t id : wrong) dissolve(id);
}

/// Free local tracks that cross as one target's do start a target, or bring one back that was a direction.
void PositionScene::startTargets(Time now) {
  const std::vector<LookingStation> stations = lookingStations(now);
  reviewPairs(now, stations);
  std::vector<LocalView> views;
  for (const auto& [key, local] : locals_) {
    const auto target = targets_.find(local.target);
    const bool is_open =
        target == targets_.end() || target->second.lost.has_value() || isOnProbation(target->second);
    if (is_open && speaksAt(local, now)) views.push_back(viewAt(local, now));
  }
  decision_ = hypotheses_.decide(now, std::move(views), stations);
  reviewProbation();
  for (const Candidate& candidate : decision_.targets) {
    const std::set<ViewKey> members(candidate.members.begin(), candidate.members.end());
    const auto existing = targets_.find(locals_.at(candidate.members.front()).target);
    const bool is_known = existing != targets_.end() && isOnProbation(existing->second) &&
                          std::includes(existing->second.supporters.begin(),
                                        existing->second.supporters.end(), members.begin(), members.end());
    if (is_known) continue;
    auto estimator = estimatorFrom(members);
    if (!estimator->hasState()) continue;  // too few tracklets yet
    std::uint32_t id = 0;
    for (const ViewKey& key : members) {
      const std::uint32_t had = locals_.at(key).target;
      if (had && (id == 0 || had < id)) id = had;
    }
    for (const ViewKey& key : members) {
      const std::uint32_t had = locals_.at(key).target;
      if (had && had != id) release(had, key);
    }
    if (id == 0) {
      if (static_cast<int>(targets_.size()) >= params_->max_targets) continue;
      id = next_id_++;
      targets_[id].since = now;
    }
    Target& target = targets_[id];
    for (const ViewKey& key : std::set<ViewKey>(target.supporters))
      if (!members.count(key)) release(id, key);
    target.supporters = members;
    target.log_odds = std::clamp(std::min(candidate.score, candidate.margin), 0.0, kMostLogOdds) -
                      logMissed(candidate.at.point, stations, stationsOf(target),
                                params_->hypotheses.detection_probability);
    target.contradicted.clear();
    target.last_sighting = estimator->time().value_or(now);
    target.lost.reset();
    target.estimator = std::move(estimator);
    for (const ViewKey& key : members) {
      Local& local = locals_.at(key);
      local.target = id;
      for (const StationMeasurement& measurement : local.recent) note(id, now, corrected(key, measurement));
    }
  }
}

}  // namespace sightline::core
