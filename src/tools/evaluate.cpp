#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <sys/wait.h>
#include <unistd.h>

#include <ros/package.h>

#include "sightline/report/command_line.h"
#include "sightline/ros/recordings/bag_evaluation.h"

namespace {

using sightline_ros::UsageError;

const char* const kUsage =
    "Usage: evaluate [--truth TOPIC_OR_CSV] [options] OUT.bag\n"
    "Says how good the tracks of a recording are: RMSE, ANEES with its 95 % band, GOSPA, OSPA, breaks, "
    "changes "
    "of identity,\n"
    "time to confirm, false tracks, of every TrackArray topic and target. Without --truth, how the sightings "
    "lie about the tracks, and how long these "
    "live.\n"
    "  --truth TOPIC_OR_CSV   a TrackArray topic of the bag, or a file with a header line and the columns "
    "time,azimuth\n"
    "                         and, as there are, elevation, target, sensor (whose directions they are), "
    "range_m; s, rad\n"
    "  --no-truth             compare with the sightings (as without --truth)\n"
    "  --azimuth-only         the truth's elevation is not known, or sightings have none: compare azimuths "
    "alone\n"
    "  --settle S             first seconds of each target, which do not count (default 0)\n"
    "  --truth-gap S          a target is not there between samples of the truth further apart (default 2)\n"
    "  --match-gate RAD       largest distance of a target's track (default ten stated sigmas of the "
    "coarsest sensor)\n"
    "  --sighting-gate N      largest distance of a target's sighting in stated sigmas (default 6)\n"
    "  --sighting-floor RAD   within which a sighting is a target's whatever sigma it states (default 0)\n"
    "  --gospa-c RAD          cutoff of GOSPA and OSPA, whose order is 2 (default 0.01)\n"
    "  --csv DIR              what was compared and found, as CSV files: evaluation.csv (every figure, a "
    "line "
    "for each\n"
    "                         topic, and for each of its targets), errors.csv, gospa.csv\n"
    "  --plots DIR            the same, and pictures of errors, consistency and GOSPA over time\n";

/// Whether the flag is there; takes it out.
bool takeFlag(std::vector<std::string>& words, const std::string& flag) {
  const auto end = std::remove(words.begin(), words.end(), flag);
  const bool found = end != words.end();
  words.erase(end, words.end());
  return found;
}

/// The option's number, at least 0 (above 0 when `must_be_positive`).
double number(const sightline_ros::CommandLine& line, const std::string& option, double fallback,
              bool must_be_positive = false) {
  if (!line.has(option)) return fallback;
  const std::string text = line.option(option, "");
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  const bool is_number = !text.empty() && *end == '\0' && std::isfinite(value);
  if (is_number && (must_be_positive ? value > 0.0 : value >= 0.0)) return value;
  throw UsageError(option + ": expected a number " + (must_be_positive ? "above 0" : "of at least 0") +
                   ", got \"" + text + "\"");
}

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

void evaluate(const std::vector<std::string>& all_words) {
  std::vector<std::string> words = all_words;
  const bool azimuth_only = takeFlag(words, "--azimuth-only"), no_truth = takeFlag(words, "--no-truth");
  const sightline_ros::CommandLine line(
      words,
      {"--truth", "--settle", "--truth-gap", "--match-gate", "--sighting-gate", "--sighting-floor",
       "--gospa-c", "--csv", "--plots"},
      1, 1);
  if (no_truth && line.has("--truth")) throw UsageError("--truth and --no-truth exclude each other");

  sightline_ros::BagEvaluationSettings settings;
  settings.truth = line.option("--truth", "");
  const std::string plots = line.option("--plots", "");
  if (!plots.empty() && line.has("--csv"))
    throw UsageError("--plots DIR writes the files of --csv as well: give one");
  settings.csv = line.option("--csv", plots);
  auto& params = settings.evaluation;
  if (azimuth_only) params.channels = sightline::core::Channels::azimuth_only;
  params.settle_time = number(line, "--settle", params.settle_time);
  params.truth_gap = number(line, "--truth-gap", params.truth_gap, true);
  params.match_gate = number(line, "--match-gate", params.match_gate);
  params.sighting_gate = number(line, "--sighting-gate", params.sighting_gate, true);
  params.sighting_gate_floor = number(line, "--sighting-floor", params.sighting_gate_floor);
  params.gospa.cutoff = number(line, "--gospa-c", params.gospa.cutoff, true);

  std::cout << sightline_ros::evaluateBag(line.arguments()[0], settings);
  if (!plots.empty()) draw(plots);
}

}  // namespace

int main(int argc, char** argv) {
  return sightline_ros::runTool(argc, argv, kUsage, evaluate);
}
