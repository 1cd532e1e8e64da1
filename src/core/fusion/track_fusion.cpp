#include "sightline/core/fusion/track_fusion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <sstream>
#include <stdexcept>

#include <Eigen/Cholesky>

#include "sightline/core/association/assignment.h"
#include "sightline/core/fusion/fused_track.h"
#include "sightline/core/model/chi_square.h"
#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr std::size_t kMostFormer = 32;  // local tracks that a global one remembers

constexpr double kForbidden = std::numeric_limits<double>::infinity();
constexpr double kReachSlack = 2.0;        // of the gate, before distances are computed exactly
constexpr double kMergeSlack = 8.0;        // the same for global tracks, whose states are not their opinions
constexpr std::size_t kMostCompared = 30;  // tracks of a report that tell of their tracker's misalignment
constexpr double kShortAge = 0.2;          // for which that is enough [s]

AngularState stateOf(const Estimate<4>& estimate) {
  return {estimate.mean, estimate.covariance};
}

void check(bool holds, const std::string& rule) {
  if (!holds) throw std::invalid_argument("TrackFusionParams: " + rule);
}

void check(const TrackFusionParams& params) {
  check(params.gate_probability > 0.0 && params.gate_probability < 1.0,
        "gate_probability in (0, 1) is required");
  check(params.leave_factor >= 1.0, "leave_factor >= 1 is required");
  check(params.leave_after >= 0.0, "leave_after >= 0 s is required");
  check(params.registration_sigma >= 0.0, "registration_sigma >= 0 rad is required");
  check(params.process_noise >= 0.0,
        "process_noise >= 0 rad^2/s^3 is required (0 = implied by the covariances)");
  check(params.coasting_age >= 0.0 && params.delete_after >= 0.0 && params.remember >= 0.0,
        "coasting_age, delete_after and remember >= 0 s are required");
  check(params.reports.max_age > 0.0 && params.reports.forget_after >= params.reports.max_age,
        "max_age > 0 s and forget_after >= max_age are required");
  check(params.max_tracks >= 1 && params.reports.max_tracks >= 1 && params.reports.max_trackers >= 1,
        "limits >= 1 are required");
  const TrackletFusionParams& tracklets = params.tracklets;
  check(tracklets.max_lag > 0.0 && tracklets.memory > 0.0 && tracklets.max_missing >= 0.0 &&
            tracklets.max_missing <= 1.0,
        "tracklets: max_lag and memory > 0 s, max_missing in [0, 1] are required");
  SensorGuard(tracklets.guard);
  makeEstimator(tracklets.estimator);  // refuses what cannot work before the first tracklet comes
}

/// Tracklets are kept as long as a global track could still take them.
TrackletMemoryParams memoryParams(const TrackFusionParams& params) {
  return {params.tracklets.max_lag + params.tracklets.memory, params.reports.max_trackers};
}

bool isSound(const AngularState& state) {
  return state.mean.allFinite() && state.covariance.allFinite() &&
         Eigen::LLT<Eigen::Matrix4d>(state.covariance).info() == Eigen::Success;
}

}  // namespace

TrackFusion::TrackFusion(const TrackFusionParams& params)
    : params_(params),
      join_threshold_(chiSquareQuantile4(params.gate_probability)),
      reports_(params.reports),
      misalignment_(params.registration_sigma),
      tracklets_(memoryParams(params)) {
  check(params);
}

FusionReport TrackFusion::onReport(const LocalReport& report) {
  const std::string refusal = reports_.take(report);
  if (!refusal.empty()) return refused(report, refusal);

  if (reports_.newest() < time_) entries_.clear();  // the trackers' stamps start again
  time_ = reports_.newest();

  follow(report.tracker);
  separate(report.tracker);
  rearrange(report.tracker);
  for (const auto& named : reports_.trackers()) associate(named.first, named.first == report.tracker);
  for (Entry& entry : entries_) fuse(entry, report.tracker);
  dropSilent();
  latest_ = describe();
  return latest_;
}

std::string TrackFusion::onTracklets(const TrackletReport& report) {
  return tracklets_.take(report);
}

void TrackFusion::reset() {
  reports_ = LocalReports(params_.reports);
  tracklets_ = TrackletMemory(memoryParams(params_));
  entries_.clear();
  waiting_.clear();
  misalignment_ = TrackerMisalignment(params_.registration_sigma);
  time_ = {};
  latest_ = {};
}

