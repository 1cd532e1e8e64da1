#include "sightline/core/positions/position_hypotheses.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>

#include "sightline/core/association/clusters.h"
#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kLog2Pi = 1.8378770664093454836;
constexpr double kSolidAngle = 1.0;   // [sr] over which tracks without partner may lie
constexpr double kRateSpread = 1.0;   // [rad/s] within which their rates may lie
constexpr double kUnknownView = 0.5;  // probability that a station looks there, when its view is not known
constexpr double kMostRepeats = 6.0;  // independent looks that the memory can stand for
constexpr std::size_t kMostMemories = 20000;
constexpr int kMostSteps = 20000;  // of the exact search in one cluster

double logDeterminant(const Eigen::MatrixXd& C) {
  return 2.0 * Eigen::MatrixXd(C.llt().matrixL()).diagonal().array().log().sum();
}

Eigen::Matrix2d acrossRay(const Ray& ray, const Eigen::Matrix3d& C) {
  const Eigen::Matrix<double, 2, 3> B = acrossBasis(ray.direction);
  return symmetric(B * C * B.transpose());
}

/// Rays of one station by height, to find those near a direction.
struct ByHeight {
  std::vector<std::pair<double, const LocalView*>> rays;  // ascending z of the direction
};

bool areDisjoint(const Candidate& a, const Candidate& b) {
  auto i = a.members.begin();
  auto j = b.members.begin();
  while (i != a.members.end() && j != b.members.end()) {
    if (*i == *j) return false;
    if (*i < *j)
      ++i;
    else
      ++j;
  }
  return true;
}

/// Exact search with a bound, in one cluster; best first, so that what is found early is good.
struct Search {
  const std::vector<Candidate>& candidates;
  const std::vector<int>& order;  // by falling score
  std::vector<double> rest;       // sum of the scores from here on
  std::vector<int> chosen, best;
  double best_sum = -1.0;
  int steps = 0;

  void run(std::size_t at, double sum) {
    if (sum > best_sum) {
      best_sum = sum;
      best = chosen;
    }
    if (at == order.size() || sum + rest[at] <= best_sum || ++steps > kMostSteps) return;
    const Candidate& next = candidates[static_cast<std::size_t>(order[at])];
    const bool fits = std::all_of(chosen.begin(), chosen.end(), [&](int other) {
      return areDisjoint(next, candidates[static_cast<std::size_t>(other)]);
    });
    if (fits) {
      chosen.push_back(order[at]);
      run(at + 1, sum + next.score);
      chosen.pop_back();
    }
    run(at + 1, sum);
  }
};

/// Groups of candidates that share members.
std::vector<std::vector<int>> groupsOf(const std::vector<Candidate>& candidates) {
  std::map<ViewKey, int> numbers;
  std::vector<GatedPair> pairs;
  std::vector<int> owner;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    for (const ViewKey& key : candidates[i].members) {
      const int number = numbers.emplace(key, static_cast<int>(numbers.size())).first->second;
      pairs.push_back({static_cast<int>(i), number, 0.0});
      owner.push_back(static_cast<int>(i));
    }
  }
  std::vector<std::vector<int>> groups;
  for (const std::vector<int>& cluster : clusters(pairs)) {
    std::vector<int> group;
    for (const int pair : cluster) group.push_back(owner[static_cast<std::size_t>(pair)]);
    groups.push_back(occurring(group));
  }
  return groups;
}

std::vector<int> bestOfGroup(const std::vector<Candidate>& candidates, const std::vector<int>& group,
                             int forbidden) {
  std::vector<int> order;
  for (const int i : group)
    if (i != forbidden && candidates[static_cast<std::size_t>(i)].score > 0.0) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    const Candidate &x = candidates[static_cast<std::size_t>(a)],
                    &y = candidates[static_cast<std::size_t>(b)];
    return x.score != y.score ? x.score > y.score : x.members < y.members;
  });
  Search search{candidates, order, std::vector<double>(order.size() + 1, 0.0), {}, {}, -1.0, 0};
  for (std::size_t i = order.size(); i-- > 0;)
    search.rest[i] = search.rest[i + 1] + candidates[static_cast<std::size_t>(order[i])].score;
  search.run(0, 0.0);
  return search.best;
}

