#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fuzz/fuzz_targets.h"

namespace sightline_fuzz {

/// What came of a target's cases.
struct Tally {
  std::uint64_t cases = 0, calls = 0, refusals = 0, faults = 0;
  double longest = 0.0;  ///< call [s]
};

/// Runs the case of that number and returns the fault that it shows; nullopt when it shows none.
std::optional<std::string> runCase(const FuzzTarget& target, std::uint64_t number, Tally& tally);

/// The program: cases of all targets in turn for some seconds, or one.
int fuzzMain(int argc, char** argv, const std::vector<FuzzTarget>& targets);

}  // namespace sightline_fuzz
