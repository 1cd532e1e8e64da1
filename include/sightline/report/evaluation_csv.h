#pragma once

#include <string>
#include <vector>

#include "sightline/core/evaluation/evaluation.h"

namespace sightline::report {

/// Writes the figures of an evaluation as a CSV file: a header line, a line for each row (`target` is empty)
/// and a line for each row of a target. The columns are `kind` (sightings, tracks, fused_tracks, target) and
/// the names of EvaluationRow.msg and EvaluationTarget.msg. An unknown value, or one that targets do not
/// have, is empty. `inputs`: files that are read meanwhile. Throws OutputError when the file cannot be
/// written or is one of the inputs.
void writeEvaluationCsv(const std::string& path, const std::vector<core::EvaluationRow>& rows,
                        const std::vector<core::TargetRow>& targets,
                        const std::vector<std::string>& inputs = {});

}  // namespace sightline::report