double sumOf(const std::vector<Candidate>& candidates, const std::vector<int>& chosen) {
  double sum = 0.0;
  for (const int i : chosen) sum += candidates[static_cast<std::size_t>(i)].score;
  return sum;
}

bool isWithin(const Candidate& a, const Candidate& b) {
  return std::includes(b.members.begin(), b.members.end(), a.members.begin(), a.members.end());
}

}  // namespace

PositionHypotheses::PositionHypotheses(const HypothesisParams& params) : params_(params) {
  const auto require = [](bool ok, const char* what) {
    if (!ok) throw std::invalid_argument(std::string("HypothesisParams: ") + what + " is required");
  };
  require(params.gate > 0.0, "gate > 0");
  require(params.max_relative_sigma > 0.0 && params.max_relative_sigma < 1.0,
          "max_relative_sigma between 0 and 1");
  require(params.detection_probability > 0.0 && params.detection_probability < 1.0,
          "detection_probability between 0 and 1");
  require(params.memory > 0.0, "memory > 0 s");
  require(params.correlation_time > 0.0, "correlation_time > 0 s");
  require(params.least_score >= 0.0 && params.least_margin >= 0.0, "least_score, least_margin >= 0");
  require(params.most_candidates >= 1, "most_candidates >= 1");
}

/// (P-10): log of the probability density of the rays of one target, its position integrated out over what
/// may be seen, over that of tracks without partners.
std::optional<Candidate> PositionHypotheses::score(const std::vector<const LocalView*>& members,
                                                   const std::vector<LookingStation>& stations,
                                                   double most_tracks) const {
  std::vector<Ray> rays;
  for (const LocalView* member : members) rays.push_back(member->ray);
  const Crossing crossing = intersect(rays);
  if (crossing.verdict != CrossingVerdict::crossing) return std::nullopt;
  Candidate candidate;
  candidate.at = crossing.at;
  if (!(crossing.at.relative_sigma < params_.max_relative_sigma)) return std::nullopt;
  for (const LocalView* member : members) candidate.members.push_back(member->key);
  std::sort(candidate.members.begin(), candidate.members.end());

  double farthest = 0.0;
  double score = -0.5 * crossing.at.chi_square + 1.5 * kLog2Pi;
  score += 0.5 * logDeterminant(crossing.at.covariance);
  for (const Ray& ray : rays) {
    farthest = std::max(farthest, (crossing.at.point - ray.origin).norm());
    score += std::log(kSolidAngle) - kLog2Pi - 0.5 * logDeterminant(acrossRay(ray, ray.covariance));
  }
  const double reach = 2.0 * farthest;  // as far as targets may be
  score -= std::log(kSolidAngle / 3.0 * reach * reach * reach);
  if (crossing.at.velocity) {
    score += 1.5 * kLog2Pi + 0.5 * logDeterminant(crossing.at.velocityCovariance());
    for (const Ray& ray : rays) {
      if (!ray.motion) continue;
      score += std::log(kPi * kRateSpread * kRateSpread) - kLog2Pi -
               0.5 * logDeterminant(acrossRay(ray, ray.motion->covariance));
    }
    const double speeds = kRateSpread * farthest;
    score -= std::log(4.0 / 3.0 * kPi * speeds * speeds * speeds);
  }
  score -=
      static_cast<double>(rays.size() - 1) * std::log(std::max(most_tracks, 1.0));  // which of them it is
  for (const LookingStation& station : stations) {
    const bool is_member = std::any_of(members.begin(), members.end(), [&](const LocalView* member) {
      return member->key.station == station.station;
    });
    if (is_member) continue;
    double looks = kUnknownView;
    if (station.view) looks = station.view->holds(crossing.at.point - station.origin) ? 1.0 : 0.0;
    score += std::log1p(-looks * params_.detection_probability);
  }
  if (!std::isfinite(score) || !candidate.at.point.allFinite()) return std::nullopt;  // not comparable
  candidate.score = score;
  return candidate;
}

