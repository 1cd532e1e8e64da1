#pragma once

#include <string>

#include "sightline/core/evaluation/evaluation.h"
#include "sightline/core/evaluation/position_evaluation.h"

namespace sightline_ros {

struct BagEvaluationSettings {
  std::string truth;  ///< TrackArray topic of the bag, or CSV file of directions or of positions; empty =
                      ///< compare with the sightings
  sightline::core::EvaluationParams evaluation;
  sightline::core::PositionEvaluationParams positions;  ///< with a truth in positions
  std::string csv;  ///< folder for the scored pairs and the figures as CSV files; empty = none
};

/// Evaluates every TrackArray topic of a bag, or with a truth in positions every PositionTrackArray topic;
/// returns the tables.
///
/// With a truth: errors, consistency, GOSPA and continuity of tracks and sightings. Without: residuals of the
/// sightings from the tracks of their own trackers, and spans of the tracks. In both cases, from
/// AssociationArray topics: decisions and normalised innovations. Throws std::runtime_error.
std::string evaluateBag(const std::string& bag, const BagEvaluationSettings& settings);

}  // namespace sightline_ros
