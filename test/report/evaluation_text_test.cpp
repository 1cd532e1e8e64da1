#include "sightline/report/evaluation_text.h"

#include <cmath>
#include <sstream>

#include <gtest/gtest.h>

using namespace sightline::report;
using sightline::core::EvaluationRow;

namespace {

const double kNaN = std::nan("");

std::vector<std::string> linesOf(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// The line that holds `part`; empty and a failure when there is none.
std::string lineWith(const std::string& text, const std::string& part) {
  for (const std::string& line : linesOf(text)) {
    if (line.find(part) != std::string::npos) return line;
  }
  ADD_FAILURE() << "no line with \"" << part << "\" in\n" << text;
  return "";
}

std::vector<std::string> wordsOf(const std::string& line) {
  std::istringstream stream(line);
  return {std::istream_iterator<std::string>(stream), {}};
}

EvaluationRow sightings() {
  EvaluationRow row;
  row.kind = EvaluationRow::Kind::sightings;
  row.topic = "/sensors/left/sightings";
  row.name = "left";
  row.samples = 1000;
  row.rmse = 0.0801;
  row.relative_rmse = 1.00125;
  row.rate_rmse = row.anees_state = row.coverage = kNaN;
  row.anees_position = 1.01;
  row.unmatched = 12;
  row.angles_now.setConstant(kNaN);
  return row;
}

EvaluationRow tracks() {
  EvaluationRow row;
  row.kind = EvaluationRow::Kind::tracks;
  row.topic = "/sensors/left/tracks";
  row.name = "left_tracker";
  row.samples = 100;
  row.rmse = 0.000391;
  row.relative_rmse = 0.4888;
  row.rate_rmse = 0.0123;
  row.anees_position = 1.1;
  row.anees_state = 1.2;
  row.coverage = 0.985;
  row.breaks = 3;
  row.id_switches = 4;
  row.tracks_now = 2;
  row.angles_now = {0.5, -0.25};
  row.error_now = 0.04;
  return row;
}

TEST(AlignedTable, ColumnsEndUnderEachOther) {
  const auto lines = linesOf(alignedTable(
      {{"", "a", "wide one"}, {"heading over all of them, however long"}, {"row", "12345", "6"}}));
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0], "         a  wide one");
  EXPECT_EQ(lines[1], "heading over all of them, however long");
  EXPECT_EQ(lines[2], "row  12345         6");
}

TEST(EvaluationTable, SaysWhatWasFoundUnderItsHeading) {
  const std::string table = evaluationTable({sightings(), tracks()}, 0.08);
  EXPECT_EQ(wordsOf(lineWith(table, "/sensors/left/sightings")),
            (std::vector<std::string>{"/sensors/left/sightings", "1000", "0.0801", "1.001", "-", "1.01", "-",
                                      "-", "-", "-", "12"}));
  EXPECT_EQ(wordsOf(lineWith(table, "/sensors/left/tracks")),
            (std::vector<std::string>{"/sensors/left/tracks", "100", "0.000391", "0.489", "0.0123", "1.10",
                                      "1.20", "98.5", "%", "3", "4", "0"}));
  const auto lines = linesOf(table);
  ASSERT_GE(lines.size(), 5u);
  EXPECT_EQ(lines[1], "sightings");
  EXPECT_EQ(lines[3], "local tracks");
  EXPECT_EQ(lines[2].size(), lines[4].size());
  EXPECT_NE(table.find("0.08 rad = 4.584 deg"), std::string::npos) << table;
}

TEST(EvaluationTable, BandsAreThoseOfTheNumberOfSamples) {
  const std::string table = evaluationTable({tracks()}, 0.08, {true, false});
  EXPECT_NE(lineWith(table, "left/tracks").find("1.10 [0.81, 1.21]"), std::string::npos)
      << table;  // 200 degrees
}

TEST(EvaluationTable, GospaHasALineForEachTracker) {
  EvaluationRow row = tracks();
  row.gospa = sightline::core::GospaMeans({0.01, 2.0});
  sightline::core::Gospa gospa;
  gospa.distance = 0.00154;
  gospa.localisation = 0.0004;
  gospa.assigned = gospa.missed = 1;
  row.gospa.add(gospa);
  row.ospa = 0.0012;
  const std::string table = evaluationTable({sightings(), row}, 0.08, {false, true});
  const std::string below = table.substr(table.find("GOSPA"));
  EXPECT_NE(below.find("c = 0.01 rad, p = 2"), std::string::npos);
  EXPECT_EQ(wordsOf(lineWith(below, "left/tracks")),
            (std::vector<std::string>{"/sensors/left/tracks", "1", "0.00154", "0.0004", "1.0000", "0.0000",
                                      "0.0004", "0.007071", "0", "0.0012"}));  // 0.01 sqrt(1 / 2)
  EXPECT_EQ(below.find("/sensors/left/sightings"), std::string::npos);
  EXPECT_NE(below.find("below three sigmas"), std::string::npos);
  EXPECT_EQ(evaluationTable({row}, 0.001, {false, true}).find("below three sigmas"), std::string::npos);
}