/// Brings every global track to the new time, with what its supporters now say; those that are no more go.
void TrackFusion::follow(const std::string& reporting) {
  for (Entry& entry : entries_) {
    entry.track.advance(time_);
    for (std::size_t i = entry.track.supporters().size(); i-- > 0;) {
      const LocalKey key = entry.track.supporters()[i].key;
      const std::uint32_t hits_before = entry.track.supporters()[i].track.hits;
      const LocalTrack* local = reports_.find(key);
      // A track that was believed does not become tentative: its tracker started again and gave the id to
      // another.
      if (local == nullptr || local->track.status == TrackStatus::tentative) {
        if (entry.former.size() >= kMostFormer) entry.former.erase(entry.former.begin());
        if (local == nullptr) entry.former.emplace_back(key, hits_before);
        leave(entry, i);
        continue;
      }
      const std::string why = whyUnusable(key.tracker, *local);
      entry.track.setUnusable(i, why);
      if (!why.empty() || key.tracker != reporting) continue;
      LocalTrack honest = *local;
      honest.track.state.covariance *= entry.tracklets.noiseScale(key);
      const double surprise = entry.track.renew(i, honest);
      const bool is_another =
          local->track.hits < hits_before && surprise > params_.leave_factor * join_threshold_;
      if (is_another) leave(entry, i);
    }
    leaveOutBiased(entry);
  }
  learnMisalignment(reporting);
}

/// How far the reporting tracker's tracks are from what the other trackers say.
void TrackFusion::learnMisalignment(const std::string& reporting) {
  std::vector<Disagreement> disagreements;
  for (const Entry& entry : entries_) {
    if (disagreements.size() >= kMostCompared) break;
    const std::size_t number = entry.track.numberOf(reporting);
    if (number >= entry.track.supporters().size()) continue;
    const Supporter& supporter = entry.track.supporters()[number];
    const bool contradicts = supporter.contradicts_since.has_value();
    if (!supporter.unusable.empty() && !contradicts) continue;
    const std::optional<Estimate<4>> others = entry.track.opinionWithout(reporting);
    if (!others) continue;
    const Eigen::Vector2d apart = angleDifference(supporter.state.angles(), others->mean.head<2>());
    const Eigen::Matrix2d S = supporter.state.anglesCovariance() + others->covariance.topLeftCorner<2, 2>();
    disagreements.push_back({apart.squaredNorm(), 0.5 * S.trace()});
  }
  misalignment_.take(reporting, std::move(disagreements));
}

/// Supporters that contradict the others do not count, and go when they have done so for long.
void TrackFusion::separate(const std::string& reporting) {
  const double threshold = params_.leave_factor * join_threshold_;
  for (Entry& entry : entries_) {
    const std::vector<std::size_t> contradicting =
        entry.track.leaveOutContradictions(misalignment_, threshold, reporting);
    for (auto number = contradicting.rbegin(); number != contradicting.rend(); ++number) {
      const Time since = *entry.track.supporters()[*number].contradicts_since;
      if (seconds(time_ - since) >= params_.leave_after) leave(entry, *number);
    }
  }
}

/// Tracks of the reporting tracker that have lasted in places that are not theirs (their tracker took one
/// target for another, or started a second track) go to their own, all of a group at once. One that waits for
/// a place which another still has does not start a global track meanwhile.
void TrackFusion::rearrange(const std::string& tracker) {
  for (auto it = waiting_.begin(); it != waiting_.end();)
    it = it->first.tracker == tracker ? waiting_.erase(it) : std::next(it);

  const std::vector<SupporterMove> misplaced = misplacedOf(tracker);
  for (auto first = misplaced.begin(); first != misplaced.end();) {
    const auto last = std::find_if(first, misplaced.end(),
                                   [first](const SupporterMove& it) { return it.group != first->group; });
    const std::vector<SupporterMove> movers(first, last);
    const bool is_due = std::any_of(first, last, [this](const SupporterMove& it) {
      if (!it.present) return false;
      const GlobalTrack& track = entries_[*it.present].track;
      return seconds(time_ - *track.supporters()[track.numberOf(it.key.tracker)].misplaced_since) >=
             params_.leave_after;
    });
    if (is_due) {
      move(movers);
    } else {
      for (const SupporterMove& it : movers) {
        if (!it.present && it.best && entries_[*it.best].track.hasTracker(tracker))
          waiting_[it.key] = entries_[*it.best].track.id();
      }
    }
    first = last;
  }
  const auto is_left = [&misplaced, this](const Entry& entry) {
    const auto index = static_cast<std::size_t>(&entry - entries_.data());
    return entry.track.supporters().empty() &&
           std::any_of(misplaced.begin(), misplaced.end(),
                       [index](const SupporterMove& it) { return it.present == index && it.best; });
  };
  std::vector<std::uint32_t> left;
  for (const Entry& entry : entries_) {
    if (is_left(entry)) left.push_back(entry.track.id());
  }
  erase(left);
}

