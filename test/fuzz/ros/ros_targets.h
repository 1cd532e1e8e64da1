#pragma once

#include <vector>

#include "fuzz/fuzz_targets.h"

namespace sightline_fuzz {

void fuzzAdapterFields(RandomInput& input, Trial& trial);
void fuzzAdapterMessages(RandomInput& input, Trial& trial);
void fuzzConfigurations(RandomInput& input, Trial& trial);
void fuzzRecordings(RandomInput& input, Trial& trial);

/// Those of the ROS layer: what drivers send, configurations, recordings. None needs a master.
const std::vector<FuzzTarget>& rosTargets();

}  // namespace sightline_fuzz
