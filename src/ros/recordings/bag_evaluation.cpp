#include "sightline/ros/recordings/bag_evaluation.h"

#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

#include "sightline/core/evaluation/innovation_statistics.h"
#include "sightline/report/evaluation_csv.h"
#include "sightline/report/evaluation_text.h"
#include "sightline/report/residual_comparison.h"
#include "sightline/report/score_files.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/recordings/bags.h"
#include "sightline/ros/recordings/recorded_truth.h"
#include "sightline/ros/recordings/recording_reader.h"
#include "sightline/ros/recordings/truth_comparison.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

using Cells = std::vector<std::string>;
using Innovations = std::map<std::string, core::InnovationStatistics>;  // by topic

std::string percent(double share) {
  return std::isnan(share) ? "-" : decimals(100.0 * share, 1) + " %";
}

std::string innovationTable(const Innovations& innovations) {
  if (innovations.empty()) return "";
  std::vector<Cells> table = {
      {"associations", "accepted", "NIS [95 % band]", "outside gate", "claimed", "started", "rejected"}};
  for (const auto& [topic, statistics] : innovations) {
    const auto count = [&statistics](core::Decision decision) {
      return std::to_string(statistics.count(decision));
    };
    const double degrees = 2.0 * static_cast<double>(statistics.count(core::Decision::accepted));
    table.push_back({"  " + topic, count(core::Decision::accepted), withBand(statistics.nis(), degrees),
                     count(core::Decision::outside_gate), count(core::Decision::claimed_by_other),
                     count(core::Decision::started_track), count(core::Decision::rejected_input)});
  }
  return "\n" + alignedTable(table) +
         "NIS: mean squared innovation over its covariance and dimension, 1 for an honest prediction.\n";
}

/// A row for each topic of tracks and each sensor whose sightings it took: residuals, and the tracks' spans.
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

std::string tableIn(const std::string& folder) {
  return folder.empty() ? "" : folder + "/evaluation.csv";
}

std::string notesOn(const std::map<std::string, std::size_t>& counts, const std::string& what) {
  std::string notes;
  for (const auto& [reason, count] : counts)
    notes += std::to_string(count) + " " + what + " " + reason + "\n";
  return notes;
}

/// Takes associations of the recording into the statistics.
auto collecting(Innovations& innovations) {
  return [&innovations](const std::string& topic, const sightline::AssociationArray& associations) {
    core::InnovationStatistics& statistics = innovations[topic];
    for (const auto& association : associations.associations) statistics.add(toCore(association));
  };
}

std::string compareWithTruth(RecordingReader& reader, const RecordedTruth& truth,
                             const std::string& truth_topic, const core::EvaluationParams& params,
                             const core::ScoreListener& listener, const std::string& csv) {
  TruthComparison comparison(truth, params, listener);
  Innovations innovations;
  reader.read({[&](const std::string& topic, core::Scan scan) { comparison.addScan(topic, std::move(scan)); },
               [&](const std::string& topic, core::TrackReport report) {
                 if (topic != truth_topic) comparison.addTracks(topic, std::move(report));
               },
               collecting(innovations)});
  const bool own_truths = truth.motions.size() > 1;
  const std::vector<core::EvaluationRow> rows = comparison.rows();
  const std::vector<core::TargetRow> targets = comparison.targetRows();
  if (!csv.empty()) writeEvaluationCsv(csv, rows, targets);
  return evaluationTable(rows, comparison.bestSigma(), {true, true}) + livesTable(rows) +
         targetTable(targets) + (own_truths ? "sigma: stated by the sensor whose truth it is.\n" : "") +
         innovationTable(innovations) +
         notesOn(comparison.withoutTruth(), "messages of sensors without a truth on");
}

std::string compareWithSightings(RecordingReader& reader, const core::EvaluationParams& params,
                                 const core::ScoreListener& listener, const std::string& csv) {
  ResidualComparison comparison(params, listener);
  Innovations innovations;
  bool has_truth = false;
  RecordingVisitor first_pass;
  first_pass.tracks = [&](const std::string& topic, const core::TrackReport& report) {
    topic == "/truth" ? void(has_truth = true) : comparison.addTracks(topic, report);
  };
  first_pass.associations = collecting(innovations);
  reader.read(first_pass);
  RecordingVisitor second_pass;
  second_pass.scan = [&](const std::string& topic, const core::Scan& scan) {
    comparison.addScan(topic, scan);
  };
  reader.read(second_pass);
  if (!csv.empty()) writeEvaluationCsv(csv, residualRows(comparison), {});
  return residualTable(comparison) + spanTable(comparison) + innovationTable(innovations) +
         (has_truth ? "There is a truth in this recording: compare with it by --truth /truth\n" : "");
}

}  // namespace

std::string evaluateBag(const std::string& file, const BagEvaluationSettings& settings) {
  const auto bag = openBag(file);
  std::optional<JudgementFiles> files;
  if (!settings.csv.empty()) files.emplace(settings.csv);
  const core::ScoreListener listener = files ? files->listener() : core::ScoreListener{};

  std::string report;
  if (settings.truth.empty()) {
    RecordingReader reader(*bag, trackingFrameOf(*bag));
    report = compareWithSightings(reader, settings.evaluation, listener, tableIn(settings.csv));
    return report + notesOn(reader.leftOut(), "messages left out on");
  }
  const core::EvaluationParams& params = settings.evaluation;
  const RecordedTruth truth = readTruth(settings.truth, *bag, params.channels, params.truth_gap);
  RecordingReader reader(*bag, truth.frame.empty() ? trackingFrameOf(*bag) : truth.frame);
  report = compareWithTruth(reader, truth, settings.truth, params, listener, tableIn(settings.csv));
  return report + notesOn(reader.leftOut(), "messages left out on");
}

}  // namespace sightline_ros