std::vector<Candidate> PositionHypotheses::candidatesOf(const std::vector<LocalView>& views,
                                                        const std::vector<LookingStation>& stations,
                                                        bool& is_complete) const {
  std::map<int, std::vector<const LocalView*>> by_station;
  for (const LocalView& view : views) by_station[view.key.station].push_back(&view);
  std::map<int, ByHeight> heights;
  double most_tracks = 1.0;
  for (auto& [station, of_station] : by_station) {
    most_tracks = std::max(most_tracks, static_cast<double>(of_station.size()));
    ByHeight& sorted = heights[station];
    for (const LocalView* view : of_station) sorted.rays.emplace_back(view->ray.direction.z(), view);
    std::sort(sorted.rays.begin(), sorted.rays.end(), [](const auto& a, const auto& b) {
      return a.first != b.first ? a.first < b.first : a.second->key < b.second->key;
    });
  }

  std::set<std::vector<ViewKey>> known;
  std::vector<Candidate> candidates;
  const auto add = [&](const std::optional<Candidate>& candidate) {
    if (!candidate || !known.insert(candidate->members).second) return;
    candidates.push_back(*candidate);
  };
  const double gate = params_.gate * params_.gate;
  struct AtAngle {
    double angle = 0.0, sigma = 0.0;
    const LocalView* view = nullptr;
  };
  int tested = 0;
  for (auto first = by_station.begin(); first != by_station.end(); ++first) {
    for (auto second = std::next(first); second != by_station.end(); ++second) {
      const Eigen::Vector3d between = second->second.front()->ray.origin - first->second.front()->ray.origin;
      if (!(between.norm() > 0.0)) continue;
      const Eigen::Vector3d axis = between.normalized();
      std::vector<AtAngle> other;
      double widest = 0.0;
      for (const LocalView* view : second->second) {
        const PlaneAngle plane = planeAngle(view->ray, axis);
        other.push_back({plane.angle, std::sqrt(std::min(plane.variance, kPi * kPi)), view});
        widest = std::max(widest, other.back().sigma);
      }
      std::sort(other.begin(), other.end(), [](const AtAngle& a, const AtAngle& b) {
        return a.angle != b.angle ? a.angle < b.angle : a.view->key < b.view->key;
      });
      for (const LocalView* view : first->second) {
        const PlaneAngle plane = planeAngle(view->ray, axis);
        const double reach =
            params_.gate * std::hypot(std::sqrt(std::min(plane.variance, kPi * kPi)), widest);
        for (const double turn : {-2.0 * kPi, 0.0, 2.0 * kPi}) {
          auto at = std::lower_bound(other.begin(), other.end(), plane.angle + turn - reach,
                                     [](const AtAngle& a, double angle) { return a.angle < angle; });
          for (; at != other.end() && at->angle <= plane.angle + turn + reach; ++at) {
            if (++tested > params_.most_candidates) {
              is_complete = false;
              return candidates;
            }
            const auto test = planeTest(view->ray, at->view->ray);
            if (!test || !test->isAhead() || !(test->distanceSquared() <= gate * test->degrees())) continue;
            std::vector<const LocalView*> members{view, at->view};
            auto pair = score(members, stations, most_tracks);
            if (!pair) continue;
            add(pair);
            // Further stations: the ray nearest to the crossing, where it makes the set more likely.
            Candidate best = *pair;
            for (const auto& [station, sorted] : heights) {
              if (station == view->key.station || station == at->view->key.station) continue;
              const Eigen::Vector3d origin = by_station[station].front()->ray.origin;
              const Eigen::Vector3d to = best.at.point - origin;
              const double range = to.norm();
              if (!(range > 0.0)) continue;
              const double spread = std::sqrt(best.at.covariance.trace()) / range +
                                    std::sqrt(by_station[station].front()->ray.covariance.trace());
              const double z = to.z() / range, window = params_.gate * spread;
              const LocalView* nearest = nullptr;
              double least = gate * 4.0;
              auto near = std::lower_bound(sorted.rays.begin(), sorted.rays.end(), z - window,
                                           [](const auto& a, double height) { return a.first < height; });
              for (; near != sorted.rays.end() && near->first <= z + window; ++near) {
                const auto seen = innovationOf(near->second->ray, best.at.point);
                if (!seen) continue;
                const Eigen::Matrix2d S = seen->H * best.at.covariance * seen->H.transpose() + seen->R;
                const double distance = seen->residual.dot(S.llt().solve(seen->residual));
                if (distance >= least) continue;
                least = distance;
                nearest = near->second;
              }
              if (!nearest) continue;
              members.push_back(nearest);
              const auto larger = score(members, stations, most_tracks);
              if (larger && larger->score > best.score)
                best = *larger;
              else
                members.pop_back();
            }
            if (members.size() > 2) add(best);
          }
        }
      }
    }
  }
  return candidates;
}

