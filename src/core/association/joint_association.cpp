#include "sightline/core/association/joint_association.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <queue>
#include <stdexcept>
#include <string>
#include <utility>

namespace sightline::core {
namespace {

constexpr double kImpossible = -std::numeric_limits<double>::infinity();
constexpr double kLeastMissWeight = 1e-12;
constexpr double kLargestLogWeight = 600.0;  // exp of it is finite, and so are sums of many
constexpr int kMostOpen = 64;                // sightings that the bits of a set can tell apart

/// What has been summed over many terms that are given by their logarithms.
class LogSum {
 public:
  void add(double log_term) {
    if (log_term <= largest_) {
      if (log_term > kImpossible) sum_ += std::exp(log_term - largest_);
    } else {
      sum_ = sum_ * std::exp(largest_ - log_term) + 1.0;
      largest_ = log_term;
    }
  }
  double value() const { return largest_ + std::log(sum_); }  // kImpossible without terms

 private:
  double largest_ = kImpossible;
  double sum_ = 0.0;
};

/// One cluster with tracks and sightings numbered from 0.
struct Cluster {
  struct Choice {
    int pair = 0;         // index in the caller's list
    int sighting = 0;     // within the cluster
    double weight = 0.0;  // ln(likelihood ratio / miss weight)
  };
  std::vector<int> tracks;                   // the caller's index of each
  std::vector<std::vector<Choice>> choices;  // of each track
  std::vector<std::vector<int>> takers;      // tracks of each sighting
};

/// Position of a value in the sorted list of those that occur.
int indexIn(const std::vector<int>& sorted, int value) {
  return static_cast<int>(std::lower_bound(sorted.begin(), sorted.end(), value) - sorted.begin());
}

std::vector<int> occurring(std::vector<int> values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

Cluster clusterOf(const std::vector<GatedPair>& pairs, const std::vector<int>& group,
                  const std::vector<double>& miss_weight) {
  std::vector<int> tracks, sightings;
  for (const int k : group) {
    tracks.push_back(pairs[k].track);
    sightings.push_back(pairs[k].sighting);
  }
  Cluster cluster;
  cluster.tracks = occurring(std::move(tracks));
  sightings = occurring(std::move(sightings));
  cluster.choices.resize(cluster.tracks.size());
  cluster.takers.resize(sightings.size());
  for (const int k : group) {
    const int track = indexIn(cluster.tracks, pairs[k].track);
    const int sighting = indexIn(sightings, pairs[k].sighting);
    const double miss = std::max(miss_weight[pairs[k].track], kLeastMissWeight);
    cluster.choices[track].push_back({k, sighting, pairs[k].log_ratio - std::log(miss)});
    cluster.takers[sighting].push_back(track);
  }
  return cluster;
}

/// The tracks in an order in which neighbours are near one another: breadth first from the track with the
/// fewest rivals, those with fewer rivals before those with more (E. Cuthill and J. McKee, 1969).
std::vector<int> orderOf(const Cluster& cluster) {
  const int tracks = static_cast<int>(cluster.tracks.size());
  std::vector<std::size_t> rivals(tracks, 0);
  for (int i = 0; i < tracks; ++i) {
    for (const Cluster::Choice& choice : cluster.choices[i])
      rivals[i] += cluster.takers[choice.sighting].size() - 1;
  }
  const auto has_fewer = [&](int a, int b) {
    return std::make_pair(rivals[a], a) < std::make_pair(rivals[b], b);
  };

  std::vector<int> all(tracks);
  std::iota(all.begin(), all.end(), 0);
  std::vector<int> order{*std::min_element(all.begin(), all.end(), has_fewer)};
  std::vector<bool> is_known(tracks, false), is_spread(cluster.takers.size(), false);
  is_known[order.front()] = true;
  for (std::size_t next = 0; next < order.size(); ++next) {  // `order` grows
    const auto first_new = static_cast<std::ptrdiff_t>(order.size());
    for (const Cluster::Choice& choice : cluster.choices[order[next]]) {
      if (is_spread[choice.sighting]) continue;
      is_spread[choice.sighting] = true;
      for (const int taker : cluster.takers[choice.sighting]) {
        if (!is_known[taker]) order.push_back(taker);
        is_known[taker] = true;
      }
    }
    std::sort(order.begin() + first_new, order.end(), has_fewer);
  }
  return order;
}

using SightingSet = std::uint64_t;

/// One step of the exact sum: what a track can do, for each set of sightings that may be taken before it.
struct Step {
  struct Term {
    int from = 0;         // set before
    int to = 0;           // set after
    int choice = -1;      // of the track; -1 = missed
    double weight = 0.0;  // logarithm
  };
  int track = 0;
  std::vector<Term> terms;
  std::size_t sets = 0;  // after it
};

/// Gives each sighting that several tracks could take a bit from its first track to its last.
class OpenSightings {
 public:
  explicit OpenSightings(const Cluster& cluster) : cluster_(cluster), bit_(cluster.takers.size(), -1) {
    for (const std::vector<int>& takers : cluster.takers) ahead_.push_back(takers.size());
  }

  /// Before the track's step; false if there are no bits left.
  bool open(int track) {
    for (const Cluster::Choice& choice : cluster_.choices[track]) {
      if (bit_[choice.sighting] >= 0 || cluster_.takers[choice.sighting].size() < 2) continue;
      int bit = 0;
      while (bit < kMostOpen && (in_use_ >> bit & 1U) != 0) ++bit;
      if (bit == kMostOpen) return false;
      bit_[choice.sighting] = bit;
      in_use_ |= SightingSet{1} << bit;
    }
    return true;
  }

  /// After it: the sightings that no track ahead can take.
  SightingSet close(int track) {
    SightingSet closed = 0;
    for (const Cluster::Choice& choice : cluster_.choices[track]) {
      if (--ahead_[choice.sighting] == 0) closed |= of(choice.sighting);
    }
    in_use_ &= ~closed;
    return closed;
  }

  SightingSet of(int sighting) const { return bit_[sighting] < 0 ? 0 : SightingSet{1} << bit_[sighting]; }

 private:
  const Cluster& cluster_;
  std::vector<int> bit_;            // of each sighting, -1 = has none
  std::vector<std::size_t> ahead_;  // tracks that could still take it
  SightingSet in_use_ = 0;
};

/// All steps; nullopt if they have more than `max_terms` terms.
std::optional<std::vector<Step>> stepsOf(const Cluster& cluster, std::size_t max_terms) {
  const std::vector<int> order = orderOf(cluster);
  OpenSightings open(cluster);
  std::vector<Step> steps;
  std::vector<SightingSet> sets{0}, targets;
  std::size_t terms = 0;
  for (const int track : order) {
    const std::vector<Cluster::Choice>& choices = cluster.choices[track];
    terms += sets.size() * (choices.size() + 1);
    if (terms > max_terms || !open.open(track)) return std::nullopt;

    Step step;
    step.track = track;
    targets.clear();
    const auto add = [&](std::size_t from, int choice, double weight, SightingSet target) {
      step.terms.push_back({static_cast<int>(from), 0, choice, weight});
      targets.push_back(target);
    };
    for (std::size_t from = 0; from < sets.size(); ++from) {
      add(from, -1, 0.0, sets[from]);
      for (std::size_t c = 0; c < choices.size(); ++c) {
        const SightingSet taken = open.of(choices[c].sighting);
        if ((sets[from] & taken) == 0) add(from, static_cast<int>(c), choices[c].weight, sets[from] | taken);
      }
    }
    const SightingSet closed = open.close(track);
    for (SightingSet& target : targets) target &= ~closed;
    sets = targets;
    std::sort(sets.begin(), sets.end());
    sets.erase(std::unique(sets.begin(), sets.end()), sets.end());
    for (std::size_t k = 0; k < targets.size(); ++k) {
      step.terms[k].to =
          static_cast<int>(std::lower_bound(sets.begin(), sets.end(), targets[k]) - sets.begin());
    }
    step.sets = sets.size();
    steps.push_back(std::move(step));
  }
  return steps;
}

/// Sums over the steps forward and backward, and reads the marginals where they meet.
bool sumExactly(const Cluster& cluster, std::size_t max_terms, JointProbabilities& probabilities) {
  const std::optional<std::vector<Step>> steps = stepsOf(cluster, max_terms);
  if (!steps) return false;

  std::vector<std::vector<double>> before{{0.0}};  // each step: ln of the sum behind each set
  for (const Step& step : *steps) {
    std::vector<LogSum> sums(step.sets);
    for (const Step::Term& term : step.terms) sums[term.to].add(before.back()[term.from] + term.weight);
    before.emplace_back();
    for (const LogSum& sum : sums) before.back().push_back(sum.value());
  }
  const double total = before.back().front();  // no sighting is open at the end: one set

  std::vector<double> after{0.0};  // ln of the sum ahead of each set
  for (std::size_t k = steps->size(); k-- > 0;) {
    const Step& step = (*steps)[k];
    const std::vector<Cluster::Choice>& choices = cluster.choices[step.track];
    std::vector<LogSum> sums(before[k].size());
    std::vector<double> marginals(choices.size() + 1, 0.0);  // of the miss, and of each choice
    for (const Step::Term& term : step.terms) {
      const double ahead = term.weight + after[term.to];
      sums[term.from].add(ahead);
      marginals[term.choice + 1] += std::exp(before[k][term.from] + ahead - total);
    }
    after.clear();
    for (const LogSum& sum : sums) after.push_back(sum.value());

    const double sum = std::accumulate(marginals.begin(), marginals.end(), 0.0);  // 1, but for rounding
    probabilities.missed[cluster.tracks[step.track]] = marginals[0] / sum;
    for (std::size_t c = 0; c < choices.size(); ++c)
      probabilities.paired[choices[c].pair] = marginals[c + 1] / sum;
  }
  return true;
}

/// For each value the sum of all others; no differences, which would cancel.
void sumOthers(const std::vector<double>& values, std::vector<double>& sums) {
  sums.assign(values.size(), 0.0);
  double before = 0.0, behind = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    sums[k] += before;
    before += values[k];
  }
  for (std::size_t k = values.size(); k-- > 0;) {
    sums[k] += behind;
    behind += values[k];
  }
}

/// Messages along the edges of a cluster until they stand still (Williams and Lau 2014): to a sighting, how
/// much a track wants it; to a track, how free a sighting is.
class BeliefPropagation {
 public:
  explicit BeliefPropagation(const Cluster& cluster)
      : cluster_(cluster), of_track_(cluster.choices.size()), of_sighting_(cluster.takers.size()) {
    for (std::size_t i = 0; i < cluster.choices.size(); ++i) {
      for (const Cluster::Choice& choice : cluster.choices[i]) {
        of_track_[i].push_back(weight_.size());
        of_sighting_[choice.sighting].push_back(weight_.size());
        weight_.push_back(std::exp(std::min(choice.weight, kLargestLogWeight)));
      }
    }
    wanted_.assign(weight_.size(), 0.0);
    freedom_.assign(weight_.size(), 1.0);
  }

