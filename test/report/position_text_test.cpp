#include "sightline/report/position_text.h"

#include <cmath>
#include <limits>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

namespace {

namespace core = sightline::core;

core::PositionRow row() {
  core::PositionRow it;
  it.reports = 12;
  it.all = {10, 0.5, 0.25, 0.75, 0.875, 0.125, 1.5};
  it.alone.rmse = it.alone.median = it.alone.anees = std::numeric_limits<double>::quiet_NaN();
  it.coverage = 0.5;
  it.breaks = 1;
  it.id_changes = 2;
  it.tracks = 4;
  it.false_tracks = 3;
  it.false_share = 0.0625;
  it.gospa = 2.5;
  return it;
}

TEST(PositionText, TableHasTheFiguresAndTheTracksOfOneStationWhereThereAreSome) {
  core::PositionRow figures = row();
  const std::string without = sightline::report::positionTable({{"/positions/tracks", figures}});
  for (const char* cell : {"/positions/tracks", "0.5", "0.25", "0.75", "0.875", "1.5", "50", "2.5"})
    EXPECT_NE(without.find(cell), std::string::npos) << cell << "\n" << without;
  EXPECT_EQ(without.find("one station alone"), std::string::npos);
  figures.alone = figures.all;
  EXPECT_NE(sightline::report::positionTable({{"/a", figures}}).find("one station alone"), std::string::npos);
  EXPECT_EQ(sightline::report::positionTable({}), "");
}

TEST(PositionText, SummaryHasALineForEachTopicThatHasReported) {
  core::PositionRow silent;
  const std::string text = sightline::report::positionSummary({{"/p", row()}, {"/q", silent}});
  EXPECT_EQ(text.find("/p  RMSE 0.5 m"), 0u) << text;
  EXPECT_EQ(text.find("/q"), std::string::npos) << text;
}

TEST(PositionText, CsvHasALineForEachTopicAndWhatIsNotKnownIsEmpty) {
  std::ostringstream stream;
  sightline::report::writePositionRows(stream, {{"/p", row()}});
  const std::string text = stream.str();
  EXPECT_NE(text.find("\n/p,12,10,0.5,0.25,0.75,0.875,0.125,1.5,0,,,,0.5,1,2,4,3,0.0625,2.5\n"),
            std::string::npos)
      << text;
}

TEST(PositionText, ErrorLineIsOfOnePair) {
  core::PositionEvaluation::Pair pair;
  pair.target = "drone";
  pair.id = 7;
  pair.error = {0.5, -0.25, 0.125};
  pair.sigma = {1.0, 2.0, 3.0};
  pair.nees = 0.75;
  pair.is_alone = true;
  EXPECT_EQ(sightline::report::positionErrorLine("/p", core::Time(core::durationOf(12.5)), pair),
            "/p,12.500000000,drone,7,0.5,-0.25,0.125,1,2,3,0.75,1\n");
}

}  // namespace
