#pragma once

#include <string>

#include "sightline/core/evaluation/evaluation.h"

namespace sightline_ros {

struct BagEvaluationSettings {
  std::string truth;  ///< TrackArray topic of the bag, or CSV file; empty = compare with the sightings
  sightline::core::EvaluationParams evaluation;
  std::string csv;  ///< folder for what was compared and found, as CSV files; empty = none
};

/// Evaluates every TrackArray topic of a bag, and says what was found.
///
/// With a truth: errors, consistency, GOSPA and continuity of tracks and sightings. Without: how the
/// sightings lie about the tracks of their own trackers, and how long tracks live. With both, from
/// AssociationArray topics: whether the trackers expected the sightings where they came. Throws
/// std::runtime_error.
std::string evaluateBag(const std::string& bag, const BagEvaluationSettings& settings);

}  // namespace sightline_ros
