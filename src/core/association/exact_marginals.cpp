#include "sightline/core/association/exact_marginals.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "sightline/core/association/log_sum.h"

namespace sightline::core {
namespace {

constexpr int kMostOpen = 64;  // sightings that the bits of a set can tell apart

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

}  // namespace

// (S-33)
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

}  // namespace sightline::core
