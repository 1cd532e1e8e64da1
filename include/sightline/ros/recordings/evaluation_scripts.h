#pragma once

#include <string>
#include <vector>

#include "sightline/ros/recordings/bag_evaluation.h"

namespace sightline_ros {

/// Draws pictures into a folder with the files of `evaluateBag`. Throws std::runtime_error.
void drawEvaluation(const std::string& folder);

struct ReportSettings {
  std::vector<std::string> bags;     ///< one, or two to compare
  std::string page;                  ///< file to write
  bool finds_truth = false;          ///< each recording is compared with its own truth, where it has one
  BagEvaluationSettings evaluation;  ///< its `csv` is not used, and its `truth` only without `finds_truth`
};

/// Writes the report of one recording or two as a page of HTML. Returns the tables and the name of the page.
/// Throws OutputError or std::runtime_error, then there is no page or the one that was there before.
std::string writeReport(const ReportSettings& settings);

}  // namespace sightline_ros