/// By group; each remembers since when it is. One that has no better place stays as long as nobody wants its.
std::vector<SupporterMove> TrackFusion::misplacedOf(const std::string& tracker) {
  std::vector<std::pair<LocalKey, LocalTrack>> free;
  for (const Row& row : freeTracksOf(tracker)) free.emplace_back(*row.key, *reports_.find(*row.key));
  std::vector<const GlobalTrack*> tracks;
  for (const Entry& entry : entries_) tracks.push_back(&entry.track);
  std::vector<SupporterMove> moves =
      supporterMoves(tracker, free, tracks, {join_threshold_, misalignment_.sigma(tracker)});

  const auto isWanted = [&moves](std::size_t place) {
    return std::any_of(moves.begin(), moves.end(),
                       [place](const SupporterMove& it) { return it.best == place && it.present != place; });
  };
  std::vector<SupporterMove> misplaced;
  for (const SupporterMove& it : moves) {
    if (!it.isRight() && (it.best || isWanted(*it.present))) misplaced.push_back(it);
  }
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    GlobalTrack& track = entries_[i].track;
    if (!track.hasTracker(tracker)) continue;
    track.setMisplaced(track.numberOf(tracker),
                       std::any_of(misplaced.begin(), misplaced.end(),
                                   [i](const SupporterMove& it) { return it.present == i; }));
  }
  return misplaced;
}

/// First all leave, then each joins. What one said elsewhere since it was misplaced is taken back there, and
/// what it said before is not said here.
void TrackFusion::move(const std::vector<SupporterMove>& movers) {
  std::vector<std::optional<Time>> since(movers.size());
  for (std::size_t k = 0; k < movers.size(); ++k) {
    if (!movers[k].present) continue;
    Entry& entry = entries_[*movers[k].present];
    const std::size_t number = entry.track.numberOf(movers[k].key.tracker);
    since[k] = entry.track.supporters()[number].misplaced_since;
    leave(entry, number);
  }
  for (std::size_t k = 0; k < movers.size(); ++k) {
    if (!movers[k].best) continue;
    Entry& entry = entries_[*movers[k].best];
    if (since[k]) entry.tracklets.passOver(movers[k].key, *since[k], tracklets_);
    entry.track.join(movers[k].key, *reports_.find(movers[k].key));
    entry.track.compareSupporters(misalignment_);
  }
}

/// Finds a global track for each free local track of `tracker`, by optimal assignment; with `merge` also for
/// the global tracks that it supports already, which then become one with the one found. What is left starts
/// a global track.
void TrackFusion::associate(const std::string& tracker, bool merge) {
  std::vector<Row> rows = freeTracksOf(tracker);
  if (rows.empty() && !merge) return;
  std::vector<std::size_t> columns, supported;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (seconds(time_ - entries_[i].track.lastFusion()) > params_.delete_after) continue;
    (entries_[i].track.hasTracker(tracker) ? supported : columns).push_back(i);
  }
  if (merge) {
    for (const std::size_t i : supported) {
      const GlobalTrack& track = entries_[i].track;
      const bool has_neighbour = std::any_of(columns.begin(), columns.end(), [&](std::size_t column) {
        return areNear(track, entries_[column].track);
      });
      if (has_neighbour) rows.push_back({{}, i, track.chart().toTracking(stateOf(track.opinion())), time_});
    }
  }
  if (rows.empty()) return;

  double cost_alone = 0.0;
  const Eigen::MatrixXd cost = costs(rows, columns, cost_alone);
  const std::vector<int> found = assign(cost, cost_alone);
  std::vector<std::pair<std::size_t, std::size_t>> same;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const std::optional<LocalKey>& key = rows[row].key;
    if (found[row] < 0) {
      if (key) start(*key);
      continue;
    }
    const std::size_t entry = columns[static_cast<std::size_t>(found[row])];
    if (key) {
      entries_[entry].track.join(*key, *reports_.find(*key));
      entries_[entry].track.compareSupporters(misalignment_);
    } else {
      same.emplace_back(rows[row].entry, entry);
    }
  }
  unite(same);
}

