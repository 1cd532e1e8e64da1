#pragma once

#include <string>
#include <vector>

#include <sightline/SightingArray.h>

#include "sightline/formats/import_options.h"
#include "sightline/formats/recording.h"

namespace sightline_ros {

/// The scans of a recording in `frame`; where that is empty, in frames named as the sensors where their
/// stations are known, and in `platform_enu` otherwise. Names of sensors that no topic can be made of are
/// changed; `renamed` gets a line for each. Throws std::runtime_error for a time that a bag cannot hold, or
/// stations that only some sensors have.
std::vector<sightline::SightingArray> scansOf(const sightline::formats::Recording& recording,
                                              const std::string& frame, std::vector<std::string>& renamed);

/// Runs import_sightings: files to a bag. Returns what was understood and written, a line each.
std::string importSightings(const std::vector<std::string>& files, const std::string& bag,
                            const sightline::formats::ImportOptions& options, const std::string& frame);

/// Runs import_sightings --truth: files to a truth that `evaluate` reads.
std::string importTruth(const std::vector<std::string>& files, const std::string& csv,
                        const sightline::formats::ImportOptions& options);

}  // namespace sightline_ros
