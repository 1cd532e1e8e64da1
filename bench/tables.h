#pragma once

#include <string>

/// The tables of `accuracy`. To add one: a file bench/tables_<what>.cpp with a function
/// `void print<What>(const Options&)` that prints one table and returns in its share of the time, its
/// declaration here, its file in the list of CMakeLists.txt (sightline_accuracy) and its line in the list at
/// the top of accuracy.cpp. Each line of a table: a contender, its figure, the 95 % band over runs, and the
/// aim with a mark (markOf) where there is one. Figures come from fixed seeds and do not depend on the number
/// of threads: use forEachRun of parallel.h over runs, each writing to a place of its own.
namespace sightline::bench {

struct Options {
  int runs = 200;          ///< Monte-Carlo runs of each cell
  int threads = 2;         ///< that share the runs
  bool quick = false;      ///< all tables in a minute: `runs` is small, long ones may leave cases out
  std::string recordings;  ///< folder of the recordings (CSV), empty or absent: their table is skipped
};

/// "met", "met?" (missed by less than the 95 % band) or "MISSED": whether `value` is at most `aim`.
const char* markOf(double value, double aim, double band);
/// The same for an aim of low <= value <= high.
const char* markOf(double value, double low, double high, double band);

void printPaper(const Options& options);        ///< the paper's benchmark, every form of every estimator
void printScenarios(const Options& options);    ///< the eight scenarios of section 7.1
void printUnseen(const Options& options);       ///< six trajectories that estimators.md does not name
void printSixSensors(const Options& options);   ///< six asynchronous sensors in one tracker
void printScale(const Options& options);        ///< the same at every angular scale
void printRecordings(const Options& options);   ///< recorded sightings, section 8
void printConsistency(const Options& options);  ///< ANEES of what is published
void printDegraded(const Options& options);     ///< one of six sensors degrades unannounced: the guard
void printTrackFusion(const Options& options);  ///< fusion rules against the central tracker
void printBeatsBest(const Options& options);    ///< fused tracks against the best local one

}  // namespace sightline::bench