/// Normalised distances squared and ln det of their covariances, so that a vague track near to many does not
/// take a sharp one's place; infinite beyond the gate, and between global tracks with a tracker in common. To
/// stay alone costs as much as the vaguest pair at the gate.
Eigen::MatrixXd TrackFusion::costs(const std::vector<Row>& rows, const std::vector<std::size_t>& columns,
                                   double& cost_alone) const {
  double largest_log_determinant = -kForbidden;
  Eigen::MatrixXd costs = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(rows.size()),
                                                    static_cast<Eigen::Index>(columns.size()), kForbidden);
  std::vector<Eigen::Vector3d> directions;
  for (const Row& row : rows) directions.push_back(directionOf(row.state_tracking.angles()));
  for (Eigen::Index column = 0; column < costs.cols(); ++column) {
    const GlobalTrack& track = entries_[columns[static_cast<std::size_t>(column)]].track;
    const Estimate<4> opinion = track.opinion();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Row& row = rows[i];
      const Eigen::Vector2d place = track.chart().coordinatesOf(directions[i]);
      if (isFarAway(row, place, opinion) || !track.chart().holds(place)) continue;
      if (!row.key && entries_[row.entry].track.hasAnyTrackerOf(track)) continue;
      const AngularState aligned = track.aligned(row.state_tracking, row.time);
      const double distance_squared =
          distanceSquared({aligned.mean, aligned.covariance}, opinion, sigmaOf(row));
      if (!(distance_squared <= join_threshold_)) continue;
      const double log_determinant = uncertainty({opinion.mean, aligned.covariance + opinion.covariance});
      costs(static_cast<Eigen::Index>(i), column) = distance_squared + log_determinant;
      largest_log_determinant = std::max(largest_log_determinant, log_determinant);
    }
  }
  cost_alone = std::isfinite(largest_log_determinant) ? join_threshold_ + largest_log_determinant : 0.0;
  return costs;
}

double TrackFusion::sigmaOf(const Row& row) const {
  return row.key ? misalignment_.sigma(row.key->tracker) : misalignment_.largestSigma();
}

/// Whether two global tracks may be one, before that is computed exactly.
bool TrackFusion::areNear(const GlobalTrack& a, const GlobalTrack& b) const {
  const double variance = a.state().anglesCovariance().trace() + b.state().anglesCovariance().trace() +
                          2.0 * misalignment_.largestSigma() * misalignment_.largestSigma();
  const Eigen::Vector3d apart =
      a.chart().directionAt(a.state().angles()) - b.chart().directionAt(b.state().angles());
  return apart.squaredNorm() <= kMergeSlack * join_threshold_ * variance;
}

/// Whether a row at `place` in the chart of an opinion is out of its gate for certain, however its covariance
/// grows on the way to the common time.
bool TrackFusion::isFarAway(const Row& row, const Eigen::Vector2d& place, const Estimate<4>& opinion) const {
  const double age = std::abs(seconds(time_ - row.time));
  if (age > kShortAge) return false;
  const Eigen::Vector2d apart = angleDifference(place, opinion.mean.head<2>());
  const double variance = row.state_tracking.covariance.trace() +  // of rates too: they grow in < 1 s
                          opinion.covariance.topLeftCorner<2, 2>().trace() +
                          2.0 * sigmaOf(row) * sigmaOf(row);
  const double reach =
      std::sqrt(kReachSlack * join_threshold_ * variance) + age * row.state_tracking.mean.tail<2>().norm();
  return apart.squaredNorm() > reach * reach;
}

