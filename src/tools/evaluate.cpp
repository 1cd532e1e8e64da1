#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <sys/wait.h>
#include <unistd.h>

#include <ros/package.h>

#include "sightline/report/command_line.h"
#include "sightline/ros/recordings/bag_evaluation.h"

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
    "  --plots DIR            writes the same, and pictures of errors, consistency and GOSPA over time\n";

/// The installed script beside this program, or that of the source folder.
std::string plotScript() {
  namespace fs = std::filesystem;
  const std::string name = "plot_evaluation";
  const fs::path beside = fs::read_symlink("/proc/self/exe").parent_path() / name;
  if (fs::exists(beside)) return beside.string();
  const fs::path source = fs::path(ros::package::getPath("sightline")) / "scripts" / name;
  if (fs::exists(source)) return source.string();
  throw std::runtime_error(name +
                           ": the script that draws is neither beside this program nor in the package");
}

void draw(const std::string& folder) {
  const std::string script = plotScript();
  std::cout.flush();
  const pid_t child = fork();
  if (child == 0) {
    execl(script.c_str(), script.c_str(), folder.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) < 0 || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw std::runtime_error(script + " failed; the files that it draws are in " + folder);
  }
}

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

void evaluate(const std::vector<std::string>& words) {
  const CommandLine line(words,
                         {"--truth", "--settle", "--truth-gap", "--match-gate", "--sighting-gate",
                          "--sighting-floor", "--gospa-c", "--gospa-c-m", "--csv", "--plots"},
                         1, 1, {"--azimuth-only", "--no-truth"});
  if (line.has("--no-truth") && line.has("--truth"))
    throw UsageError("--truth and --no-truth exclude each other: give one");

  sightline_ros::BagEvaluationSettings settings;
  settings.truth = line.option("--truth", "");
  const std::string plots = line.option("--plots", "");
  if (!plots.empty() && line.has("--csv"))
    throw UsageError("--plots DIR writes the files of --csv as well: give one");
  settings.csv = line.option("--csv", plots);
  settings.evaluation = paramsFrom(line);
  settings.positions.gospa_cutoff =
      line.number("--gospa-c-m", settings.positions.gospa_cutoff, NumberRange::above_zero);
  settings.positions.settle = settings.evaluation.settle_time;

  std::cout << sightline_ros::evaluateBag(line.arguments()[0], settings);
  if (!plots.empty()) draw(plots);
}

}  // namespace

int main(int argc, char** argv) {
  return sightline::report::runTool(argc, argv, kUsage, evaluate);
}
