#include "fuzz/fuzz_driver.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <map>
#include <stdexcept>

#include "sightline/report/command_line.h"

namespace sightline_fuzz {

namespace report = sightline::report;

namespace {

const char* const kUsage =
    "usage: fuzz [--seconds N] [--seed N] [--target NAME] [--case N] [--keep-going] [--list]\n"
    "\n"
    "Feeds the trackers, the fusion and the readers of files random input, well formed and not, and checks\n"
    "after each call what must always hold. The same number is the same case on every machine.\n"
    "  --seconds N    runs cases for so long, of all targets in turn (10)\n"
    "  --seed N       number of the first case (1)\n"
    "  --target NAME  of this target alone\n"
    "  --case N       this case alone\n"
    "  --keep-going   does not stop at the first fault\n"
    "  --list         names the targets\n";

std::vector<FuzzTarget> chosen(const std::vector<FuzzTarget>& targets, const std::string& name) {
  std::vector<FuzzTarget> some;
  for (const FuzzTarget& target : targets)
    if (name.empty() || target.name == name) some.push_back(target);
  if (some.empty()) throw report::UsageError("--target " + name + " is none: see --list");
  return some;
}

void print(const std::map<std::string, Tally>& tallies) {
  std::printf("%-18s %10s %10s %10s %8s %12s\n", "target", "cases", "calls", "refused", "faults",
              "longest [s]");
  for (const auto& [name, tally] : tallies)
    std::printf("%-18s %10llu %10llu %10llu %8llu %12.3f\n", name.c_str(),
                static_cast<unsigned long long>(tally.cases), static_cast<unsigned long long>(tally.calls),
                static_cast<unsigned long long>(tally.refusals),
                static_cast<unsigned long long>(tally.faults), tally.longest);
}

void fuzz(const std::vector<std::string>& words, const std::vector<FuzzTarget>& all) {
  const report::CommandLine line(words, {"--seconds", "--seed", "--target", "--case"}, 0, 0,
                                 {"--keep-going", "--list"});
  if (line.has("--list")) {
    for (const FuzzTarget& target : all)
      std::printf("%-18s %s\n", target.name.c_str(), target.description.c_str());
    return;
  }
  const std::vector<FuzzTarget> targets = chosen(all, line.option("--target", ""));
  const double seconds = line.number("--seconds", 10.0, report::NumberRange::at_least_zero);
  const bool one_case = line.has("--case"), keeps_going = line.has("--keep-going");
  auto number = static_cast<std::uint64_t>(line.wholeNumber(one_case ? "--case" : "--seed", 1));

  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  std::map<std::string, Tally> tallies;
  std::uint64_t faults = 0;
  do {
    for (const FuzzTarget& target : targets) {
      const auto fault = runCase(target, number, tallies[target.name]);
      if (!fault) continue;
      ++faults;
      std::printf("FAULT %s --case %llu: %s\n", target.name.c_str(), static_cast<unsigned long long>(number),
                  fault->c_str());
      std::fflush(stdout);
      if (!keeps_going) break;
    }
    ++number;
  } while (!one_case && (faults == 0 || keeps_going) &&
           std::chrono::duration<double>(Clock::now() - begin).count() < seconds);
  print(tallies);
  if (faults > 0) throw std::runtime_error(std::to_string(faults) + " faults");
}

}  // namespace

std::optional<std::string> runCase(const FuzzTarget& target, std::uint64_t number, Tally& tally) {
  RandomInput input(number);
  Trial trial;
  std::optional<std::string> found;
  try {
    target.run(input, trial);
  } catch (const std::exception& fault) {
    found = "call " + std::to_string(trial.calls()) + ": " + fault.what();
  }
  ++tally.cases;
  tally.calls += trial.calls();
  tally.refusals += trial.refusals();
  tally.faults += found ? 1 : 0;
  tally.longest = std::max(tally.longest, trial.longest());
  return found;
}

int fuzzMain(int argc, char** argv, const std::vector<FuzzTarget>& targets) {
  return report::runTool(argc, argv, kUsage,
                         [&targets](const std::vector<std::string>& words) { fuzz(words, targets); });
}

}  // namespace sightline_fuzz
