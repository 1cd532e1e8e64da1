#include "sightline/report/evaluation_text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sightline/core/model/sphere.h"

namespace sightline::report {
namespace {

using core::EvaluationRow;
using Cells = std::vector<std::string>;

constexpr double kDegreesPerRadian = 180.0 / core::kPi;
constexpr double kSigmasOfCutoff = 3.0;  // below, the cutoff cuts into the errors of good tracks

template <typename... Values>
std::string format(const char* pattern, Values... values) {
  char text[256];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

std::string withSign(double value, int count) {
  return std::isnan(value) ? "-" : format("%+.*f", count, value);
}

bool hasMessages(const EvaluationRow& row) {
  return !row.name.empty();
}

const char* headingOf(EvaluationRow::Kind kind) {
  switch (kind) {
    case EvaluationRow::Kind::sightings:
      return "sightings";
    case EvaluationRow::Kind::tracks:
      return "local tracks";
    default:
      return "fused tracks";
  }
}

std::string anees(double value, double degrees, bool with_band) {
  return with_band ? withBand(value, degrees) : decimals(value, 2);
}

std::string nameOf(const EvaluationRow& row, const std::vector<EvaluationRow>& rows) {
  const auto same_topic = [&row](const EvaluationRow& other) { return other.topic == row.topic; };
  const bool is_shared = std::count_if(rows.begin(), rows.end(), same_topic) > 1;
  return "  " + row.topic + (is_shared ? " (" + row.name + ")" : "");
}

Cells cellsOf(const EvaluationRow& row, const std::vector<EvaluationRow>& rows, bool with_bands) {
  const double degrees = static_cast<double>(row.samples) * row.dimensions;
  const bool has_tracks = row.kind != EvaluationRow::Kind::sightings;
  return {nameOf(row, rows),
          std::to_string(row.samples),
          readable(row.rmse),
          decimals(row.relative_rmse, 3),
          readable(row.rate_rmse),
          anees(row.anees_position, degrees, with_bands),
          anees(row.anees_state, 2.0 * degrees, with_bands),
          percent(row.coverage),
          has_tracks ? std::to_string(row.breaks) : "-",
          has_tracks ? std::to_string(row.id_switches) : "-",
          std::to_string(row.unmatched)};
}

template <typename MakeCells>
void addGroups(const std::vector<EvaluationRow>& rows, const MakeCells& make_cells,
               std::vector<Cells>& table) {
  std::string heading;
  for (const EvaluationRow& row : rows) {
    if (!hasMessages(row)) continue;
    if (heading != headingOf(row.kind)) table.push_back({heading = headingOf(row.kind)});
    table.push_back(make_cells(row));
  }
}

std::string errorTable(const std::vector<EvaluationRow>& rows, bool with_bands) {
  std::vector<Cells> table = {{"", "samples", "RMSE [rad]", "RMSE/sigma", "rates [rad/s]", "ANEES pos.",
                               "ANEES state", "coverage", "breaks", "ID changes", "unmatched"}};
  addGroups(
      rows, [&](const EvaluationRow& row) { return cellsOf(row, rows, with_bands); }, table);
  return alignedTable(table);
}

std::vector<EvaluationRow> tracksOf(const std::vector<EvaluationRow>& rows) {
  std::vector<EvaluationRow> tracks;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(tracks), [](const EvaluationRow& row) {
    return row.kind != EvaluationRow::Kind::sightings && hasMessages(row);
  });
  return tracks;
}

/// With a warning where the cutoff cuts into the errors of good tracks.
std::string gospaTable(const std::vector<EvaluationRow>& rows, double best_sigma) {
  const std::vector<EvaluationRow> tracks = tracksOf(rows);
  if (tracks.empty()) return "";
  const core::GospaParams& params = tracks.front().gospa.params();
  std::vector<Cells> table = {
      {"GOSPA, c = " + readable(params.cutoff) + " rad, p = " + readable(params.order), "reports",
       "mean [rad]", "a pair [rad]", "missed", "false", "cost of pairs", "of missed", "of false",
       "OSPA [rad]"}};
  addGroups(
      tracks,
      [](const EvaluationRow& row) -> Cells {
        return {"  " + row.topic,
                std::to_string(row.gospa.instants()),
                readable(row.gospa.distance()),
                readable(row.gospa.localisation()),
                decimals(row.gospa.missed(), 4),
                decimals(row.gospa.extra(), 4),
                readable(row.gospa.localisationCost()),
                readable(row.gospa.missedCost()),
                readable(row.gospa.extraCost()),
                readable(row.ospa)};
      },
      table);
  const bool is_tight = params.cutoff < kSigmasOfCutoff * best_sigma;
  return "\n" + alignedTable(table) +
         (is_tight ? "The cutoff c is below three sigmas: choose a larger one.\n" : "");
}

std::string notesOn(const std::vector<EvaluationRow>& rows, double best_sigma,
                    const EvaluationTableStyle& style) {
  std::string notes;
  if (!std::isnan(best_sigma)) {
    notes += "sigma: what the best sensor states, as an arc: " + readable(best_sigma) +
             " rad = " + readable(best_sigma * kDegreesPerRadian) + " deg. ";
  }
  notes += "Errors are arcs on the sphere, a channel. ANEES is 1 for an honest covariance.\n";
  if (style.bands)
    notes +=
        "[ ]: 95 % band of so many independent samples; those along one track are not, so that theirs is "
        "wider.\n";
  std::string silent, outside;
  for (const EvaluationRow& row : rows) {
    if (!hasMessages(row)) silent += " " + row.topic;
    if (row.unscored > 0) outside += " " + row.topic + " (" + std::to_string(row.unscored) + ")";
  }
  if (!silent.empty()) notes += "nothing heard on" + silent + "\n";
  if (!outside.empty()) notes += "messages for whose time no truth is known:" + outside + "\n";
  return notes;
}

/// "/sensors/left/tracks" -> "sensors/left".
std::string shortName(const std::string& topic) {
  const std::size_t begin = topic.find_first_not_of('/');
  const std::size_t end = topic.rfind("/tracks");
  if (begin == std::string::npos) return topic;
  return end == std::string::npos || end <= begin ? topic.substr(begin) : topic.substr(begin, end - begin);
}

Cells liveCells(const EvaluationRow& row, double best_sigma) {
  return {"  " + shortName(row.topic),
          std::to_string(row.tracks_now),
          withSign(row.angles_now.x() * kDegreesPerRadian, 2),
          withSign(row.angles_now.y() * kDegreesPerRadian, 2),
          decimals(row.error_now / best_sigma, 2),
          decimals(row.relative_rmse, 2)};
}

}  // namespace

std::string readable(double value, int digits) {
  return std::isnan(value) ? "-" : format("%.*g", digits, value);
}

std::string decimals(double value, int count) {
  return std::isnan(value) ? "-" : format("%.*f", count, value);
}

std::string percent(double share) {
  return std::isnan(share) ? "-" : decimals(100.0 * share, 1) + " %";
}

std::string withBand(double average, double degrees) {
  if (std::isnan(average)) return "-";
  const core::Band band = core::aneesBand(degrees);
  const double digits = std::ceil(-std::log10(0.5 * (band.high - band.low)));  // of so many samples
  const int count = std::isfinite(digits) ? static_cast<int>(std::clamp(digits, 2.0, 6.0)) : 2;
  return decimals(average, count) + " [" + decimals(band.low, count) + ", " + decimals(band.high, count) +
         "]";
}

std::string alignedTable(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const Cells& row : rows) {
    if (row.size() < 2) continue;
    widths.resize(std::max(widths.size(), row.size()), 0);
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string text;
  for (const Cells& row : rows) {
    std::string line = row.empty() ? "" : row.front();
    for (std::size_t i = 1; i < row.size(); ++i) {
      if (i == 1) line.resize(widths[0], ' ');
      line += "  " + std::string(widths[i] - row[i].size(), ' ') + row[i];
    }
    text += line + "\n";
  }
  return text;
}

std::string evaluationTable(const std::vector<EvaluationRow>& rows, double best_sigma,
                            const EvaluationTableStyle& style) {
  if (!style.gospa) return errorTable(rows, style.bands) + notesOn(rows, best_sigma, style);
  return errorTable(rows, style.bands) + gospaTable(rows, best_sigma) + notesOn(rows, best_sigma, style);
}

std::string livesTable(const std::vector<EvaluationRow>& rows) {
  const std::vector<EvaluationRow> tracks = tracksOf(rows);
  if (tracks.empty()) return "";
  std::vector<Cells> table = {{"", "appearances", "never confirmed", "confirmed after [s]", "at most [s]",
                               "completeness", "tracks", "false", "false/h", "purity"}};
  addGroups(
      tracks,
      [](const EvaluationRow& row) -> Cells {
        return {"  " + row.topic,
                std::to_string(row.appearances),
                std::to_string(row.never_confirmed),
                decimals(row.confirm_median, 3),
                decimals(row.confirm_worst, 3),
                decimals(row.completeness, 3),
                std::to_string(row.tracks),
                std::to_string(row.false_tracks),
                readable(row.false_tracks_per_hour),
                decimals(row.purity, 3)};
      },
      table);
  return "\n" + alignedTable(table) +
         "Completeness: share of a target's time with its most usual track; purity: of a track's on its most "
         "usual "
         "target.\n"
         "False: on any target in less than half of its reports.\n";
}

std::string targetTable(const std::vector<core::TargetRow>& rows) {
  if (rows.empty()) return "";
  std::vector<Cells> table = {{"each target", "samples", "RMSE [rad]", "rates [rad/s]", "ANEES pos.",
                               "ANEES state", "coverage", "breaks", "ID changes"}};
  for (const core::TargetRow& row : rows) {
    table.push_back({"  " + row.topic + " " + std::to_string(row.target), std::to_string(row.samples),
                     readable(row.rmse), readable(row.rate_rmse), decimals(row.anees_position, 2),
                     decimals(row.anees_state, 2), percent(row.coverage), std::to_string(row.breaks),
                     std::to_string(row.id_switches)});
  }
  return "\n" + alignedTable(table);
}

std::string innovationTable(const std::map<std::string, core::InnovationStatistics>& innovations) {
  if (innovations.empty()) return "";
  std::vector<Cells> table = {
      {"associations", "accepted", "NIS [95 % band]", "outside gate", "claimed", "started", "rejected"}};
  for (const auto& [topic, statistics] : innovations) {
    const auto count = [&counts = statistics](core::Decision decision) {
      return std::to_string(counts.count(decision));
    };
    const double degrees = 2.0 * static_cast<double>(statistics.count(core::Decision::accepted));
    table.push_back({"  " + topic, count(core::Decision::accepted), withBand(statistics.nis(), degrees),
                     count(core::Decision::outside_gate), count(core::Decision::claimed_by_other),
                     count(core::Decision::started_track), count(core::Decision::rejected_input)});
  }
  return "\n" + alignedTable(table) +
         "NIS: mean squared innovation over its covariance and dimension, 1 for an honest prediction.\n";
}

std::string liveSummary(const std::vector<EvaluationRow>& rows, double best_sigma, double elapsed) {
  std::vector<Cells> table = {{decimals(elapsed, 1) + " s", "tracks", "azimuth [deg]", "elevation [deg]",
                               "error/sigma", "RMSE/sigma"}};
  for (const EvaluationRow& row : rows) {
    if (row.kind != EvaluationRow::Kind::sightings && hasMessages(row))
      table.push_back(liveCells(row, best_sigma));
  }
  if (table.size() == 1) return decimals(elapsed, 1) + " s: no tracker heard yet\n";
  return alignedTable(table);
}

}  // namespace sightline::report
