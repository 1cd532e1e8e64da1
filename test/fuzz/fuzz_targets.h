#pragma once

#include <string>
#include <vector>

#include "fuzz/random_input.h"
#include "fuzz/trial.h"

namespace sightline_fuzz {

/// One thing that is fuzzed: a case feeds it some tens to hundreds of calls.
struct FuzzTarget {
  std::string name;
  std::string description;  ///< one line
  void (*run)(RandomInput& input, Trial& trial);
};

void fuzzLocalTracker(RandomInput& input, Trial& trial);
void fuzzArrivalOrder(RandomInput& input, Trial& trial);
void fuzzTrackFusion(RandomInput& input, Trial& trial);
void fuzzFusedTrackers(RandomInput& input, Trial& trial);
void fuzzPositionTracker(RandomInput& input, Trial& trial);
void fuzzPositionArrivalOrder(RandomInput& input, Trial& trial);
void fuzzFormats(RandomInput& input, Trial& trial);
void fuzzCsvTables(RandomInput& input, Trial& trial);

/// Those of the core and of the files of other programs.
const std::vector<FuzzTarget>& coreTargets();

}  // namespace sightline_fuzz
