#pragma once

#include <string>

#include "fuzz/random_input.h"

namespace sightline_fuzz {

/// The text with a few changes: bytes, fields and lines changed, cut, doubled and swapped, numbers made
/// absurd.
std::string mutated(RandomInput& input, std::string text);

}  // namespace sightline_fuzz
