// Many targets in clutter, with the default settings of a local tracker: clutter and detection probability
// are not configured.
//
//   crowd [--table NAME] [--runs N] [--duration SECONDS] [--crossing DIR] [--estimator twbls|noga|kalman|imm]
//         [--association nearest|jpda]
//
// Tables: crossing (10 targets; recordings DIR/run1 .. run3), straight (10 targets on straight lines), dense
// (14 targets that cross, P_D 0.85, 8 false sightings a scan), clutter (3 targets, P_D 0.8, 50 false ones),
// faint (P_D 0.6), formation, splitting, gaps, load (200 targets, six sensors at 30 Hz; --runs minutes).
// Figures of all but the last: mean GOSPA (c = 10 mrad, p = 2) with its parts, changes of identity, breaks,
// false tracks, ANEES of position and state, and scans a second of processor time. --duration: of a run, 60 s
// unless given; most targets leave within the first minute, so that a longer run counts false tracks.

#include "crowd.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <stdexcept>
#include <string>
#include <sys/resource.h>

#include "sightline/core/model/sphere.h"

#include "processor_time.h"

namespace sightline::bench {
namespace {

struct Options {
  std::string table;
  std::string crossing;
  int runs = 10;
  double duration = 0.0;  // of a run [s]; 0 = the table's own
  core::LocalTrackerParams params;
};

void printHead(const char* title) {
  std::printf("\n%s\n%-10s %7s %7s %7s %7s %5s %6s %7s %7s %9s %9s\n", title, "", "GOSPA", "local.", "missed",
              "false", "ids", "breaks", "tracks", "false", "a second", "us each");
  std::printf("%-10s %7s %7s %7s %7s %5s %6s %7s %7s %9s %9s\n", "", "mrad", "mrad", "a scan", "a scan", "",
              "", "", "tracks", "scans", "sighting");
}

void printLine(const std::string& name, const CrowdRecording& recording, const CrowdFigures& figures) {
  double sightings = 0.0;
  for (const core::Scan& scan : recording.scans) sightings += static_cast<double>(scan.sightings.size());
  std::printf("%-10s %7.3f %7.3f %7.3f %7.3f %5d %6d %7d %7d %9.0f %9.2f\n", name.c_str(),
              1e3 * figures.gospa, 1e3 * figures.localisation, figures.missed, figures.extra,
              figures.id_switches, figures.breaks, figures.tracks, figures.false_tracks,
              static_cast<double>(recording.scans.size()) / figures.seconds,
              1e6 * figures.seconds / sightings);
  std::fflush(stdout);
}

/// Targets that cross near the middle of the field at about the same time.
CrowdScenario crossing(int targets, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform;
  CrowdScenario scenario;
  for (int i = 0; i < targets; ++i) {
    const double heading = 2.0 * sightline::core::kPi * (i + 0.6 * uniform(random)) / targets;
    const double speed = 0.006 + 0.008 * uniform(random);
    CrowdTarget target;
    target.from = 10.0 * uniform(random);
    target.to = 50.0 + 10.0 * uniform(random);
    target.meeting = 27.0 + 6.0 * uniform(random);
    target.at = scenario.centre + 0.01 * Eigen::Vector2d(uniform(random) - 0.5, uniform(random) - 0.5);
    target.rate = speed * Eigen::Vector2d(std::cos(heading), std::sin(heading));
    target.weave = 0.01 * Eigen::Vector2d(uniform(random) - 0.5, uniform(random) - 0.5);
    target.period = 20.0 + 20.0 * uniform(random);
    scenario.targets.push_back(target);
  }
  return scenario;
}

void printRuns(const Options& options, const char* title, CrowdScenario (*make)(std::uint64_t)) {
  printHead(title);
  CrowdFigures sum;
  for (int run = 1; run <= options.runs; ++run) {
    CrowdScenario scenario = make(static_cast<std::uint64_t>(run));
    if (options.duration > 0.0) scenario.duration = options.duration;
    const CrowdRecording recording = record(scenario, static_cast<std::uint64_t>(run));
    const CrowdFigures figures = follow(recording, options.params);
    printLine("seed " + std::to_string(run), recording, figures);
    sum.id_switches += figures.id_switches;
    sum.false_tracks += figures.false_tracks;
    sum.hours += figures.hours;
    sum.gospa += figures.gospa / options.runs;
    sum.position_anees += figures.position_anees / options.runs;
    sum.state_anees += figures.state_anees / options.runs;
  }
  std::printf(
      "all        GOSPA %.3f mrad, %.2f changes of identity a run, %d false tracks in %.2f h, ANEES %.2f "
      "position, %.2f state\n",
      1e3 * sum.gospa, static_cast<double>(sum.id_switches) / options.runs, sum.false_tracks, sum.hours,
      sum.position_anees, sum.state_anees);
}

void printCrossing(const Options& options) {
  if (options.crossing.empty()) {
    std::printf("\ncrossing: skipped, no --crossing DIR\n");
    return;
  }
  printHead("Recordings of 10 targets that cross, P_D 0.9, 5 false sightings a scan");
  for (const char* run : {"run1", "run2", "run3"}) {
    const CrowdRecording recording = readCrowd(options.crossing + "/" + run);
    printLine(run, recording, follow(recording, options.params));
  }
}

/// The same without weaving: honest covariances have an ANEES of one here, too.
CrowdScenario straight(std::uint64_t seed) {
  CrowdScenario scenario = crossing(10, seed);
  for (CrowdTarget& target : scenario.targets) target.weave.setZero();
  return scenario;
}

CrowdScenario dense(std::uint64_t seed) {
  CrowdScenario scenario = crossing(14, seed);
  scenario.detection_probability = 0.85;
  scenario.clutter = 8.0;
  return scenario;
}

CrowdScenario clutter(std::uint64_t seed) {
  CrowdScenario scenario = crossing(3, seed);
  scenario.detection_probability = 0.8;
  scenario.clutter = 50.0;
  return scenario;
}

CrowdScenario faint(std::uint64_t seed) {
  CrowdScenario scenario = crossing(8, seed);
  scenario.detection_probability = 0.6;
  scenario.clutter = 5.0;
  return scenario;
}

/// Five targets that fly side by side, eight sigmas apart, and turn together.
CrowdScenario formation(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform;
  CrowdScenario scenario;
  CrowdTarget target;
  target.rate = {0.01 * (uniform(random) - 0.5), 0.0};
  target.weave = {0.06, 0.04 * uniform(random)};
  target.period = 15.0 + 10.0 * uniform(random);
  for (int i = 0; i < 5; ++i) {
    target.at = scenario.centre + Eigen::Vector2d(0.008 * i, 0.004 * (i % 2));
    scenario.targets.push_back(target);
  }
  return scenario;
}

/// Three targets of which each becomes three.
CrowdScenario splitting(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform;
  CrowdScenario scenario;
  for (int i = 0; i < 3; ++i) {
    CrowdTarget whole;
    whole.at = scenario.centre + Eigen::Vector2d(0.15 * (i - 1), 0.1 * (uniform(random) - 0.5));
    whole.rate = 0.006 * Eigen::Vector2d(uniform(random) - 0.5, uniform(random) - 0.5);
    whole.meeting = 15.0 + 10.0 * uniform(random);
    scenario.targets.push_back(whole);
    for (const double side : {-1.0, 1.0}) {
      CrowdTarget part = whole;
      part.from = whole.meeting;
      part.rate += side * Eigen::Vector2d(0.003, 0.002 * (uniform(random) + 0.5));
      scenario.targets.push_back(part);
    }
  }
  return scenario;
}

/// Eight targets, each hidden once for 0.5 to 3 s.
CrowdScenario gaps(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform;
  CrowdScenario scenario = crossing(8, seed);
  for (CrowdTarget& target : scenario.targets) {
    target.hidden_from = 12.0 + 30.0 * uniform(random);
    target.hidden_to = target.hidden_from + 0.5 + 2.5 * uniform(random);
  }
  return scenario;
}

/// Largest resident memory so far [MB].
double memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

/// 200 targets all over a wide field, from the first to the last second.
void printLoad(const Options& options) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform;
  CrowdScenario scenario;
  scenario.sensors = 6;
  scenario.detection_probability = 1.0;
  scenario.clutter = 10.0;
  scenario.duration = 10.0;
  scenario.half_field = {1.0, 0.6};
  for (int i = 0; i < 200; ++i) {
    CrowdTarget target;
    target.at = scenario.centre + 0.8 * scenario.half_field.cwiseProduct(Eigen::Vector2d(
                                            2.0 * uniform(random) - 1.0, 2.0 * uniform(random) - 1.0));
    target.weave = 0.05 * Eigen::Vector2d(uniform(random) - 0.5, uniform(random) - 0.5);
    target.period = 10.0;
    target.meeting = 10.0 * uniform(random);
    scenario.targets.push_back(target);
  }
  const CrowdRecording recording = record(scenario, 1);
  std::size_t sightings = 0;
  for (const core::Scan& scan : recording.scans) sightings += scan.sightings.size();
  std::printf("\n200 targets, six sensors at 30 Hz, 10 false sightings a scan: %.0f sightings a second\n",
              static_cast<double>(sightings) / scenario.duration);
  core::LocalTracker tracker(options.params);
  double spent = 0.0;
  const int minutes = options.runs;
  for (int block = 0; block < 6 * minutes; ++block) {
    for (core::Scan scan : recording.scans) {
      scan.time += core::durationOf(block * scenario.duration);
      const double before = processorTime();
      const auto report = tracker.onScan(scan);
      spent += processorTime() - before;
    }
    if (block % 6 == 5) {
      std::printf("minute %2d: %.2f s of processor time a second, %.0f MB\n", (block + 1) / 6, spent / 60.0,
                  memory());
      std::fflush(stdout);
      spent = 0.0;
    }
  }
}

core::EstimatorKind kindOf(const std::string& name) {
  if (name == "twbls") return core::EstimatorKind::twbls;
  if (name == "noga") return core::EstimatorKind::noga;
  if (name == "kalman") return core::EstimatorKind::kalman;
  if (name == "imm") return core::EstimatorKind::imm;
  throw std::invalid_argument("--estimator: expected twbls, noga, kalman or imm, got " + name);
}

core::AssociationMethod methodOf(const std::string& name) {
  if (name == "nearest") return core::AssociationMethod::nearest;
  if (name == "jpda") return core::AssociationMethod::jpda;
  throw std::invalid_argument("--association: expected nearest or jpda, got " + name);
}

double durationFrom(const std::string& text) {
  const double duration = std::atof(text.c_str());
  if (!(duration > 0.0) || duration > 1e5)
    throw std::invalid_argument("--duration: expected seconds above 0, at most 1e5, got " + text);
  return duration;
}

int run(int argc, char** argv) {
  Options options;
  for (int k = 1; k + 1 < argc; k += 2) {
    const std::string name = argv[k], value = argv[k + 1];
    if (name == "--table")
      options.table = value;
    else if (name == "--runs")
      options.runs = std::atoi(value.c_str());
    else if (name == "--duration")
      options.duration = durationFrom(value);
    else if (name == "--crossing")
      options.crossing = value;
    else if (name == "--association")
      options.params.association = methodOf(value);
    else if (name == "--estimator")
      options.params.estimator.kind = kindOf(value);
    else
      throw std::invalid_argument("no option " + name);
  }
  const auto wanted = [&](const char* name) { return options.table.empty() || options.table == name; };
  if (wanted("crossing")) printCrossing(options);
  if (wanted("straight"))
    printRuns(options, "10 targets on straight lines, P_D 0.9, 5 false sightings a scan", straight);
  if (wanted("dense")) printRuns(options, "14 targets that cross, P_D 0.85, 8 false sightings a scan", dense);
  if (wanted("faint")) printRuns(options, "8 targets that cross, P_D 0.6, 5 false sightings a scan", faint);
  if (wanted("clutter")) printRuns(options, "3 targets, P_D 0.8, 50 false sightings a scan", clutter);
  if (wanted("formation")) printRuns(options, "5 targets that fly side by side, 8 mrad apart", formation);
  if (wanted("splitting")) printRuns(options, "3 targets that become 9", splitting);
  if (wanted("gaps")) printRuns(options, "8 targets, each hidden once for 0.5 to 3 s", gaps);
  if (wanted("load")) printLoad(options);
  return 0;
}

}  // namespace
}  // namespace sightline::bench

int main(int argc, char** argv) {
  try {
    return sightline::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "crowd: %s\n", error.what());
    return 1;
  }
}
