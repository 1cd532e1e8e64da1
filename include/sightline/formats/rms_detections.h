#pragma once

#include "sightline/formats/recording.h"

/// FTPdetectinfo files of RMS (Raspberry Pi Meteor Station, Global Meteor Network) and CAMS.
namespace sightline::formats {

bool isRmsDetections(const TextFile& file);

/// Meteors with their picks: frame, column, row, right ascension, declination, azimuth (degrees clockwise
/// from north), elevation. The time is that in the name of the image file, plus frame / fps. Meteors that are
/// not calibrated are left out; when all are, the file is refused. Throws FormatError.
Recording readRmsDetections(const TextFile& file, const ImportOptions& options);

}  // namespace sightline::formats