  /// One round of messages; the largest change of `freedom_`.
  double iterate() {
    for (const std::vector<std::size_t>& edges : of_track_) {
      values_.clear();
      for (const std::size_t e : edges) values_.push_back(weight_[e] * freedom_[e]);
      sumOthers(values_, sums_);
      for (std::size_t k = 0; k < edges.size(); ++k) wanted_[edges[k]] = weight_[edges[k]] / (1.0 + sums_[k]);
    }
    double change = 0.0;
    for (const std::vector<std::size_t>& edges : of_sighting_) {
      values_.clear();
      for (const std::size_t e : edges) values_.push_back(wanted_[e]);
      sumOthers(values_, sums_);
      for (std::size_t k = 0; k < edges.size(); ++k) {
        const double freedom = 1.0 / (1.0 + sums_[k]);
        change = std::max(change, std::abs(freedom - freedom_[edges[k]]));
        freedom_[edges[k]] = freedom;
      }
    }
    return change;
  }

  void read(JointProbabilities& probabilities) const {
    for (std::size_t i = 0; i < of_track_.size(); ++i) {
      double sum = 1.0;
      for (const std::size_t e : of_track_[i]) sum += weight_[e] * freedom_[e];
      probabilities.missed[cluster_.tracks[i]] = 1.0 / sum;
      for (std::size_t c = 0; c < of_track_[i].size(); ++c) {
        const std::size_t e = of_track_[i][c];
        probabilities.paired[cluster_.choices[i][c].pair] = weight_[e] * freedom_[e] / sum;
      }
    }
  }

