#pragma once

#include <string>
#include <vector>

#include "sightline/core/evaluation/evaluation.h"
#include "sightline/report/residual_comparison.h"

/// A comparison without a truth as tables for people and as rows for programs.
namespace sightline::report {

/// A row for each topic of tracks and each sensor whose sightings update them: residuals, and the tracks'
/// spans.
std::vector<core::EvaluationRow> residualRows(const ResidualComparison& comparison);

/// The residuals of the sightings, a line for each such row.
std::string residualTable(const ResidualComparison& comparison);

/// The number, lengths and breaks of the tracks, a line for each topic.
std::string spanTable(const ResidualComparison& comparison);

}  // namespace sightline::report
