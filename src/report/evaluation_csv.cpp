#include "sightline/report/evaluation_csv.h"

#include <cmath>
#include <map>
#include <sstream>

#include "sightline/report/output_file.h"
#include "sightline/report/value_text.h"

namespace sightline::report {
namespace {

using core::EvaluationRow;
using Line = std::map<std::string, std::string>;  // cells by name of the column

const std::vector<const char*> kColumns = {"kind",
                                           "topic",
                                           "name",
                                           "target",
                                           "samples",
                                           "rmse",
                                           "relative_rmse",
                                           "rate_rmse",
                                           "anees_position",
                                           "anees_state",
                                           "coverage",
                                           "breaks",
                                           "id_switches",
                                           "unmatched",
                                           "unjudged",
                                           "stated_sigma",
                                           "gospa",
                                           "gospa_localisation",
                                           "gospa_missed",
                                           "gospa_false",
                                           "missed",
                                           "extra",
                                           "ospa",
                                           "tracks",
                                           "false_tracks",
                                           "judged_time",
                                           "false_tracks_per_hour",
                                           "purity",
                                           "completeness",
                                           "appearances",
                                           "never_confirmed",
                                           "confirm_median",
                                           "confirm_worst"};

const char* nameOf(EvaluationRow::Kind kind) {
  switch (kind) {
    case EvaluationRow::Kind::sightings:
      return "sightings";
    case EvaluationRow::Kind::tracks:
      return "tracks";
    default:
      return "fused_tracks";
  }
}

Line lineOf(const EvaluationRow& row) {
  return {{"kind", nameOf(row.kind)},
          {"topic", csvCell(row.topic)},
          {"name", csvCell(row.name)},
          {"samples", std::to_string(row.samples)},
          {"rmse", orEmpty(row.rmse)},
          {"relative_rmse", orEmpty(row.relative_rmse)},
          {"rate_rmse", orEmpty(row.rate_rmse)},
          {"anees_position", orEmpty(row.anees_position)},
          {"anees_state", orEmpty(row.anees_state)},
          {"coverage", orEmpty(row.coverage)},
          {"breaks", std::to_string(row.breaks)},
          {"id_switches", std::to_string(row.id_switches)},
          {"unmatched", std::to_string(row.unmatched)},
          {"unjudged", std::to_string(row.unscored)},
          {"stated_sigma", orEmpty(row.stated_sigma)},
          {"gospa", orEmpty(row.gospa.distance())},
          {"gospa_localisation", orEmpty(row.gospa.localisationCost())},
          {"gospa_missed", orEmpty(row.gospa.missedCost())},
          {"gospa_false", orEmpty(row.gospa.extraCost())},
          {"missed", orEmpty(row.gospa.missed())},
          {"extra", orEmpty(row.gospa.extra())},
          {"ospa", orEmpty(row.ospa)},
          {"tracks", std::to_string(row.tracks)},
          {"false_tracks", std::to_string(row.false_tracks)},
          {"judged_time", orEmpty(row.scored_time)},
          {"false_tracks_per_hour", orEmpty(row.false_tracks_per_hour)},
          {"purity", orEmpty(row.purity)},
          {"completeness", orEmpty(row.completeness)},
          {"appearances", std::to_string(row.appearances)},
          {"never_confirmed", std::to_string(row.never_confirmed)},
          {"confirm_median", orEmpty(row.confirm_median)},
          {"confirm_worst", orEmpty(row.confirm_worst)}};
}

Line lineOf(const core::TargetRow& row) {
  return {{"kind", "target"},
          {"topic", csvCell(row.topic)},
          {"name", csvCell(row.name)},
          {"target", std::to_string(row.target)},
          {"samples", std::to_string(row.samples)},
          {"rmse", orEmpty(row.rmse)},
          {"rate_rmse", orEmpty(row.rate_rmse)},
          {"anees_position", orEmpty(row.anees_position)},
          {"anees_state", orEmpty(row.anees_state)},
          {"coverage", orEmpty(row.coverage)},
          {"breaks", std::to_string(row.breaks)},
          {"id_switches", std::to_string(row.id_switches)}};
}

void write(std::ostream& stream, const Line& line) {
  const char* separator = "";
  for (const char* column : kColumns) {
    const auto cell = line.find(column);
    stream << separator << (cell == line.end() ? "" : cell->second);
    separator = ",";
  }
  stream << '\n';
}

}  // namespace

void writeEvaluationCsv(const std::string& path, const std::vector<EvaluationRow>& rows,
                        const std::vector<core::TargetRow>& targets, const std::vector<std::string>& inputs) {
  TextFile file(path, inputs);
  std::ostream& stream = file.stream();
  Line header;
  for (const char* column : kColumns) header[column] = column;
  write(stream, header);
  for (const EvaluationRow& row : rows) write(stream, lineOf(row));
  for (const core::TargetRow& row : targets) write(stream, lineOf(row));
  file.finish();
}

}  // namespace sightline::report
