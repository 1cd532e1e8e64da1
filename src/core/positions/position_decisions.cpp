// What PositionScene decides of its targets: what supports them, which of them are one.
#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <utility>

#include <Eigen/Cholesky>

#include "sightline/core/association/assignment.h"
#include "sightline/core/association/clusters.h"
#include "sightline/core/model/sphere.h"
#include "sightline/core/positions/position_scene.h"

namespace sightline::core {
namespace {

constexpr double kClaimMargin = 9.0;  // of chi-square, between the best and the second best claim

}  // namespace

/// Supporters that contradict the target for long are taken out, and the target goes on without what they
/// said.
void PositionScene::checkSupporters(Time now) {
  const double h = decided_ ? seconds(now - *decided_) : 0.0;
  std::vector<std::pair<std::uint32_t, ViewKey>> wrong;
  for (auto& [id, target] : targets_) {
    const auto state = target.estimator->stateAt(std::max(now, target.estimator->time().value_or(now)));
    if (!state || target.supporters.size() < 2) continue;
    std::pair<double, ViewKey> worst{0.0, {}};
    for (const ViewKey& key : target.supporters) {
      const Local& local = locals_.at(key);
      if (!speaksAt(local, now)) continue;
      const auto distance = distanceSquared(viewAt(local, now).ray, state->mean, state->covariance, false);
      double& contradicted = target.contradicted[key];
      const bool is_wrong = !distance || *distance > params_->contradiction;
      contradicted = is_wrong ? contradicted + h : std::max(0.0, contradicted - h);
      if (contradicted > std::max(worst.first, params_->contradiction_time)) worst = {contradicted, key};
    }
    if (worst.first > 0.0) wrong.emplace_back(id, worst.second);
  }
  for (const auto& [id, key] : wrong) {
    release(id, key);
    Target& target = targets_.at(id);
    if (target.supporters.size() < 2) {  // of two nobody can tell which is wrong
      dissolve(id);
      continue;
    }
    target.contradicted.clear();
    target.estimator = estimatorFrom(target.supporters);
    if (!target.estimator->hasState()) target.lost = now;
  }
}

/// Local tracks of further stations support targets that they agree with, better than with any other.
void PositionScene::claim(Time now) {
  std::map<std::pair<std::uint32_t, ViewKey>, int> claims;
  for (std::size_t tracker = 0; tracker < trackers_.size(); ++tracker) {
    const int station = static_cast<int>(tracker);
    std::vector<LocalView> views;
    for (auto it = locals_.lower_bound({station, 0}); it != locals_.end() && it->first.station == station;
         ++it) {
      const Local& local = it->second;
      if (local.target == 0 && speaksAt(local, now)) views.push_back(viewAt(local, now));
    }
    if (views.empty()) continue;
    std::sort(views.begin(), views.end(), [](const LocalView& a, const LocalView& b) {
      const double x = a.ray.direction.z(), y = b.ray.direction.z();
      return x != y ? x < y : a.key < b.key;
    });
    double widest = 0.0;
    for (const LocalView& view : views) widest = std::max(widest, std::sqrt(view.ray.covariance.trace()));
    const Eigen::Vector3d origin = views.front().ray.origin;
    std::vector<std::uint32_t> ids;
    std::vector<GatedPair> pairs;
    for (const auto& [id, target] : targets_) {
      const bool has_one = std::any_of(target.supporters.begin(), target.supporters.end(),
                                       [&](const ViewKey& key) { return key.station == station; });
      if (has_one) continue;
      const auto state = target.estimator->stateAt(std::max(now, target.estimator->time().value_or(now)));
      if (!state || !target.estimator->isPosition(*state)) continue;
      const Eigen::Vector3d to = state->mean.head<3>() - origin;
      const double range = to.norm();
      const double reach = std::sqrt(params_->claim_gate) *
                           (widest + std::sqrt(state->covariance.topLeftCorner<3, 3>().trace()) / range);
      const double z = to.z() / range;
      auto view =
          std::lower_bound(views.begin(), views.end(), z - reach,
                           [](const LocalView& a, double height) { return a.ray.direction.z() < height; });
      for (; view != views.end() && view->ray.direction.z() <= z + reach; ++view) {
        const auto distance = distanceSquared(view->ray, state->mean, state->covariance, true);
        if (!distance || *distance > params_->claim_gate + kClaimMargin) continue;
        if (ids.empty() || ids.back() != id) ids.push_back(id);
        pairs.push_back(
            {static_cast<int>(ids.size()) - 1, static_cast<int>(view - views.begin()), -*distance});
      }
    }
    for (const std::vector<int>& group : clusters(pairs)) {
      const Cluster cluster = clusterOf(pairs, group, std::vector<double>(ids.size(), 1.0));
      Eigen::MatrixXd cost =
          Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(cluster.tracks.size()),
                                    static_cast<Eigen::Index>(cluster.takers.size()), kForbidden);
      for (std::size_t t = 0; t < cluster.tracks.size(); ++t)
        for (const Cluster::Choice& choice : cluster.choices[t])
          cost(static_cast<Eigen::Index>(t), choice.sighting) =
              -pairs[static_cast<std::size_t>(choice.pair)].log_ratio;
      const std::vector<int> taken = assign(cost, params_->claim_gate);
      for (std::size_t t = 0; t < taken.size(); ++t) {
        if (taken[t] < 0) continue;
        const auto row = static_cast<Eigen::Index>(t);
        const double best = cost(row, taken[t]);
        double second = kForbidden;  // of another target for the track, or of another track for the target
        for (Eigen::Index j = 0; j < cost.cols(); ++j)
          if (j != taken[t]) second = std::min(second, cost(row, j));
        for (Eigen::Index i = 0; i < cost.rows(); ++i)
          if (i != row) second = std::min(second, cost(i, taken[t]));
        if (!(best <= params_->claim_gate) || second - best < kClaimMargin) continue;
        const std::uint32_t id = ids[static_cast<std::size_t>(cluster.tracks[t])];
        const auto pair = std::find_if(group.begin(), group.end(), [&](int p) {
          const GatedPair& gated = pairs[static_cast<std::size_t>(p)];
          return gated.track == cluster.tracks[t] && -gated.log_ratio == best;
        });
        const ViewKey key =
            views[static_cast<std::size_t>(pairs[static_cast<std::size_t>(*pair)].sighting)].key;
        const auto before = claims_.find({id, key});
        const int turns = (before == claims_.end() ? 0 : before->second) + 1;
        if (turns < params_->claim_decisions) {
          claims[{id, key}] = turns;
          continue;
        }
        Target& target = targets_.at(id);
        target.supporters.insert(key);
        target.log_odds = std::min(target.log_odds + 0.5 * kClaimMargin, kMostLogOdds);
        locals_.at(key).target = id;
      }
    }
  }
  claims_ = std::move(claims);
}

