// Every table of accuracy: the estimators with their default settings, baselines, bounds and aims.
//
//   accuracy [--quick] [--runs N] [--table NAME]... [--recordings DIR] [--threads N]
//
// Without --table all of them: ten minutes on two cores, --quick one. Figures come from fixed seeds and do
// not depend on the number of threads. +- is the 95 % band over runs; "met", "met?" (missed by less than the
// band) and "MISSED" mark an aim.

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <set>
#include <stdexcept>
#include <string>

#include "number_option.h"
#include "tables.h"

#ifndef SIGHTLINE_SHARED_DIR
#define SIGHTLINE_SHARED_DIR ""
#endif

namespace sightline::bench {
namespace {

struct Table {
  const char* name;
  void (*print)(const Options&);
};

constexpr Table kTables[] = {{"paper", printPaper},
                             {"scenarios", printScenarios},
                             {"unseen", printUnseen},
                             {"six-sensors", printSixSensors},
                             {"scale", printScale},
                             {"recordings", printRecordings},
                             {"consistency", printConsistency},
                             {"degraded", printDegraded},
                             {"track-fusion", printTrackFusion},
                             {"beats-best", printBeatsBest}};

std::string tableNames() {
  std::string names;
  for (const Table& table : kTables) names += std::string(names.empty() ? "" : ", ") + table.name;
  return names;
}

void run(int argc, char** argv) {
  Options options;
  if (const std::string shared = SIGHTLINE_SHARED_DIR; !shared.empty()) options.recordings = shared + "/data";
  std::set<std::string> wanted;
  int runs = 0;
  for (int i = 1; i < argc; ++i) {
    const std::string option = argv[i];
    if (option == "--quick") {
      options.quick = true;
      continue;
    }
    const bool known =
        option == "--runs" || option == "--threads" || option == "--table" || option == "--recordings";
    if (!known || i + 1 == argc)
      throw std::invalid_argument(
          "usage: accuracy [--quick] [--runs N] [--table NAME]... [--recordings DIR] [--threads "
          "N]\ntables: " +
          tableNames());
    const std::string value = argv[++i];
    if (option == "--runs") runs = numberOf(option, value, 2);
    if (option == "--threads") options.threads = numberOf(option, value, 1);
    if (option == "--recordings") options.recordings = value;
    if (option == "--table") wanted.insert(value);
  }
  options.runs = runs > 0 ? runs : options.quick ? 20 : 200;
  for (const std::string& name : wanted) {
    bool known = false;
    for (const Table& table : kTables) known = known || name == table.name;
    if (!known) throw std::invalid_argument("--table: no table \"" + name + "\"; there are " + tableNames());
  }
  for (const Table& table : kTables) {
    if (!wanted.empty() && wanted.count(table.name) == 0) continue;
    table.print(options);
    std::fflush(stdout);
  }
}

}  // namespace

const char* markOf(double value, double aim, double band) {
  return value <= aim ? "met" : value - band <= aim ? "met?" : "MISSED";
}

const char* markOf(double value, double low, double high, double band) {
  if (value >= low && value <= high) return "met";
  return value + band >= low && value - band <= high ? "met?" : "MISSED";
}

}  // namespace sightline::bench

int main(int argc, char** argv) {
  try {
    sightline::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "accuracy: %s\n", error.what());
    return 2;
  }
  return 0;
}
