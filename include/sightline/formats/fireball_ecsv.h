#pragma once

#include "sightline/formats/recording.h"

/// Fireball observations in ECSV (APE 6), as the Desert Fireball Network writes them and as the Global
/// Fireball Exchange format 1.2 has them.
namespace sightline::formats {

bool isFireballEcsv(const TextFile& file);

/// Columns: datetime (UTC), and azimuth (degrees clockwise from north) with altitude, or ra with dec (J2000).
/// Sigmas are the means of err_minus_... and err_plus_... Position of the camera: obs_latitude,
/// obs_longitude, obs_elevation. Throws FormatError.
Recording readFireballEcsv(const TextFile& file, const ImportOptions& options);

}  // namespace sightline::formats
