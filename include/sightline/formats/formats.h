#pragma once

#include <string>
#include <vector>

#include "sightline/formats/recording.h"

namespace sightline::formats {

/// One format: how it is recognised, and its reader.
struct Format {
  std::string name;         ///< of the option --format
  std::string description;  ///< in a few words
  bool (*recognises)(const TextFile& file);
  Recording (*read)(const TextFile& file, const ImportOptions& options);
};

/// All formats, in the order in which they are tried.
const std::vector<Format>& formats();

/// Reads a file in the format of its content, or in the one of the options. Throws FormatError.
Recording readRecording(const TextFile& file, const ImportOptions& options);
Recording readRecording(const std::string& path, const ImportOptions& options);

/// The recording as a truth that `evaluate` reads: time,target,sensor,azimuth,elevation. Sightings without a
/// target are one target's.
std::string truthCsv(const Recording& recording);

}  // namespace sightline::formats
