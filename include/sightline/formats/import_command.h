#pragma once

#include <string>
#include <vector>

#include "sightline/formats/import_options.h"
#include "sightline/report/command_line.h"

namespace sightline::formats {

/// The options of the command line that tell readers what files do not say, with their dashes.
const std::vector<std::string>& importOptionNames();

/// What the usage text says of them, a line each.
std::string importOptionUsage();

/// Reads them. Throws UsageError naming the option, its value and an example, and what readStations throws.
ImportOptions importOptionsOf(const report::CommandLine& line);

}  // namespace sightline::formats
