#include "sightline/core/fusion/fusion_report.h"

namespace sightline::core {

const std::vector<FusionRule>& fusionRules() {
  static const std::vector<FusionRule> rules{FusionRule::best,
                                             FusionRule::tracklets,
                                             FusionRule::cross_covariance,
                                             FusionRule::weighted_covariance,
                                             FusionRule::covariance_intersection,
                                             FusionRule::inverse_covariance_intersection};
  return rules;
}

std::string nameOf(FusionRule rule) {
  switch (rule) {
    case FusionRule::best:
      return "best";
    case FusionRule::tracklets:
      return "tracklets";
    case FusionRule::cross_covariance:
      return "cross_covariance";
    case FusionRule::weighted_covariance:
      return "weighted_covariance";
    case FusionRule::covariance_intersection:
      return "covariance_intersection";
    case FusionRule::inverse_covariance_intersection:
      return "inverse_covariance_intersection";
  }
  return "";
}

}  // namespace sightline::core
