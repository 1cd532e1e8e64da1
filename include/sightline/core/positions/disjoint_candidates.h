#pragma once

#include <vector>

#include "sightline/core/positions/local_view.h"
#include "sightline/core/positions/rays.h"

namespace sightline::core {

/// A set of local tracks, one a station at most, that may be one target.
struct Candidate {
  std::vector<ViewKey> members;  ///< ascending
  double score = 0.0;            ///< log likelihood ratio to tracks without a partner, over the memory (P-10)
  double margin = 0.0;           ///< by which the best explanation with it is better than the best without it
  double fit_margin = 0.0;       ///< the same by the residuals alone (P-15)
  double misfit = 0.0;           ///< chi-square less its degrees of freedom, mean over the memory
  bool is_present = true;        ///< its rays cross now; false: they did within the memory
  Intersection at;               ///< of one that is not present, the last point and degrees
};

bool areDisjoint(const Candidate& a, const Candidate& b);

/// Whether all members of `a` are members of `b`.
bool isWithin(const Candidate& a, const Candidate& b);

/// Groups of candidates that share members, by index.
std::vector<std::vector<int>> groupsOf(const std::vector<Candidate>& candidates);

/// The set of disjoint candidates of a group with the largest sum of values > 0, one value for each
/// candidate. A search with a bound: exact for groups of up to about twenty, the best found in bounded time
/// beyond (P-11).
std::vector<int> bestOfGroup(const std::vector<Candidate>& candidates, const std::vector<double>& values,
                             const std::vector<int>& group);

}  // namespace sightline::core
