#pragma once

#include "sightline/formats/recording.h"

/// Bearings of a KrakenSDR direction finder, as its software logs and serves them (CSV without a header).
namespace sightline::formats {

bool isKrakenSdr(const TextFile& file);

/// Fields: epoch [ms], bearing [degrees], confidence [dB], power, frequency [Hz], arrangement of the
/// antennas, latency, and in newer versions station, latitude, longitude, headings, and 360 values of the
/// spatial spectrum by counter-clockwise angle. Bearings are counter-clockwise from the array's axis, unless
/// the spectrum's peak shows that they are clockwise. Throws FormatError.
Recording readKrakenSdr(const TextFile& file, const ImportOptions& options);

}  // namespace sightline::formats
