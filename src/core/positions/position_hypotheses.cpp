#include "sightline/core/positions/position_hypotheses.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kLog2Pi = 1.8378770664093454836;
constexpr double kSolidAngle = 1.0;   // [sr] over which tracks without partner may lie
constexpr double kRateSpread = 1.0;   // [rad/s] within which their rates may lie
constexpr double kUnknownView = 0.5;  // probability that a station looks there, when its view is not known
constexpr double kMostRepeats = 6.0;  // independent looks that the memory can stand for
constexpr std::size_t kMostMemories = 20000;
constexpr double kPartner = 4.0;  // above least_fit_margin: what it is worth that one track more is explained
                                  // by a target that other stations see

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

}  // namespace

double LookingStation::looksAt(const Eigen::Vector3d& point) const {
  if (views.empty()) return kUnknownView;
  const bool holds = std::any_of(views.begin(), views.end(),
                                 [&](const FieldOfView& view) { return view.holds(point - origin); });
  return holds ? 1.0 : 0.0;
}

double logMissed(const Eigen::Vector3d& point, const std::vector<LookingStation>& stations,
                 const std::set<int>& seeing, double detection_probability) {
  double sum = 0.0;
  for (const LookingStation& station : stations)
    if (!seeing.count(station.station)) sum += std::log1p(-station.looksAt(point) * detection_probability);
  return sum;
}

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
  require(params.least_fit_margin >= 0.0, "least_fit_margin >= 0");
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
  std::set<int> seeing;
  for (const LocalView* member : members) seeing.insert(member->key.station);
  score += logMissed(crossing.at.point, stations, seeing, params_.detection_probability);
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

/// Scores over time (P-10): the mean with forgetting, times the number of independent looks. Those that
/// crossed within the memory and do not now are kept as rivals: noise may spoil a crossing for an instant.
void PositionHypotheses::remember(Time now, const std::vector<LocalView>& views,
                                  std::vector<Candidate>& candidates) {
  const auto shareOfNew = [this](double h) { return 1.0 - std::exp(-std::max(h, 0.0) / params_.memory); };
  for (Candidate& candidate : candidates) {
    const double misfit = candidate.at.chi_square - candidate.at.degrees;
    auto found = memory_.find(candidate.members);
    candidate.misfit = misfit;
    if (found == memory_.end()) {
      if (memory_.size() < kMostMemories)
        memory_[candidate.members] = {
            candidate.score, misfit, candidate.at.degrees, candidate.at.point, now, now, now};
      continue;
    }
    Memory& memory = found->second;
    const double share = shareOfNew(seconds(now - memory.last));
    memory.score += share * (candidate.score - memory.score);
    memory.misfit += share * (misfit - memory.misfit);
    memory.degrees = candidate.at.degrees;
    memory.point = candidate.at.point;
    memory.last = memory.fitted = now;
    const double looks = std::min(1.0 + seconds(now - memory.first) / params_.correlation_time, kMostRepeats);
    candidate.score = memory.score * looks;
    candidate.misfit = memory.misfit;
  }
  const double gate = params_.gate * params_.gate;
  const auto isSeen = [&](const ViewKey& key) {
    const auto at = std::lower_bound(views.begin(), views.end(), key,
                                     [](const LocalView& view, const ViewKey& k) { return view.key < k; });
    return at != views.end() && at->key == key;
  };
  for (auto it = memory_.begin(); it != memory_.end();) {
    Memory& memory = it->second;
    if (seconds(now - memory.fitted) > params_.memory) {
      it = memory_.erase(it);
      continue;
    }
    const bool is_absent = it->first.size() == 2 && memory.fitted != now &&
                           std::all_of(it->first.begin(), it->first.end(), isSeen);
    if (is_absent) {
      const double share = shareOfNew(seconds(now - memory.last));
      memory.misfit += share * ((gate - 1.0) * memory.degrees - memory.misfit);
      memory.last = now;
      Candidate candidate;
      candidate.members = it->first;
      candidate.score = memory.score;
      candidate.misfit = memory.misfit;
      candidate.is_present = false;
      candidate.at.point = memory.point;
      candidate.at.degrees = memory.degrees;
      candidates.push_back(std::move(candidate));
    }
    ++it;
  }
}

