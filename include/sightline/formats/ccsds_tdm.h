#pragma once

#include "sightline/formats/recording.h"

/// Tracking Data Messages (CCSDS 503.0-B), as key-value text (KVN) and as XML.
namespace sightline::formats {

bool isTdmText(const TextFile& file);
bool isTdmXml(const TextFile& file);

/// Pairs of ANGLE_1 and ANGLE_2 at one epoch [degrees]: azimuth clockwise from north and elevation (AZEL), or
/// right ascension and declination (RADEC in EME2000 or ICRF). CORRECTION_ANGLE_1 and _2 are added where
/// CORRECTIONS_APPLIED is NO. The sensor is the last participant of PATH, the target the one before it. XEYN
/// and XSYE are refused: their angles are those of a mount whose axis lies in the horizon. Throws
/// FormatError.
Recording readTdmText(const TextFile& file, const ImportOptions& options);
Recording readTdmXml(const TextFile& file, const ImportOptions& options);

}  // namespace sightline::formats
