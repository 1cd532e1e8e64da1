#include "sightline/core/fusion/rules/fusion_rule_table.h"

#include <stdexcept>

namespace sightline::core {

const std::vector<FusionRuleEntry>& fusionRuleTable() {
  static const std::vector<FusionRuleEntry> table{
      {FusionRule::best, "best", "the best that the inputs allow, decided for each track at each fusion"},
      {FusionRule::tracklets, "tracklets",
       "an estimator of the global track's own, on its supporters' tracklets"},
      {FusionRule::cross_covariance, "cross_covariance",
       "Bar-Shalom and Campo, maximum likelihood for more than two"},
      {FusionRule::weighted_covariance, "weighted_covariance", "the paper's: errors taken as independent"},
      {FusionRule::covariance_intersection, "covariance_intersection", "whatever the correlation is"},
      {FusionRule::inverse_covariance_intersection, "inverse_covariance_intersection",
       "for sources that know something in common"}};
  return table;
}

std::string nameOf(FusionRule rule) {
  for (const FusionRuleEntry& entry : fusionRuleTable()) {
    if (entry.rule == rule) return entry.name;
  }
  throw std::invalid_argument("nameOf: fusion rule " + std::to_string(static_cast<int>(rule)) +
                              " is not in the table of fusion rules");
}

}  // namespace sightline::core
