#pragma once

#include "sightline/formats/recording.h"

/// Tables of sightings of any make.
namespace sightline::formats {

/// Whether there is a header line, after blank lines and comments, with several columns.
bool isCsv(const TextFile& file);

/// Columns of this package's names (time, sensor, azimuth, elevation, sigma_azimuth, sigma_elevation, scan,
/// target; seconds and radians) are read as they are; ImportOptions::columns says which others are which, in
/// which unit and convention. A row without azimuth and elevation says that the sensor saw nothing. Throws
/// FormatError.
Recording readCsv(const TextFile& file, const ImportOptions& options);

}  // namespace sightline::formats
