#include "sightline/core/fusion/track_combination.h"

#include <map>
#include <numeric>
#include <utility>

#include <Eigen/Cholesky>

#include "sightline/core/fusion/rules/fusion_rules.h"

namespace sightline::core {
namespace {

bool isSound(const AngularState& state) {
  return state.mean.allFinite() && state.covariance.allFinite() &&
         Eigen::LLT<Eigen::Matrix4d>(state.covariance).info() == Eigen::Success;
}

const Refusal kUndetermined{"undetermined", "the rule has no solution for these covariances"};

std::vector<const Supporter*> supportersOf(const GlobalTrack& track,
                                           const std::vector<std::size_t>& numbers) {
  std::vector<const Supporter*> supporters;
  for (const std::size_t number : numbers) supporters.push_back(&track.supporters()[number]);
  return supporters;
}

/// The shares of these supporters alone, summing to one; nullopt when they have none.
std::optional<std::vector<double>> sharesOf(const std::vector<const Supporter*>& supporters,
                                            std::map<LocalKey, double>& by_key) {
  std::vector<double> shares;
  for (const Supporter* supporter : supporters) shares.push_back(by_key[supporter->key]);
  const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
  if (!(sum > 0.0)) return std::nullopt;
  for (double& share : shares) share /= sum;
  return shares;
}

/// The state by the supporters' tracklets, if that is the rule and they are good enough. A single local track
/// that is all there is goes through as it is.
std::optional<CombinedState> fromTracklets(GlobalTrackEntry& entry, const TrackletMemory& memory,
                                           const TrackFusionParams& params,
                                           const DistanceThresholds& thresholds) {
  std::optional<Refusal>& why_not = entry.report.why_not_tracklets;
  why_not.reset();
  if (!usesTracklets(params.rule)) return std::nullopt;
  CombinedState combined{
      FusionRule::tracklets, chooseContributors(entry.track, params.coasting_age, true), {}, {}};
  const std::vector<std::size_t>& used = combined.contributors.used;
  std::map<LocalKey, double> shares = entry.tracklets.shares();
  if (used.empty() || (used.size() == 1 && shares.size() <= 1)) return std::nullopt;

  const std::vector<const Supporter*> supporters = supportersOf(entry.track, used);
  why_not = whyIncomplete(supporters, memory, params.tracklets);
  if (why_not && params.rule == FusionRule::best) return std::nullopt;
  const auto state = entry.tracklets.stateAt(entry.track.time());
  if (!state || !isSound(*state)) {
    why_not = state ? Refusal{"undetermined", "tracklets give no usable covariance"}
                    : Refusal{"no tracklets", "no tracklets yet"};
    return std::nullopt;
  }
  combined.state = entry.track.chart().fromTracking(*state);
  const double distance_squared = distanceSquared({combined.state.mean, combined.state.covariance},
                                                  entry.track.opinion(), params.registration_sigma);
  if (!(distance_squared <= thresholds.contradict)) {
    why_not = Refusal{"contradiction", "tracklets contradict the tracks: distance squared " +
                                           std::to_string(distance_squared)};
    return std::nullopt;
  }
  const auto shares_of_used = sharesOf(supporters, shares);
  if (!shares_of_used) return std::nullopt;
  combined.shares = *shares_of_used;
  return combined;
}

/// The rule for the supporters' states where tracklets are not used.
FusionRule ruleForStates(const GlobalTrack& track, FusionRule configured) {
  if (configured != FusionRule::best && configured != FusionRule::tracklets) return configured;
  return nameTheirSensors(track, track.usable()) ? FusionRule::cross_covariance
                                                 : FusionRule::covariance_intersection;
}

std::optional<FusedEstimate<4>> applyRule(FusionRule rule, const GlobalTrack& track,
                                          const std::vector<std::size_t>& used, IntersectionWeights weights) {
  std::vector<Estimate<4>> estimates;
  for (const std::size_t number : used) estimates.push_back(track.estimateOf(number));
  if (estimates.empty()) return std::nullopt;
  if (estimates.size() == 1) {
    return FusedEstimate<4>{estimates[0].mean, estimates[0].covariance, {Eigen::Matrix4d::Identity()}};
  }
  switch (rule) {
    case FusionRule::weighted_covariance:
      return weightedCovariance(estimates);
    case FusionRule::covariance_intersection:
      return covarianceIntersection(estimates, weights);
    case FusionRule::inverse_covariance_intersection:
      return inverseCovarianceIntersection(estimates);
    default:
      return maximumLikelihood(estimates, track.crossCovariance().joint(estimates, used));
  }
}

std::optional<FusedEstimate<4>> soundOf(std::optional<FusedEstimate<4>> fused) {
  if (fused && !isSound({fused->mean, fused->covariance})) fused.reset();
  return fused;
}

/// The state by the supporters' states.
CombinedState fromStates(const GlobalTrack& track, const TrackFusionParams& params) {
  const FusionRule rule = ruleForStates(track, params.rule);
  const bool any_correlation = rule == FusionRule::covariance_intersection;
  CombinedState combined{
      rule,
      chooseContributors(track, params.coasting_age, any_correlation || params.allow_shared_sensors),
      {},
      {}};
  std::vector<std::size_t>& used = combined.contributors.used;
  std::optional<FusedEstimate<4>> fused = soundOf(applyRule(rule, track, used, params.intersection_weights));
  if (!fused && used.size() > 1) {
    // Not reachable with covariances that passed the checks, but an operator should read it if it is.
    for (std::size_t i = 1; i < used.size(); ++i) {
      combined.contributors.left_out.emplace_back(used[i], kUndetermined);
    }
    used.resize(1);
    fused = soundOf(applyRule(rule, track, used, params.intersection_weights));
  }
  if (fused) {
    combined.state = {fused->mean, fused->covariance};
    combined.shares = positionShares(fused->gains);
  } else {
    for (const std::size_t number : used) combined.contributors.left_out.emplace_back(number, kUndetermined);
    used.clear();
  }
  return combined;
}

}  // namespace

TrackletLosses feedTracklets(GlobalTrackEntry& entry, const TrackletMemory& memory,
                             const TrackFusionParams& params) {
  if (!usesTracklets(params.rule)) return {};
  const std::size_t late_before = entry.tracklets.late();
  const std::size_t failed_before = entry.tracklets.failures().count;
  for (const Supporter& supporter : entry.track.supporters()) {
    const bool contradicts = supporter.unusable && supporter.contradicts_since;
    if (contradicts && !entry.tracklets.canTellWhoIsWrong()) {
      entry.tracklets.takeBack(supporter.key, *supporter.contradicts_since);
    } else {
      entry.tracklets.feed(supporter, memory);
    }
  }
  TrackletLosses losses{entry.tracklets.late() - late_before, {}};
  entry.tracklets.advanceTo(entry.track.time());
  entry.report.sensors = entry.tracklets.sensors();
  entry.report.sensor_changes = entry.tracklets.newChanges();
  losses.failed = entry.tracklets.failures();
  losses.failed.count -= failed_before;
  return losses;
}

CombinedState combine(GlobalTrackEntry& entry, const TrackletMemory& memory, const TrackFusionParams& params,
                      const DistanceThresholds& thresholds) {
  if (auto combined = fromTracklets(entry, memory, params, thresholds)) return *combined;
  return fromStates(entry.track, params);
}

TrackletLosses fuse(GlobalTrackEntry& entry, const NewReports& new_reports, const TrackletMemory& memory,
                    const TrackFusionParams& params, const DistanceThresholds& thresholds) {
  TrackletLosses losses = feedTracklets(entry, memory, params);
  leaveOutBiased(entry);
  const CombinedState combined = combine(entry, memory, params, thresholds);
  entry.report.rule = combined.rule;
  describeLeftOut(entry.track, combined.contributors.left_out, entry.report);
  if (combined.contributors.used.empty()) {
    describeCoasting(entry.track, entry.report);
  } else {
    entry.track.setFused(combined.contributors.used, combined.state);
    describeFusion(entry.track, combined.contributors.used, combined.shares, new_reports, entry.report);
  }
  return losses;
}

}  // namespace sightline::core