TEST(EvaluationTable, NamesWhatWasNotHeardAndWhatHadNoTruth) {
  EvaluationRow silent = tracks(), outside = sightings();
  silent.topic = "/silent/tracks";
  silent.name = "";
  outside.unscored = 7;
  const std::string table = evaluationTable({outside, silent}, kNaN);
  EXPECT_EQ(lineWith(table, "/silent/tracks"), "nothing heard on /silent/tracks");
  EXPECT_NE(table.find("/sensors/left/sightings (7)"), std::string::npos);
  EXPECT_EQ(table.find("nan"), std::string::npos);
}

TEST(EvaluationTable, SensorsThatShareATopicAreToldApart) {
  EvaluationRow other = sightings();
  other.name = "right";
  const std::string table = evaluationTable({sightings(), other}, 0.08);
  lineWith(table, "/sensors/left/sightings (left)");
  lineWith(table, "/sensors/left/sightings (right)");
}

TEST(LivesTable, SaysWhatBecameOfTargetsAndTracks) {
  EvaluationRow row = tracks();
  row.appearances = 12;
  row.never_confirmed = 1;
  row.confirm_median = 0.4;
  row.confirm_worst = 1.25;
  row.completeness = 0.9;
  row.tracks = 14;
  row.false_tracks = 2;
  row.false_tracks_per_hour = 7.2;
  row.purity = 0.99;
  EvaluationRow silent = tracks();
  silent.topic = "/silent/tracks";
  silent.name = "";
  const std::string table = livesTable({sightings(), row, silent});
  EXPECT_EQ(wordsOf(lineWith(table, "left/tracks")),
            (std::vector<std::string>{"/sensors/left/tracks", "12", "1", "0.400", "1.250", "0.900", "14", "2",
                                      "7.2", "0.990"}));
  EXPECT_EQ(table.find("sightings"), std::string::npos);
  EXPECT_EQ(table.find("silent"), std::string::npos);
  EXPECT_EQ(livesTable({sightings()}), "");
}

TEST(TargetTable, HasALineForEachTarget) {
  sightline::core::TargetRow row;
  row.topic = "/sensors/left/tracks";
  row.target = 7;
  row.samples = 50;
  row.rmse = 0.001;
  row.rate_rmse = kNaN;
  row.anees_position = 1.05;
  row.anees_state = 0.95;
  row.coverage = 0.5;
  row.breaks = 2;
  row.id_switches = 1;
  EXPECT_EQ(wordsOf(lineWith(targetTable({row}), "left/tracks")),
            (std::vector<std::string>{"/sensors/left/tracks", "7", "50", "0.001", "-", "1.05", "0.95", "50.0",
                                      "%", "2", "1"}));
  EXPECT_EQ(targetTable({}), "");
}

TEST(LiveSummary, HasALineForEachTrackerInDegreesAndSigmas) {
  const std::string summary = liveSummary({sightings(), tracks()}, 0.08, 12.34);
  ASSERT_EQ(linesOf(summary).size(), 2u);
  EXPECT_EQ(wordsOf(linesOf(summary)[0]).front(), "12.3");
  EXPECT_EQ(wordsOf(lineWith(summary, "sensors/left")),
            (std::vector<std::string>{"sensors/left", "2", "+28.65", "-14.32", "0.50", "0.49"}));
}

TEST(LiveSummary, SaysThatNothingWasHeard) {
  EXPECT_NE(liveSummary({}, kNaN, 0.0).find("no tracker heard yet"), std::string::npos);
  EvaluationRow lost = tracks();
  lost.tracks_now = 0;
  lost.angles_now.setConstant(kNaN);
  lost.error_now = kNaN;
  EXPECT_EQ(wordsOf(lineWith(liveSummary({lost}, kNaN, 1.0), "sensors/left")),
            (std::vector<std::string>{"sensors/left", "0", "-", "-", "-", "0.49"}));
}

TEST(InnovationTable, CountsDecisionsAndGivesTheNisWithItsBand) {
  EXPECT_EQ(innovationTable({}), "");
  sightline::core::InnovationStatistics statistics;
  sightline::core::Association association;
  association.decision = sightline::core::Decision::accepted;
  association.distance_squared = 3.0;
  statistics.add(association);
  association.decision = sightline::core::Decision::outside_gate;
  statistics.add(association);
  const std::string line = lineWith(innovationTable({{"/associations", statistics}}), "/associations");
  EXPECT_NE(line.find("1.50 ["), std::string::npos) << line;
  const std::vector<std::string> words = wordsOf(line);
  EXPECT_EQ(words[1], "1");
  EXPECT_EQ(words[words.size() - 4], "1");  // outside the gate
}

TEST(EvaluationText, ABandHasAsManyDigitsAsItNeeds) {
  EXPECT_EQ(withBand(1.234, 200.0), "1.23 [0.81, 1.21]");
  EXPECT_EQ(withBand(1.0012, 400000.0), "1.001 [0.996, 1.004]");
}

}  // namespace
