#include "sightline/ros/recordings/bag_evaluation.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <iomanip>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include <rosbag/view.h>
#include <sightline/PositionTrackArray.h>

#include "sightline/core/evaluation/innovation_statistics.h"
#include "sightline/report/evaluation_csv.h"
#include "sightline/report/evaluation_text.h"
#include "sightline/report/output_file.h"
#include "sightline/report/position_text.h"
#include "sightline/report/residual_comparison.h"
#include "sightline/report/residual_text.h"
#include "sightline/report/score_files.h"
#include "sightline/report/value_text.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/messages/evaluation_messages.h"
#include "sightline/ros/messages/position_messages.h"
#include "sightline/ros/recordings/bags.h"
#include "sightline/ros/recordings/recorded_positions.h"
#include "sightline/ros/recordings/recorded_truth.h"
#include "sightline/ros/recordings/recording_examination.h"
#include "sightline/ros/recordings/recording_reader.h"
#include "sightline/ros/recordings/replay_output.h"
#include "sightline/ros/recordings/replay_parameters.h"
#include "sightline/ros/recordings/truth_comparison.h"

namespace sightline_ros {

namespace core = sightline::core;
namespace report = sightline::report;

namespace {

const char* const kAllSightings = "/sensor_fusion/tracks";

using Innovations = std::map<std::string, core::InnovationStatistics>;  // by topic

const char* const kTruthTopic = "/truth";  // of simulated recordings

/// Where the pairs, the reports and the figures go.
struct Output {
  report::ScoreFiles* scores = nullptr;  // null: nowhere
  std::string table;                     // CSV file of the rows; empty: none
  std::vector<std::string> inputs;       // files that are read
};

core::ScoreListener listenerOf(const Output& output) {
  return output.scores == nullptr ? core::ScoreListener() : output.scores->listener();
}

void finish(const Output& output, const std::vector<core::EvaluationRow>& rows,
            const std::vector<core::TargetRow>& targets) {
  if (output.scores == nullptr) return;
  output.scores->finish();
  report::writeEvaluationCsv(output.table, rows, targets, output.inputs);
}

/// `examples`: of the first one, by reason; may lack some.
std::string notesOn(const std::map<std::string, std::size_t>& counts, const std::string& what,
                    const std::map<std::string, std::string>& examples = {}) {
  std::string notes;
  for (const auto& [reason, count] : counts) {
    const auto example = examples.find(reason);
    notes += std::to_string(count) + " " + what + " " + reason +
             (example == examples.end() ? "" : ", the first " + example->second) + "\n";
  }
  return notes;
}

/// A stretch of time that grows by what is in it.
struct Span {
  core::Time first = core::Time::max(), last = core::Time::min();