/// Scores over time (P-10): the mean with forgetting, times the number of independent looks.
void PositionHypotheses::remember(Time now, std::vector<Candidate>& candidates) {
  for (auto it = memory_.begin(); it != memory_.end();) {
    if (seconds(now - it->second.last) > params_.memory)
      it = memory_.erase(it);
    else
      ++it;
  }
  for (Candidate& candidate : candidates) {
    auto found = memory_.find(candidate.members);
    if (found == memory_.end()) {
      if (memory_.size() < kMostMemories) memory_[candidate.members] = {candidate.score, now, now};
      continue;
    }
    Memory& memory = found->second;
    const double h = seconds(now - memory.last);
    const double share = 1.0 - std::exp(-h / params_.memory);
    memory.score += std::max(share, 0.0) * (candidate.score - memory.score);
    memory.last = now;
    const double looks = std::min(1.0 + seconds(now - memory.first) / params_.correlation_time, kMostRepeats);
    candidate.score = memory.score * looks;
  }
}

std::vector<int> bestDisjoint(const std::vector<Candidate>& candidates, int forbidden) {
  std::vector<int> all;
  for (const std::vector<int>& group : groupsOf(candidates)) {
    const std::vector<int> best = bestOfGroup(candidates, group, forbidden);
    all.insert(all.end(), best.begin(), best.end());
  }
  std::sort(all.begin(), all.end());
  return all;
}

HypothesisDecision PositionHypotheses::decide(Time now, std::vector<LocalView> views,
                                              const std::vector<LookingStation>& stations) {  // (P-11)
  std::sort(views.begin(), views.end(), [](const LocalView& a, const LocalView& b) { return a.key < b.key; });
  HypothesisDecision decision;
  std::vector<Candidate> candidates = candidatesOf(views, stations, decision.is_complete);
  std::sort(candidates.begin(), candidates.end(),
            [](const Candidate& a, const Candidate& b) { return a.members < b.members; });
  remember(now, candidates);

  for (const std::vector<int>& group : groupsOf(candidates)) {
    const std::vector<int> chosen = bestOfGroup(candidates, group, -1);
    const double sum = sumOf(candidates, chosen);
    std::vector<int> accepted;
    for (const int i : chosen) {
      Candidate& candidate = candidates[static_cast<std::size_t>(i)];
      // The best explanation without it; a part of it, or more than it, is no other explanation.
      std::vector<int> others;
      for (const int j : group) {
        const Candidate& other = candidates[static_cast<std::size_t>(j)];
        if (!isWithin(other, candidate) && !isWithin(candidate, other)) others.push_back(j);
      }
      candidate.margin = sum - sumOf(candidates, bestOfGroup(candidates, others, i));
      const bool is_target =
          candidate.score >= params_.least_score && candidate.margin >= params_.least_margin;
      if (is_target) {
        decision.targets.push_back(candidate);
        accepted.push_back(i);
      }
    }
    for (const int i : group) {
      const Candidate& candidate = candidates[static_cast<std::size_t>(i)];
      if (std::find(accepted.begin(), accepted.end(), i) != accepted.end()) continue;
      const bool is_part = std::any_of(accepted.begin(), accepted.end(), [&](int other) {
        return isWithin(candidate, candidates[static_cast<std::size_t>(other)]);
      });
      if (is_part) continue;
      const bool is_taken = std::any_of(accepted.begin(), accepted.end(), [&](int other) {
        return !areDisjoint(candidate, candidates[static_cast<std::size_t>(other)]);
      });
      CrossingRefusal reason = CrossingRefusal::ambiguous;
      if (candidate.score < params_.least_score)
        reason = CrossingRefusal::unlikely;
      else if (is_taken)
        reason = CrossingRefusal::ghost;
      decision.refused.push_back({candidate, reason});
    }
  }
  const auto byMembers = [](const Candidate& a, const Candidate& b) { return a.members < b.members; };
  std::sort(decision.targets.begin(), decision.targets.end(), byMembers);
  std::sort(decision.refused.begin(), decision.refused.end(),
            [&](const RefusedCrossing& a, const RefusedCrossing& b) {
              return byMembers(a.candidate, b.candidate);
            });
  return decision;
}

}  // namespace sightline::core
