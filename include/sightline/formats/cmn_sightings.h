#pragma once

#include "sightline/formats/recording.h"

/// Sightings of the Croatian Meteor Network.
namespace sightline::formats {

bool isCmn(const TextFile& file);

/// A head (Station_Code, Long, Lati, Height) and lines of Julian date (UTC), right ascension and declination
/// [degrees, J2000] and magnitude. Throws FormatError.
Recording readCmn(const TextFile& file, const ImportOptions& options);

}  // namespace sightline::formats
