#include "sightline/report/evaluation_csv.h"

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

#include <gtest/gtest.h>

#include "support/scratch_folder.h"

using namespace sightline::report;
namespace core = sightline::core;

namespace {

std::vector<std::string> cellsOf(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> cells;
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  if (line.back() == ',') cells.emplace_back();
  return cells;
}

/// Cells by column, a map for each line below the header.
std::vector<std::map<std::string, std::string>> read(const std::string& path) {
  std::ifstream stream(path);
  std::string line;
  std::getline(stream, line);
  const std::vector<std::string> header = cellsOf(line);
  std::vector<std::map<std::string, std::string>> rows;
  while (std::getline(stream, line)) {
    const std::vector<std::string> cells = cellsOf(line);
    EXPECT_EQ(cells.size(), header.size()) << line;
    rows.emplace_back();
    for (std::size_t i = 0; i < std::min(cells.size(), header.size()); ++i) rows.back()[header[i]] = cells[i];
  }
  return rows;
}

TEST(EvaluationCsv, HasALineForEachRowAndEachTarget) {
  core::EvaluationRow row;
  row.kind = core::EvaluationRow::Kind::fused_tracks;
  row.topic = "/fusion/tracks";
  row.rmse = 0.00125;
  row.rate_rmse = std::nan("");
  row.unscored = 7;
  row.scored_time = 12.5;
  core::TargetRow target;
  target.topic = "/fusion/tracks";
  target.target = 3;
  target.breaks = 2;
  const ScratchFolder folder;
  writeEvaluationCsv(folder.file("evaluation.csv"), {row}, {target});

  auto rows = read(folder.file("evaluation.csv"));
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0]["kind"], "fused_tracks");
  EXPECT_EQ(rows[0]["target"], "");
  EXPECT_EQ(rows[0]["rmse"], "0.00125");
  EXPECT_EQ(rows[0]["rate_rmse"], "");  // not known
  EXPECT_EQ(rows[0]["unjudged"], "7");
  EXPECT_EQ(rows[0]["judged_time"], "12.5");
  EXPECT_EQ(rows[1]["kind"], "target");
  EXPECT_EQ(rows[1]["target"], "3");
  EXPECT_EQ(rows[1]["breaks"], "2");
  EXPECT_EQ(rows[1]["ospa"], "");  // not of targets
}

TEST(EvaluationCsv, AFileThatCannotBeWrittenIsAnError) {
  EXPECT_THROW(writeEvaluationCsv("/no/such/folder/evaluation.csv", {}, {}), std::runtime_error);
}

}  // namespace
