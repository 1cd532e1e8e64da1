#include "sightline/core/fusion_report.h"

namespace sightline::core {

std::string nameOf(FusionRule rule) {
  switch (rule) {
    case FusionRule::weighted_covariance:
      return "weighted_covariance";
    case FusionRule::cross_covariance:
      return "cross_covariance";
    case FusionRule::covariance_intersection:
      return "covariance_intersection";
  }
  return "";
}

}  // namespace sightline::core
