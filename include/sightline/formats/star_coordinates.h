#pragma once

#include <optional>

#include <Eigen/Core>

#include "sightline/core/model/time.h"
#include "sightline/formats/geodesy.h"

/// Places among the stars as directions at a station (ERFA, the library of the IAU's SOFA standards).
namespace sightline::formats {

/// The equator and equinox that right ascension and declination refer to.
enum class Equinox {
  j2000,   ///< ICRS or the mean equinox J2000.0: they agree to 0.02 arc seconds
  b1950,   ///< FK4, mean equinox B1950.0
  of_date  ///< the true equator and equinox of the time of the sighting
};

/// Azimuth (counter-clockwise from east) and elevation [rad] at the station, without refraction, of a place
/// among the stars: right ascension and declination [rad] as measured against a catalogue (astrometric) for
/// j2000 and b1950, apparent for of_date. Precession, nutation, annual and diurnal aberration; no polar
/// motion. `ut1_minus_utc` [s] is at most 0.9. nullopt for a time that ERFA does not know. (S-132)
std::optional<Eigen::Vector2d> horizontalOf(const Eigen::Vector2d& right_ascension_declination,
                                            Equinox equinox, core::Time time, const Station& station,
                                            double ut1_minus_utc);

}  // namespace sightline::formats