  void add(core::Time time) {
    first = std::min(first, time);
    last = std::max(last, time);
  }
  bool isEmpty() const { return first > last; }
};

std::string textOf(const Span& span) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(3) << core::seconds(span.first.time_since_epoch()) << " s to "
       << core::seconds(span.last.time_since_epoch()) << " s";
  return text.str();
}

Span spanOf(const RecordedTruth& truth) {
  Span span;
  for (const auto& [sensor, motions] : truth.motions) {
    if (motions.empty()) continue;
    span.add(motions.begin()->first);
    span.add(motions.rbegin()->first);
  }
  return span;
}

void requireOverlap(const std::string& name, const RecordedTruth& truth, const Span& recorded) {
  const Span known = spanOf(truth);
  const bool overlaps = known.first <= recorded.last && recorded.first <= known.last;
  if (recorded.isEmpty() || known.isEmpty() || overlaps) return;
  throw std::runtime_error(
      name + ": the truth is of " + textOf(known) + ", and the recording's sightings and tracks of " +
      textOf(recorded) +
      ": they have no time in common; use the truth of this recording, or bring both to one "
      "time (csv_to_bag --offset adds to a recording's)");
}

/// Adds the associations of a recording to the statistics of their topic.
auto addingTo(Innovations& innovations) {
  return [&innovations](const std::string& topic, const sightline::AssociationArray& message) {
    core::InnovationStatistics& statistics = innovations[topic];
    for (const auto& association : message.associations) statistics.add(toCore(association));
  };
}

std::string compareWithTruth(RecordingReader& reader, const RecordedTruth& truth,
                             const BagEvaluationSettings& settings, const Output& output) {
  TruthComparison comparison(truth, settings.evaluation, listenerOf(output));
  Innovations innovations;
  RecordingVisitor visitor;
  Span recorded;
  visitor.scan = [&](const std::string& topic, core::Scan scan) {
    recorded.add(scan.time);
    comparison.addScan(topic, std::move(scan));
  };
  visitor.tracks = [&](const std::string& topic, core::TrackReport tracks) {
    if (topic == settings.truth) return;
    recorded.add(tracks.time);
    comparison.addTracks(topic, std::move(tracks));
  };
  visitor.associations = addingTo(innovations);
  reader.read(visitor);
  requireOverlap(settings.truth, truth, recorded);

  const std::vector<core::EvaluationRow> rows = comparison.rows();
  const std::vector<core::TargetRow> targets = comparison.targetRows();
  finish(output, rows, targets);
  const bool has_truth_by_sensor = truth.motions.size() > 1;
  return report::evaluationTable(rows, comparison.bestSigma(), {true, true}) + report::livesTable(rows) +
         report::targetTable(targets) +
         (has_truth_by_sensor ? "sigma: stated by the sensor whose truth it is.\n" : "") +
         report::innovationTable(innovations) +
         notesOn(comparison.withoutTruth(), "messages of sensors without a truth on");
}

/// Reads the recording twice: all tracks before the first scan.
std::string compareWithSightings(RecordingReader& reader, const BagEvaluationSettings& settings,
                                 const Output& output) {
  report::ResidualComparison comparison(settings.evaluation, listenerOf(output));
  Innovations innovations;
  bool has_truth = false;
  RecordingVisitor first_pass;
  first_pass.tracks = [&](const std::string& topic, const core::TrackReport& tracks) {
    if (topic == kTruthTopic)
      has_truth = true;
    else
      comparison.addTracks(topic, tracks);
  };
  first_pass.associations = addingTo(innovations);
  reader.read(first_pass);
  RecordingVisitor second_pass;
  second_pass.scan = [&](const std::string& topic, const core::Scan& scan) {
    comparison.addScan(topic, scan);
  };
  reader.read(second_pass);

  finish(output, report::residualRows(comparison), {});
  return report::residualTable(comparison) + report::spanTable(comparison) +
         report::innovationTable(innovations) +
         (has_truth ? "There is a truth in this recording: compare with it by --truth /truth\n" : "");
}

/// What the reader of the tables must know of how the tracks were written.
std::string noteOnWriting(const rosbag::Bag& bag) {
  if (!isWrittenInPart(bag) || rosbag::View(bag, rosbag::TopicQuery(kAllSightings)).size() == 0) return "";
  return std::string(kAllSightings) + " holds " + report::valueOf(kSlowRate, "messages") +
         " a second at most: shorter breaks and changes are not seen (replay --all writes every message)\n";
}

std::string evaluate(const rosbag::Bag& bag, const BagEvaluationSettings& settings, const Output& output) {
  const bool has_truth = !settings.truth.empty();
  RecordedTruth truth;
  if (has_truth)
    truth = readTruth(settings.truth, bag, settings.evaluation.channels, settings.evaluation.truth_gap);
  RecordingExaminationParams examination;
  examination.tracking_frame = truth.frame;
  examination.with_latency = false;
  examination.with_positions = false;  // they are no input
  RecordingReader reader(bag, truth.frame.empty() ? trackingFrameOf(bag) : truth.frame);
  const std::string tables = has_truth ? compareWithTruth(reader, truth, settings, output)
                                       : compareWithSightings(reader, settings, output);
  const std::string findings = linesOf(examineRecording(bag, examination).findings);
  return tables + notesOn(reader.leftOut(), "messages left out on", reader.examples()) + noteOnWriting(bag) +
         (findings.empty() ? "" : "Inputs:\n" + findings);
}

/// Positions in metres. Of several reports at one time the last counts.
std::string evaluatePositions(const rosbag::Bag& bag, const std::string& file,
                              const BagEvaluationSettings& settings) {
  const double gap = settings.evaluation.truth_gap;
  const auto truth = isPositionTopic(settings.truth, bag) ? positionTruthFromTopic(settings.truth, bag, gap)
                                                          : positionTruthFromCsv(settings.truth, bag, gap);
  std::map<std::string, std::map<core::Time, std::vector<core::EstimatedPosition>>> reports;  // by topic
  rosbag::View view(bag, rosbag::TypeQuery(ros::message_traits::datatype<sightline::PositionTrackArray>()));
  for (const rosbag::MessageInstance& instance : view) {
    if (instance.getTopic() == settings.truth) continue;
    const core::PositionTrackArray array = toCore(*messageOf<sightline::PositionTrackArray>(instance));
    reports[instance.getTopic()][array.time] = estimatesOf(array);
  }
  if (reports.empty()) {
    throw std::runtime_error(file + ": the truth " + settings.truth +
                             " is in positions, but there is no sightline/PositionTrackArray in the "
                             "recording; make them with replay (--positions yes)");
  }
  std::map<std::string, core::PositionRow> rows;
  std::string errors = report::positionErrorHeader(), gospa = report::positionGospaHeader();
  for (const auto& [topic, of_topic] : reports) {
    core::PositionEvaluation evaluation(truth, settings.positions);
    for (const auto& [time, tracks] : of_topic) {
      for (const auto& pair : evaluation.add(time, tracks))
        if (!settings.csv.empty()) errors += report::positionErrorLine(topic, time, pair);
      if (!settings.csv.empty() && evaluation.lastGospa())
        gospa += report::positionGospaLine(topic, time, *evaluation.lastGospa());
    }
    rows[topic] = evaluation.row();
  }
  const bool is_apart =
      std::all_of(rows.begin(), rows.end(), [](const auto& row) { return row.second.reports == 0; });
  if (is_apart) {
    throw std::runtime_error(
        settings.truth +
        ": the truth and the recording's positions have no time in common; use the truth "
        "of this recording, or bring both to one time (csv_to_bag --offset)");
  }
  if (!settings.csv.empty()) {
    std::filesystem::create_directories(settings.csv);
    const std::vector<std::string> inputs{file, settings.truth};
    report::TextFile table(settings.csv + "/positions.csv", inputs);
    report::writePositionRows(table.stream(), rows);
    table.finish();
    report::TextFile pairs(settings.csv + "/position_errors.csv", inputs);
    pairs.stream() << errors;
    pairs.finish();
    report::TextFile parts(settings.csv + "/position_gospa.csv", inputs);
    parts.stream() << gospa;
    parts.finish();
  }
  return report::positionTable(rows);
}

}  // namespace

std::string evaluateBag(const std::string& file, const BagEvaluationSettings& settings) {
  const auto bag = openBag(file);
  const bool is_file = std::filesystem::is_regular_file(settings.truth);
  if (is_file ? isPositionTruth(settings.truth) : isPositionTopic(settings.truth, *bag))
    return evaluatePositions(*bag, file, settings);
  if (settings.csv.empty()) return evaluate(*bag, settings, {});
  const std::vector<std::string> inputs{file, settings.truth};
  report::ScoreFiles files(settings.csv, inputs);
  return evaluate(*bag, settings, {&files, settings.csv + "/evaluation.csv", inputs});
}

}  // namespace sightline_ros