/// Each pair of entries becomes one, under the older's id.
void TrackFusion::unite(const std::vector<std::pair<std::size_t, std::size_t>>& pairs) {
  std::vector<std::uint32_t> gone;
  for (const auto& [one, other] : pairs) {  // entries stand in ascending order of id
    const std::size_t older = std::min(one, other), younger = std::max(one, other);
    entries_[older].track.absorb(entries_[younger].track);
    entries_[older].track.compareSupporters(misalignment_);
    gone.push_back(entries_[younger].track.id());
  }
  erase(gone);
}

void TrackFusion::erase(const std::vector<std::uint32_t>& ids) {
  const auto is_gone = [&ids](const Entry& entry) {
    return std::find(ids.begin(), ids.end(), entry.track.id()) != ids.end();
  };
  entries_.erase(std::remove_if(entries_.begin(), entries_.end(), is_gone), entries_.end());
}

void TrackFusion::start(const LocalKey& key) {
  const LocalTrack& local = *reports_.find(key);
  if (local.track.status != TrackStatus::confirmed) return;
  const auto knowsIt = [&](const Entry& entry) {
    return entry.track.supporters().empty() &&
           std::any_of(entry.former.begin(), entry.former.end(), [&](const auto& former) {
             return former.first == key && former.second < local.track.hits;
           });
  };
  const auto before = std::find_if(entries_.begin(), entries_.end(), knowsIt);
  if (before != entries_.end()) {
    before->track.join(key, local);
    return;
  }
  if (entries_.size() >= static_cast<std::size_t>(params_.max_tracks)) return;
  Entry entry{GlobalTrack(next_id_++, time_, key, local, params_.process_noise),
              TrackletFusion(params_.tracklets),
              {},
              {}};
  entry.report.track.id = entry.track.id();
  entries_.push_back(std::move(entry));
}

/// A supporter goes. What it says from now on does not count; what it said while it contradicted, or was
/// in the wrong place, is taken back.
void TrackFusion::leave(Entry& entry, std::size_t supporter) const {
  const Supporter& leaving = entry.track.supporters()[supporter];
  const std::optional<Time>& since =
      leaving.contradicts_since ? leaving.contradicts_since : leaving.misplaced_since;
  if (since) entry.tracklets.takeBack(leaving.key, *since);
  entry.tracklets.leave(leaving.key);
  entry.track.leave(supporter);
}

void TrackFusion::fuse(Entry& entry, const std::string& reporting) {
  feedTracklets(entry);
  leaveOutBiased(entry);
  std::optional<Outcome> outcome = fromTracklets(entry);
  if (!outcome) outcome = fromTracks(entry);
  entry.report.rule = outcome->rule;
  describeLeftOut(entry.track, outcome->choice.left_out, entry.report);
  if (outcome->choice.used.empty()) {
    describeCoasting(entry.track, entry.report);
  } else {
    entry.track.setFused(outcome->choice.used, outcome->state);
    describeFusion(entry.track, outcome->choice.used, outcome->shares, reporting, entry.report);
  }
}

bool TrackFusion::usesTracklets() const {
  return params_.rule == FusionRule::best || params_.rule == FusionRule::tracklets;
}

/// Supporters whose sensors are known to be off do not count, and are not held to contradict.
void TrackFusion::leaveOutBiased(Entry& entry) const {
  const auto& supporters = entry.track.supporters();
  for (std::size_t i = 0; i < supporters.size(); ++i) {
    if (!supporters[i].unusable.empty()) continue;
    const std::string why = entry.tracklets.whyExcluded(supporters[i].key);
    if (!why.empty()) entry.track.setUnusable(i, why);
  }
}

/// The supporters' tracklets go into the global track, where those of a sensor that does harm are found out;
/// where that cannot be told, those of a supporter that contradicts the others are taken back from when that
/// began.
void TrackFusion::feedTracklets(Entry& entry) {
  const std::size_t late_before = entry.tracklets.late();
  for (const Supporter& supporter : entry.track.supporters()) {
    const bool contradicts = !supporter.unusable.empty() && supporter.contradicts_since;
    if (contradicts && !entry.tracklets.canTellWhoIsWrong()) {
      entry.tracklets.takeBack(supporter.key, *supporter.contradicts_since);
    } else {
      entry.tracklets.feed(supporter, tracklets_);
    }
  }
  late_tracklets_ += entry.tracklets.late() - late_before;
  if (!usesTracklets()) return;
  entry.tracklets.stateAt(time_);
  entry.report.sensors = entry.tracklets.sensors();
  entry.report.sensor_changes = entry.tracklets.newChanges();
}

