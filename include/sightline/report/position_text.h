#pragma once

#include <map>
#include <ostream>
#include <string>

#include "sightline/core/evaluation/position_evaluation.h"

namespace sightline::report {

/// The figures of each topic as a table. `rows` by topic.
std::string positionTable(const std::map<std::string, core::PositionRow>& rows);

/// A line for each topic, for a summary while it runs.
std::string positionSummary(const std::map<std::string, core::PositionRow>& rows);

/// The same as CSV, a line for each topic; what is not known is empty.
void writePositionRows(std::ostream& stream, const std::map<std::string, core::PositionRow>& rows);

/// A line of CSV for each scored pair, below `positionErrorHeader`.
std::string positionErrorHeader();
std::string positionErrorLine(const std::string& topic, core::Time time,
                              const core::PositionEvaluation::Pair& pair);

/// One line a report of its GOSPA and parts: distances in metres.
std::string positionGospaHeader();
std::string positionGospaLine(const std::string& topic, core::Time time, const core::Gospa& gospa);

}  // namespace sightline::report
