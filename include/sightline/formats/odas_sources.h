#pragma once

#include "sightline/formats/recording.h"

/// Sound sources of ODAS (Open embeddeD Audition System): its JSON of tracked or potential sources.
namespace sightline::formats {

bool isOdas(const TextFile& file);

/// A stream of objects {"timeStamp": hop, "src": [{"id", "x", "y", "z", "activity"}]}; the time is the number
/// of the hop over ImportOptions::frame_rate. A source with id 0, or at (0, 0, 0), is an empty place: none.
/// Directions are in the axes of the array. Throws FormatError.
Recording readOdas(const TextFile& file, const ImportOptions& options);

}  // namespace sightline::formats