/// The state by the supporters' tracklets, if that is the rule and they are good enough. A single local track
/// that is all there is goes through as it is.
std::optional<TrackFusion::Outcome> TrackFusion::fromTracklets(Entry& entry) {
  std::string& why_not = entry.report.why_not_tracklets;
  why_not.clear();
  if (!usesTracklets()) return std::nullopt;
  Outcome outcome{FusionRule::tracklets, chooseContributors(entry.track, params_.coasting_age, true), {}, {}};
  const std::vector<std::size_t>& used = outcome.choice.used;
  std::map<LocalKey, double> shares = entry.tracklets.shares();
  if (used.empty() || (used.size() == 1 && shares.size() <= 1)) return std::nullopt;

  std::vector<const Supporter*> supporters;
  for (const std::size_t number : used) supporters.push_back(&entry.track.supporters()[number]);
  why_not = whyIncomplete(supporters, tracklets_, params_.tracklets);
  if (!why_not.empty() && params_.rule == FusionRule::best) return std::nullopt;
  const auto state = entry.tracklets.stateAt(time_);
  if (!state || !isSound(*state)) {
    why_not = state ? "tracklets give no usable covariance" : "no tracklets yet";
    return std::nullopt;
  }
  outcome.state = entry.track.chart().fromTracking(*state);
  const double distance_squared = distanceSquared({outcome.state.mean, outcome.state.covariance},
                                                  entry.track.opinion(), params_.registration_sigma);
  if (!(distance_squared <= params_.leave_factor * join_threshold_)) {
    why_not = "tracklets contradict the tracks: distance squared " + std::to_string(distance_squared);
    return std::nullopt;
  }
  for (const Supporter* supporter : supporters) outcome.shares.push_back(shares[supporter->key]);
  const double sum = std::accumulate(outcome.shares.begin(), outcome.shares.end(), 0.0);
  if (!(sum > 0.0)) return std::nullopt;
  for (double& share : outcome.shares) share /= sum;
  return outcome;
}

/// The state by the supporters' states.
TrackFusion::Outcome TrackFusion::fromTracks(const Entry& entry) const {
  const GlobalTrack& track = entry.track;
  FusionRule rule = params_.rule;
  if (rule == FusionRule::best || rule == FusionRule::tracklets) {
    rule = nameTheirSensors(track, track.usable()) ? FusionRule::cross_covariance
                                                   : FusionRule::covariance_intersection;
  }
  const bool any_correlation = rule == FusionRule::covariance_intersection;
  Outcome outcome{
      rule,
      chooseContributors(track, params_.coasting_age, any_correlation || params_.allow_shared_sensors),
      {},
      {}};
  std::vector<std::size_t>& used = outcome.choice.used;
  std::optional<FusedEstimate<4>> fused = combine(rule, track, used);
  if (!fused && used.size() > 1) {
    // Not reachable with covariances that passed the checks, but an operator should read it if it is.
    for (std::size_t i = 1; i < used.size(); ++i) {
      outcome.choice.left_out.emplace_back(used[i],
                                           "undetermined: the rule has no solution for these covariances");
    }
    used.resize(1);
    fused = combine(rule, track, used);
  }
  if (fused) {
    outcome.state = {fused->mean, fused->covariance};
    outcome.shares = positionShares(fused->gains);
  }
  return outcome;
}

std::optional<FusedEstimate<4>> TrackFusion::combine(FusionRule rule, const GlobalTrack& track,
                                                     const std::vector<std::size_t>& used) const {
  std::vector<Estimate<4>> estimates;
  for (const std::size_t number : used) {
    const AngularState& state = track.supporters()[number].state;
    estimates.push_back({state.mean, state.covariance});
  }
  if (estimates.empty()) return std::nullopt;
  if (estimates.size() == 1) {
    return FusedEstimate<4>{estimates[0].mean, estimates[0].covariance, {Eigen::Matrix4d::Identity()}};
  }
  switch (rule) {
    case FusionRule::weighted_covariance:
      return weightedCovariance(estimates);
    case FusionRule::covariance_intersection:
      return covarianceIntersection(estimates, params_.intersection_weights);
    case FusionRule::inverse_covariance_intersection:
      return inverseCovarianceIntersection(estimates);
    default:
      return maximumLikelihood(estimates, track.crossCovariance().joint(estimates, used));
  }
}

