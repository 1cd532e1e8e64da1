#pragma once

#include "sightline/formats/recording.h"

/// Reports of satellites by visual observers, of fixed columns: the IOD format and the UK (RGO, OTWG) format.
/// Lines of other text, as in a letter, are left out and counted.
namespace sightline::formats {

bool isIod(const TextFile& file);
bool isUk(const TextFile& file);

/// IOD: station (columns 17-20), time (24-40, UTC), code of the angles and of the equinox (45, 46), angles
/// (48-54, 55-61), their uncertainty (63-64, mantissa and exponent less 8). UK: the same in columns 8-11,
/// 12-27, 34, 55, 35-42, 43-50, 51-54. Angles are right ascension and declination, of date, B1950 or J2000,
/// or azimuth clockwise from north and elevation. Throws FormatError.
Recording readIod(const TextFile& file, const ImportOptions& options);
Recording readUk(const TextFile& file, const ImportOptions& options);

}  // namespace sightline::formats
