#include "sightline/report/residual_text.h"

#include <cmath>

#include "sightline/report/evaluation_text.h"

namespace sightline::report {
namespace {

using Cells = std::vector<std::string>;

}  // namespace

std::vector<core::EvaluationRow> residualRows(const ResidualComparison& comparison) {
  std::vector<core::EvaluationRow> rows;
  for (const auto& [name, topic] : comparison.topics()) {
    for (core::EvaluationRow row : topic.evaluation.rows()) {
      row.topic = name;
      row.tracks = topic.spans.tracks();
      row.coverage = topic.spans.coverage();
      row.breaks = topic.spans.breaks();
      rows.push_back(row);
    }
  }
  return rows;
}

std::string residualTable(const ResidualComparison& comparison) {
  std::vector<Cells> table = {
      {"sightings about tracks", "samples", "rms [rad]", "rms/sigma", "stated sigma [rad]", "on no track"}};
  for (const auto& [name, topic] : comparison.topics()) {
    for (const core::EvaluationRow& row : topic.evaluation.rows()) {
      table.push_back({"  " + name + " < " + row.name, std::to_string(row.samples), readable(row.rmse),
                       decimals(std::sqrt(row.anees_position), 3), readable(row.stated_sigma),
                       std::to_string(row.unmatched)});
    }
  }
  return alignedTable(table);
}

std::string spanTable(const ResidualComparison& comparison) {
  std::vector<Cells> table = {
      {"tracks", "number", "median [s]", "longest [s]", "with a track", "breaks", "longest [s]"}};
  for (const auto& [name, topic] : comparison.topics()) {
    const core::TrackSpans& spans = topic.spans;
    table.push_back({"  " + name, std::to_string(spans.tracks()), decimals(spans.medianLength(), 2),
                     decimals(spans.longestLength(), 2), percent(spans.coverage()),
                     std::to_string(spans.breaks()), decimals(spans.longestBreak(), 2)});
  }
  return "\n" + alignedTable(table) +
         "Breaks: times without a confirmed track between two with one, while reports came at least every "
         "second.\n";
}

}  // namespace sightline::report