/// Which of a group of candidates that share tracks are targets (P-11), (P-15).
void PositionHypotheses::judge(const std::vector<Candidate>& candidates, const std::vector<int>& group,
                               HypothesisDecision& decision) const {
  std::vector<double> scores(candidates.size(), 0.0), fits(candidates.size(), 0.0);
  const auto sumOf = [](const std::vector<double>& values, const std::vector<int>& chosen) {
    double sum = 0.0;
    for (const int i : chosen) sum += values[static_cast<std::size_t>(i)];
    return sum;
  };
  for (const int i : group) {
    const Candidate& candidate = candidates[static_cast<std::size_t>(i)];
    if (candidate.is_present) scores[static_cast<std::size_t>(i)] = candidate.score;
  }
  const std::vector<int> chosen = bestOfGroup(candidates, scores, group);
  const double sum = sumOf(scores, chosen);
  const double partner = params_.least_fit_margin + kPartner;
  // Three rays of different targets do not meet in a point, but two in one plane do, for as long as the
  // targets stay there. Where the best explanation fits worse than stated, a difference in fit says less.
  double chi_square = 0.0, degrees = 0.0;
  for (const int i : chosen) {
    const Candidate& candidate = candidates[static_cast<std::size_t>(i)];
    chi_square += candidate.misfit + candidate.at.degrees;
    degrees += candidate.at.degrees;
  }
  const double scale = degrees > 0.0 ? std::max(1.0, chi_square / degrees) : 1.0;
  for (const int i : group) {
    const Candidate& candidate = candidates[static_cast<std::size_t>(i)];
    if (!(candidate.score > 0.0)) continue;  // likelier to be tracks without a partner
    fits[static_cast<std::size_t>(i)] =
        partner * static_cast<double>(candidate.members.size() - 1) - 0.5 * candidate.misfit / scale;
  }
  const bool has_pair = std::any_of(chosen.begin(), chosen.end(), [&](int i) {
    return candidates[static_cast<std::size_t>(i)].members.size() == 2;
  });
  const double best_fit = has_pair ? sumOf(fits, bestOfGroup(candidates, fits, group)) : 0.0;

  std::vector<int> accepted;
  std::vector<Candidate> judged;
  for (const int i : group) {
    Candidate& candidate = judged.emplace_back(candidates[static_cast<std::size_t>(i)]);
    if (std::find(chosen.begin(), chosen.end(), i) == chosen.end()) continue;
    // The best explanation without it; a part of it, or more than it, is no other explanation.
    std::vector<int> others;
    for (const int j : group) {
      const Candidate& other = candidates[static_cast<std::size_t>(j)];
      if (!isWithin(other, candidate) && !isWithin(candidate, other)) others.push_back(j);
    }
    candidate.margin = sum - sumOf(scores, bestOfGroup(candidates, scores, others));
    candidate.fit_margin = partner;
    if (candidate.members.size() == 2)
      candidate.fit_margin = best_fit - sumOf(fits, bestOfGroup(candidates, fits, others));
    const bool is_target = candidate.score >= params_.least_score &&
                           candidate.margin >= params_.least_margin &&
                           candidate.fit_margin >= params_.least_fit_margin;
    if (!is_target) continue;
    decision.targets.push_back(candidate);
    accepted.push_back(i);
  }
  for (std::size_t k = 0; k < group.size(); ++k) {
    const Candidate& candidate = judged[k];
    if (std::find(accepted.begin(), accepted.end(), group[k]) != accepted.end()) continue;
    const bool is_part = std::any_of(accepted.begin(), accepted.end(), [&](int other) {
      return isWithin(candidate, candidates[static_cast<std::size_t>(other)]);
    });
    const bool is_unlikely = candidate.score < params_.least_score;
    if (is_part || (is_unlikely && !candidate.is_present)) continue;
    const bool is_taken = std::any_of(accepted.begin(), accepted.end(), [&](int other) {
      return !areDisjoint(candidate, candidates[static_cast<std::size_t>(other)]);
    });
    CrossingRefusal reason = CrossingRefusal::ambiguous;
    if (is_unlikely)
      reason = CrossingRefusal::unlikely;
    else if (is_taken)
      reason = CrossingRefusal::ghost;
    decision.refused.push_back({candidate, reason});
  }
}

HypothesisDecision PositionHypotheses::decide(Time now, std::vector<LocalView> views,
                                              const std::vector<LookingStation>& stations) {  // (P-11)
  std::sort(views.begin(), views.end(), [](const LocalView& a, const LocalView& b) { return a.key < b.key; });
  const auto byMembers = [](const Candidate& a, const Candidate& b) { return a.members < b.members; };
  HypothesisDecision decision;
  std::vector<Candidate> candidates = candidatesOf(views, stations, decision.is_complete);
  std::sort(candidates.begin(), candidates.end(), byMembers);
  remember(now, views, candidates);
  std::sort(candidates.begin(), candidates.end(), byMembers);
  for (const std::vector<int>& group : groupsOf(candidates)) judge(candidates, group, decision);
  std::sort(decision.targets.begin(), decision.targets.end(), byMembers);
  std::sort(decision.refused.begin(), decision.refused.end(),
            [&](const RefusedCrossing& a, const RefusedCrossing& b) {
              return byMembers(a.candidate, b.candidate);
            });
  return decision;
}

}  // namespace sightline::core