/// Two targets of different stations at one place with one velocity are one: the older stays.
void PositionScene::merge(Time now) {
  struct At {
    std::uint32_t id;
    PositionState state;
  };
  std::vector<At> all;
  for (const auto& [id, target] : targets_) {
    const auto state = target.estimator->stateAt(std::max(now, target.estimator->time().value_or(now)));
    if (state && target.estimator->isPosition(*state)) all.push_back({id, *state});
  }
  std::sort(all.begin(), all.end(), [](const At& a, const At& b) {
    return a.state.mean(0) != b.state.mean(0) ? a.state.mean(0) < b.state.mean(0) : a.id < b.id;
  });
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> meetings;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> same;
  double widest = 0.0;
  for (const At& at : all) widest = std::max(widest, at.state.covariance(0, 0));
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      const Eigen::Matrix<double, 6, 1> apart = all[j].state.mean - all[i].state.mean;
      if (apart(0) * apart(0) > params_->merge_gate * 2.0 * widest) break;
      const Eigen::Matrix<double, 6, 6> S = all[i].state.covariance + all[j].state.covariance;
      if (apart.dot(S.llt().solve(apart)) > params_->merge_gate) continue;
      const auto pair = std::minmax(all[i].id, all[j].id);
      std::set<int> stations;
      std::size_t supporters = 0;
      for (const std::uint32_t id : {pair.first, pair.second}) {
        for (const ViewKey& key : targets_.at(id).supporters) {
          stations.insert(key.station);
          ++supporters;
        }
      }
      if (stations.size() < supporters) continue;  // a station sees both
      const auto before = meetings_.find(pair);
      const int turns = (before == meetings_.end() ? 0 : before->second) + 1;
      if (turns < params_->claim_decisions)
        meetings[pair] = turns;
      else
        same.push_back(pair);
    }
  }
  for (const auto& [older, younger] : same) {
    if (!targets_.count(older) || !targets_.count(younger)) continue;
    const std::set<ViewKey> supporters = targets_.at(younger).supporters;
    double& log_odds = targets_.at(older).log_odds;
    log_odds = std::max(log_odds, targets_.at(younger).log_odds);
    dissolve(younger);
    for (const ViewKey& key : supporters) {
      targets_.at(older).supporters.insert(key);
      locals_.at(key).target = older;
    }
  }
  meetings_ = std::move(meetings);
}

}  // namespace sightline::core