void TrackFusion::dropSilent() {
  const auto is_silent = [this](const Entry& entry) {
    return seconds(time_ - entry.track.lastFusion()) > std::max(params_.delete_after, params_.remember);
  };
  entries_.erase(std::remove_if(entries_.begin(), entries_.end(), is_silent), entries_.end());
}

FusionReport TrackFusion::describe() const {
  FusionReport report;
  report.time = time_;
  for (const Entry& entry : entries_) {
    if (!entry.track.supporters().empty()) report.tracks.push_back(entry.report);
  }
  for (const auto& [name, tracker] : reports_.trackers()) {
    const auto add = [&report, name = &name, age = reports_.age(tracker.time)](std::uint32_t id,
                                                                               std::string why) {
      report.left_out.push_back(
          {*name, id, 0.0, std::numeric_limits<double>::quiet_NaN(), age, std::move(why)});
    };
    const std::vector<std::uint32_t> supporters = supportersOf(name);
    for (const auto& [id, local] : tracker.tracks) {
      if (std::binary_search(supporters.begin(), supporters.end(), id)) continue;
      std::string why = whyUnusable(name, local);
      const auto waits = waiting_.find({name, id});
      if (why.empty() && waits != waiting_.end())
        why = "contested: another track of its tracker still has its place in global track " +
              std::to_string(waits->second);
      if (why.empty() && local.track.status == TrackStatus::coasting)
        why = "coasting: it cannot start a global track";
      if (why.empty())
        why = "limit: already " + std::to_string(entries_.size()) + " global tracks (max_tracks)";
      add(id, why);
    }
    for (const auto& [id, why] : tracker.surplus) add(id, why);
  }
  return report;
}

FusionReport TrackFusion::refused(const LocalReport& report, const std::string& why) const {
  FusionReport result = latest_;
  result.refusal = why;
  for (FusedTrack& track : result.tracks) track.sensor_changes.clear();
  for (const Track& track : report.tracks) {
    if (result.left_out.size() >= static_cast<std::size_t>(params_.reports.max_tracks)) break;
    result.left_out.push_back({report.tracker, track.id, 0.0, std::numeric_limits<double>::quiet_NaN(),
                               seconds(latest_.time - report.time), why});
  }
  return result;
}

std::string TrackFusion::whyUnusable(const std::string& tracker, const LocalTrack& local) const {
  if (!local.invalid.empty()) return local.invalid;
  if (local.track.status == TrackStatus::tentative) return "tentative: its tracker does not believe it yet";
  const double age = reports_.age(local.time);
  const double max_age = reports_.maxAge(tracker);
  if (age <= max_age) return {};
  std::ostringstream why;
  why << "stale: the report is " << age << " s older than the newest (max_age " << max_age << " s)";
  return why.str();
}

/// Ids of the tracker's tracks that support a global one, ascending.
std::vector<std::uint32_t> TrackFusion::supportersOf(const std::string& tracker) const {
  std::vector<std::uint32_t> ids;
  for (const Entry& entry : entries_) {
    const std::size_t number = entry.track.numberOf(tracker);
    if (number < entry.track.supporters().size()) ids.push_back(entry.track.supporters()[number].key.id);
  }
  std::sort(ids.begin(), ids.end());
  return ids;
}

std::vector<TrackFusion::Row> TrackFusion::freeTracksOf(const std::string& tracker) const {
  std::vector<Row> free;
  const std::vector<std::uint32_t> supporters = supportersOf(tracker);
  for (const auto& [id, local] : reports_.trackers().at(tracker).tracks) {
    if (std::binary_search(supporters.begin(), supporters.end(), id)) continue;
    if (!whyUnusable(tracker, local).empty() || waiting_.count({tracker, id}) > 0) continue;
    const LocalKey key{tracker, id};
    free.push_back({key, 0, local.track.state, local.time});
  }
  return free;
}

}  // namespace sightline::core
