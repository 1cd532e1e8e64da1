#pragma once

#include <string>
#include <vector>

namespace sightline::core {

/// How local tracks of one target become one, in the order of the table below; the rules for estimates are in
/// fusion_rules.h.
enum class FusionRule {
  best,
  tracklets,
  cross_covariance,
  weighted_covariance,
  covariance_intersection,
  inverse_covariance_intersection
};

/// One rule that a track fusion can apply.
struct FusionRuleEntry {
  FusionRule rule;
  const char* name;         ///< in parameters and in FusedTrack.rule
  const char* description;  ///< one line
};

/// All of them, in the order of FusionRule. What lists or names rules reads it from here.
const std::vector<FusionRuleEntry>& fusionRuleTable();

/// Throws std::invalid_argument for a rule that is not in the table.
std::string nameOf(FusionRule rule);

}  // namespace sightline::core
