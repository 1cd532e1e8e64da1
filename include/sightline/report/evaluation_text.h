#pragma once

#include <map>
#include <string>
#include <vector>

#include "sightline/core/evaluation/evaluation.h"
#include "sightline/core/evaluation/innovation_statistics.h"

/// The figures of an evaluation as tables for people, in ASCII.
namespace sightline::report {

/// Rows of cells as lines of text with aligned columns: the first column to the left, the others to the
/// right. A row of one cell is a heading over all columns.
std::string alignedTable(const std::vector<std::vector<std::string>>& rows);

/// A number with `digits` significant digits, "-" for NaN.
std::string readable(double value, int digits = 4);

/// With a fixed number of decimals, "-" for NaN.
std::string decimals(double value, int count);

/// A share in [0, 1] as "98.7 %", "-" for NaN.
std::string percent(double share);

/// "1.02 [0.97, 1.03]": an average of normalised squares with its 95 % band for so many degrees of freedom.
std::string withBand(double average, double degrees);

struct EvaluationTableStyle {
  bool bands = false;  ///< the 95 % band of each ANEES beside it
  bool gospa = false;  ///< a second table with GOSPA, its parts and OSPA
};

/// The table of the evaluator: a line for each topic with messages, and notes below it.
/// `best_sigma`: stated sigma of the best sensor [rad], NaN = not known.
std::string evaluationTable(const std::vector<core::EvaluationRow>& rows, double best_sigma,
                            const EvaluationTableStyle& style = {});

/// Time to confirm, false tracks, purity and completeness: a line for each topic of tracks with messages.
/// Empty without such topics.
std::string livesTable(const std::vector<core::EvaluationRow>& rows);

/// A line for each target and topic; empty without any.
std::string targetTable(const std::vector<core::TargetRow>& rows);

/// What each tracker with messages decided about its sightings, and the NIS of its innovations; by topic of
/// the associations. Empty without any.
std::string innovationTable(const std::map<std::string, core::InnovationStatistics>& innovations);

/// A block of lines, one for each tracker with messages: the number of tracks, the direction of the first one
/// and its error now. `elapsed`: since the first message [s].
std::string liveSummary(const std::vector<core::EvaluationRow>& rows, double best_sigma, double elapsed);

}  // namespace sightline::report
