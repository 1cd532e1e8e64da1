#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include <ros/package.h>

#include "sightline/report/command_line.h"
#include "sightline/report/output_file.h"
#include "sightline/ros/recordings/bag_evaluation.h"
#include "sightline/ros/recordings/bags.h"
#include "sightline/ros/recordings/report_data.h"

namespace {

namespace fs = std::filesystem;
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

/// An installed script beside this program, or that of the source folder.
std::string scriptNamed(const std::string& name) {
  const fs::path beside = fs::read_symlink("/proc/self/exe").parent_path() / name;
  if (fs::exists(beside)) return beside.string();
  const fs::path source = fs::path(ros::package::getPath("sightline")) / "scripts" / name;
  if (fs::exists(source)) return source.string();
  throw std::runtime_error(name +
                           ": the script that draws is neither beside this program nor in the package");
}

/// Whether the script ended well.
bool runScript(const std::string& name, const std::vector<std::string>& arguments) {
  const std::string script = scriptNamed(name);
  std::vector<char*> words{const_cast<char*>(script.c_str())};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  std::cout.flush();
  const pid_t child = fork();
  if (child == 0) {
    execv(script.c_str(), words.data());
    _exit(127);
  }
  int status = 0;
  return child > 0 && waitpid(child, &status, 0) > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

void draw(const std::string& folder) {
  if (!runScript("plot_evaluation", {folder}))
    throw std::runtime_error("plot_evaluation failed; the files that it draws are in " + folder);
}

/// A folder that is removed with all that is in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "sightline_report_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw std::runtime_error(name + ": the folder cannot be made: " + std::strerror(errno));
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  fs::path path_;
};

/// Writes the page; returns the tables.
std::string report(const std::vector<std::string>& bags, const std::string& page, bool finds_truth,
                   sightline_ros::BagEvaluationSettings settings) {
  std::vector<std::string> inputs = bags;
  inputs.push_back(settings.truth);
  sightline::report::OutputFile file(page, inputs);
  if (!runScript("report_evaluation", {"--check"}))
    throw std::runtime_error(page + ": not written, as report_evaluation cannot run");
  const TemporaryFolder folder;
  std::vector<std::string> arguments{file.unfinished()};
  std::string tables;
  for (const std::string& bag : bags) {
    std::vector<std::string> truths;
    if (!settings.truth.empty()) truths = {settings.truth};
    if (finds_truth) truths = sightline_ros::truthTopicsOf(*sightline_ros::openBag(bag));
    settings.csv = folder.file(arguments.size() == 1 ? "this" : "other");
    arguments.push_back(settings.csv);
    if (bags.size() > 1) tables += (tables.empty() ? "" : "\n") + bag + ":\n";
    tables += sightline_ros::evaluateForReport(bag, truths, settings);
  }
  if (!runScript("report_evaluation", arguments)) throw std::runtime_error(page + ": not written");
  file.finish();
  return tables + page + "\n";
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
  const CommandLine line(
      words,
      {"--truth", "--settle", "--truth-gap", "--match-gate", "--sighting-gate", "--sighting-floor",
       "--gospa-c", "--gospa-c-m", "--csv", "--plots", "--html", "--against"},
      1, 1, {"--azimuth-only", "--no-truth"});
  if (line.has("--no-truth") && line.has("--truth"))
    throw UsageError("--truth and --no-truth exclude each other: give one");

  sightline_ros::BagEvaluationSettings settings;
  settings.truth = line.option("--truth", "");
  const std::string plots = line.option("--plots", "");
  if (!plots.empty() && line.has("--csv"))
    throw UsageError("--plots DIR writes the files of --csv as well: give one");
  const std::string page = line.option("--html", "");
  if (line.has("--against") && page.empty())
    throw UsageError("--against OTHER.bag is of the report: give --html FILE as well");
  if (!page.empty() && (line.has("--csv") || !plots.empty()))
    throw UsageError("--html FILE excludes --csv and --plots: give them in a run of their own");
  settings.csv = line.option("--csv", plots);
  settings.evaluation = paramsFrom(line);
  settings.positions.gospa_cutoff =
      line.number("--gospa-c-m", settings.positions.gospa_cutoff, NumberRange::above_zero);
  settings.positions.settle = settings.evaluation.settle_time;

  std::vector<std::string> bags{line.arguments()[0]};
  if (line.has("--against")) bags.push_back(line.option("--against", ""));
  const bool finds_truth = !line.has("--truth") && !line.has("--no-truth");
  std::cout << (page.empty() ? sightline_ros::evaluateBag(bags[0], settings)
                             : report(bags, page, finds_truth, settings));
  if (!plots.empty()) draw(plots);
}

}  // namespace

int main(int argc, char** argv) {
  return sightline::report::runTool(argc, argv, kUsage, evaluate);
}
