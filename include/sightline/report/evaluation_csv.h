#pragma once

#include <string>
#include <vector>

#include "sightline/core/evaluation/evaluation.h"

namespace sightline_ros {

/// Writes what an evaluation found for programs to read: a header line, a line for each row, whose `target`
/// is empty, and one for each row of a target; the names are those of EvaluationRow.msg and
/// EvaluationTarget.msg with `kind` (sightings, tracks, fused_tracks, target) before them. What is not known,
/// or not said of targets, is empty. Throws std::runtime_error when the file cannot be written.
void writeEvaluationCsv(const std::string& path, const std::vector<sightline::core::EvaluationRow>& rows,
                        const std::vector<sightline::core::TargetRow>& targets);

}  // namespace sightline_ros
