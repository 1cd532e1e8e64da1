#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include <Eigen/Core>

#include <sightline/Evaluation.h>
#include <sightline/TrackArray.h>

#include "sightline/core/evaluation/evaluation.h"
#include "sightline/core/evaluation/position_evaluation.h"
#include "sightline/core/positions/position_track.h"

/// Messages to what an evaluation takes, and what it found to messages.
namespace sightline_ros {

/// Motions of the targets of a truth message, by id.
std::map<std::uint32_t, Eigen::Vector4d> motionsOf(const sightline::TrackArray& truth);

/// What a tracker, or a fusion, reported.
sightline::core::TrackReport reportOf(const sightline::TrackArray& tracks);

/// What is scored of positions: all but tentative ones.
std::vector<sightline::core::EstimatedPosition> estimatesOf(
    const sightline::core::PositionTrackArray& positions);

/// Whether the tracks are made of tracks: their `estimator` is then none of ours but a rule.
bool isFused(const sightline::TrackArray& tracks);

sightline::EvaluationRow toMessage(const sightline::core::EvaluationRow& row);
sightline::EvaluationTarget toMessage(const sightline::core::TargetRow& row);

/// All rows of both kinds; stamped with the time of the newest message that counted.
sightline::Evaluation toMessage(const sightline::core::Evaluation& evaluation);

}  // namespace sightline_ros
