#pragma once

#include <string>
#include <vector>

#include "sightline/core/evaluation/evaluation.h"

/// What an evaluation found, for people to read. Plain ASCII.
namespace sightline_ros {

/// Rows of cells as lines of text with aligned columns: the first column to the left, the others to the
/// right. A row of one cell is a heading over all columns.
std::string alignedTable(const std::vector<std::vector<std::string>>& rows);

/// A number with `digits` significant digits, "-" for NaN.
std::string readable(double value, int digits = 4);

/// With a fixed number of decimals, "-" for NaN.
std::string decimals(double value, int count);

/// "1.02 [0.97, 1.03]": an average of normalised squares with its 95 % band for so many degrees of freedom.
std::string withBand(double average, double degrees);

struct EvaluationTableStyle {
  bool bands = false;  ///< the 95 % band of each ANEES beside it
  bool gospa = false;  ///< a second table with GOSPA, its parts and OSPA
};

/// The table of the evaluator, with a line for each topic that was heard, and notes below it.
/// `best_sigma`: stated sigma of the best sensor [rad], NaN = not known.
std::string evaluationTable(const std::vector<sightline::core::EvaluationRow>& rows, double best_sigma,
                            const EvaluationTableStyle& style = {});

/// What became of targets and tracks, a line for each topic of tracks that was heard: time to confirm, false
/// tracks, purity, completeness. Empty without such topics.
std::string livesTable(const std::vector<sightline::core::EvaluationRow>& rows);

/// A line for each target and topic; empty without any.
std::string targetTable(const std::vector<sightline::core::TargetRow>& rows);

/// A block of lines, one for each tracker that was heard: how many tracks, where the first one is, and its
/// error now. `elapsed`: since the first message [s].
std::string liveSummary(const std::vector<sightline::core::EvaluationRow>& rows, double best_sigma,
                        double elapsed);

}  // namespace sightline_ros
