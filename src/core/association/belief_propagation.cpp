#include "sightline/core/association/belief_propagation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace sightline::core {
namespace {

constexpr double kLargestLogWeight = 600.0;  // exp of it is finite, and so are sums of many

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

}  // namespace

// (S-34)
void propagateBelief(const Cluster& cluster, const JointAssociationParams& params,
                     JointProbabilities& probabilities) {
  BeliefPropagation propagation(cluster);
  double change = std::numeric_limits<double>::infinity();
  for (int k = 0; k < params.max_iterations && change > params.tolerance; ++k) change = propagation.iterate();
  propagation.read(probabilities);
  probabilities.is_exact = false;
  if (change > params.tolerance) probabilities.has_converged = false;
}

}  // namespace sightline::core
