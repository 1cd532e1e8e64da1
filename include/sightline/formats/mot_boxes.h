#pragma once

#include "sightline/formats/recording.h"

/// Boxes of targets in images, as MOTChallenge writes them.
namespace sightline::formats {

bool isMotBoxes(const TextFile& file);

/// Fields: frame (from 1), id, left, top, width, height [pixels, the first is 1], confidence, and more that
/// is not used. The middle of each box becomes a direction by ImportOptions::camera, or by field of view and
/// image size of an undistorted image: x along the axis, y left, z up. Frames without a box saw nothing.
/// Throws FormatError.
Recording readMotBoxes(const TextFile& file, const ImportOptions& options);

}  // namespace sightline::formats
