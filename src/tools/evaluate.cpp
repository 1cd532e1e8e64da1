#include <iostream>
#include <string>
#include <vector>

#include "sightline/report/command_line.h"
#include "sightline/ros/recordings/bag_evaluation.h"
#include "sightline/ros/recordings/evaluation_scripts.h"

namespace {

using sightline::report::CommandLine;
using sightline::report::NumberRange;
using sightline::report::UsageError;

const char* const kUsage =
    "Usage: evaluate [--truth TOPIC_OR_CSV] [options] OUT.bag\n"
    "Compares every TrackArray topic of a recording with the truth, also for each target: RMSE, ANEES with "
    "its "
    "95 % band,\n"
    "GOSPA, OSPA, breaks, changes of identity, time to confirm, false tracks. Without --truth: the residuals "
    "of "
    "the sightings\n"
    "from the tracks, and the lengths of the tracks.\n"
    "  --truth TOPIC_OR_CSV   a TrackArray or PositionTrackArray topic of the bag, or a file with a header "
    "line "
    "and the columns "
    "time,azimuth\n"
    "                         and, as there are, elevation, target, sensor (whose directions they are), "
    "range_m; s, rad\n"
    "                         or positions, of which then every PositionTrackArray topic is scored in "
    "metres: "
    "time[,target],\n"
    "                         east_m,north_m,up_m or time[,target],latitude_deg,longitude_deg,height_m\n"
    "  --no-truth             compare with the sightings (as without --truth)\n"
    "  --azimuth-only         the truth's elevation is not known, or sightings have none: compare azimuths "
    "alone\n"
    "  --settle S             first seconds of each target, which are not scored (default 0)\n"
    "  --truth-gap S          between samples of the truth further apart a target does not exist (default "
    "2)\n"
    "  --match-gate RAD       largest distance of a target's track (default ten stated sigmas of the "
    "coarsest sensor)\n"
    "  --sighting-gate N      largest distance of a target's sighting in stated sigmas (default 6)\n"
    "  --sighting-floor RAD   distance within which a sighting is a target's, whatever sigma it states "
    "(default "
    "0)\n"
    "  --gospa-c RAD          cutoff of GOSPA and OSPA, whose order is 2 (default 0.01)\n"
    "  --gospa-c-m M          the same of positions, and how far a target's position may be off at least "
    "(default 10)\n"
    "  --csv DIR              writes CSV files: evaluation.csv (every figure, a line for each topic and for "
    "each "
    "of its\n"
    "                         targets), errors.csv, gospa.csv\n"
    "  --plots DIR            writes the same, and pictures of errors, consistency and GOSPA over time\n"
    "  --html FILE            writes a report to send on: one page with plots that zoom, and the tables. "
    "Without "
    "--truth it\n"
    "                         compares with the recording's own truth (/truth, /truth/positions), where it "
    "has one\n"
    "  --against OTHER.bag    in the report, a second recording side by side, and what differs\n";

sightline::core::EvaluationParams paramsFrom(const CommandLine& line) {
  constexpr NumberRange kAtLeastZero = NumberRange::at_least_zero, kAboveZero = NumberRange::above_zero;
  sightline::core::EvaluationParams params;
  if (line.has("--azimuth-only")) params.channels = sightline::core::Channels::azimuth_only;
  params.settle_time = line.number("--settle", params.settle_time, kAtLeastZero);
  params.truth_gap = line.number("--truth-gap", params.truth_gap, kAboveZero);
  params.match_gate = line.number("--match-gate", params.match_gate, kAtLeastZero);
  params.sighting_gate = line.number("--sighting-gate", params.sighting_gate, kAboveZero);
  params.sighting_gate_floor = line.number("--sighting-floor", params.sighting_gate_floor, kAtLeastZero);
  params.gospa.cutoff = line.number("--gospa-c", params.gospa.cutoff, kAboveZero);
  return params;
}

sightline_ros::BagEvaluationSettings settingsFrom(const CommandLine& line) {
  sightline_ros::BagEvaluationSettings settings;
  settings.truth = line.option("--truth", "");
  settings.csv = line.option("--csv", line.option("--plots", ""));
  settings.evaluation = paramsFrom(line);
  settings.positions.gospa_cutoff =
      line.number("--gospa-c-m", settings.positions.gospa_cutoff, NumberRange::above_zero);
  settings.positions.settle = settings.evaluation.settle_time;
  return settings;
}

void requireSense(const CommandLine& line) {
  if (line.has("--no-truth") && line.has("--truth"))
    throw UsageError("--truth and --no-truth exclude each other: give one");
  if (line.has("--plots") && line.has("--csv"))
    throw UsageError("--plots DIR writes the files of --csv as well: give one");
  if (line.has("--html") && (line.has("--csv") || line.has("--plots")))
    throw UsageError("--html FILE excludes --csv and --plots: give them in a run of their own");
  if (line.has("--against") && !line.has("--html"))
    throw UsageError("--against OTHER.bag is of the report: give --html FILE as well");
}

void evaluate(const std::vector<std::string>& words) {
  const CommandLine line(
      words,
      {"--truth", "--settle", "--truth-gap", "--match-gate", "--sighting-gate", "--sighting-floor",
       "--gospa-c", "--gospa-c-m", "--csv", "--plots", "--html", "--against"},
      1, 1, {"--azimuth-only", "--no-truth"});
  requireSense(line);
  const std::string& bag = line.arguments()[0];
  if (!line.has("--html")) {
    std::cout << sightline_ros::evaluateBag(bag, settingsFrom(line));
    if (line.has("--plots")) sightline_ros::drawEvaluation(line.option("--plots", ""));
    return;
  }
  sightline_ros::ReportSettings report{
      {bag}, line.option("--html", ""), !line.has("--truth") && !line.has("--no-truth"), settingsFrom(line)};
  if (line.has("--against")) report.bags.push_back(line.option("--against", ""));
  std::cout << sightline_ros::writeReport(report);
}

}  // namespace

int main(int argc, char** argv) {
  return sightline::report::runTool(argc, argv, kUsage, evaluate);
}