 private:
  const Cluster& cluster_;
  std::vector<std::vector<std::size_t>> of_track_, of_sighting_;  // edges
  std::vector<double> weight_;                                    // likelihood ratio / miss weight
  std::vector<double> wanted_, freedom_;                          // messages to sightings, to tracks
  std::vector<double> values_, sums_;                             // at work
};

void propagateBelief(const Cluster& cluster, const JointAssociationParams& params,
                     JointProbabilities& probabilities) {
  BeliefPropagation propagation(cluster);
  double change = std::numeric_limits<double>::infinity();
  for (int k = 0; k < params.max_iterations && change > params.tolerance; ++k) change = propagation.iterate();
  propagation.read(probabilities);
  probabilities.is_exact = false;
  if (change > params.tolerance) probabilities.has_converged = false;
}

/// A track that has its sightings for itself: the ratio of each to the sum.
void sumAlone(const std::vector<GatedPair>& pairs, const std::vector<int>& group, double miss_weight,
              JointProbabilities& probabilities) {
  const double miss = std::log(std::max(miss_weight, kLeastMissWeight));
  LogSum sum;
  sum.add(miss);
  for (const int k : group) sum.add(pairs[k].log_ratio);
  probabilities.missed[pairs[group.front()].track] = std::exp(miss - sum.value());
  for (const int k : group) probabilities.paired[k] = std::exp(pairs[k].log_ratio - sum.value());
}

bool haveOneTrack(const std::vector<GatedPair>& pairs, const std::vector<int>& group) {
  return std::all_of(group.begin(), group.end(),
                     [&](int k) { return pairs[k].track == pairs[group.front()].track; });
}

void check(bool holds, const std::string& rule) {
  if (!holds) throw std::invalid_argument("jointProbabilities: " + rule);
}

void check(const std::vector<GatedPair>& pairs, const std::vector<double>& miss_weight,
           const JointAssociationParams& params) {
  check(params.max_iterations >= 1 && params.tolerance > 0.0,
        "max_iterations >= 1 and tolerance > 0 are required");
  for (const double weight : miss_weight) {
    check(weight >= 0.0 && weight <= 1.0,
          "a miss weight in [0, 1] is required (1 - P_D P_G), got " + std::to_string(weight));
  }
  for (const GatedPair& pair : pairs) {
    check(pair.track >= 0 && static_cast<std::size_t>(pair.track) < miss_weight.size(),
          "track " + std::to_string(pair.track) + " of a pair is none of the " +
              std::to_string(miss_weight.size()) + " that have a miss weight");
    check(pair.log_ratio < std::numeric_limits<double>::infinity(),  // false for NaN too
          "a log ratio below infinity is required, got " + std::to_string(pair.log_ratio));
  }
}

}  // namespace

JointProbabilities jointProbabilities(const std::vector<GatedPair>& pairs,
                                      const std::vector<double>& miss_weight,
                                      const JointAssociationParams& params) {
  check(pairs, miss_weight, params);
  JointProbabilities probabilities;
  probabilities.missed.assign(miss_weight.size(), 1.0);
  probabilities.paired.assign(pairs.size(), 0.0);
  for (const std::vector<int>& group : clusters(pairs)) {
    if (haveOneTrack(pairs, group)) {
      sumAlone(pairs, group, miss_weight[pairs[group.front()].track], probabilities);
      continue;
    }
    const Cluster cluster = clusterOf(pairs, group, miss_weight);
    if (!sumExactly(cluster, params.max_terms, probabilities))
      propagateBelief(cluster, params, probabilities);
  }
  return probabilities;
}

}  // namespace sightline::core
