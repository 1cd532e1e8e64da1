#include "sightline/formats/star_coordinates.h"

#include <cmath>
#include <cstdint>
#include <erfa.h>

#include "sightline/core/model/sphere.h"

namespace sightline::formats {
namespace {

/// UTC as ERFA counts it: days, of which one with a leap second is longer.
struct JulianDate {
  double day = 0.0, fraction = 0.0;
};

std::optional<JulianDate> julianDateOf(core::Time time) {
  constexpr std::int64_t day = 86400LL * 1000000000LL;
  const std::int64_t since = time.time_since_epoch().count();
  std::int64_t days = since / day, rest = since % day;
  if (rest < 0) {
    rest += day;
    --days;
  }
  int year = 0, month = 0, day_of_month = 0;
  double fraction = 0.0;
  if (eraJd2cal(2440587.5, static_cast<double>(days), &year, &month, &day_of_month, &fraction) != 0)
    return std::nullopt;
  const std::int64_t minutes = rest / 60000000000LL;
  JulianDate date;
  if (eraDtf2d("UTC", year, month, day_of_month, static_cast<int>(minutes / 60),
               static_cast<int>(minutes % 60), static_cast<double>(rest % 60000000000LL) * 1e-9, &date.day,
               &date.fraction) < 0)
    return std::nullopt;
  return date;
}

Eigen::Vector2d counterClockwise(double compass, double elevation) {
  return {core::wrapAngle(0.5 * core::kPi - compass), elevation};
}

/// From the catalogue's place through aberration, precession, nutation and the earth's rotation.
std::optional<Eigen::Vector2d> fromCatalogue(const Eigen::Vector2d& place, const JulianDate& utc,
                                             const Station& station, double ut1_minus_utc) {
  double azimuth = 0.0, zenith = 0.0, hour_angle = 0.0, declination = 0.0, right_ascension = 0.0,
         origins = 0.0;
  const int status =
      eraAtco13(place.x(), place.y(), 0.0, 0.0, 0.0, 0.0, utc.day, utc.fraction, ut1_minus_utc,
                station.longitude, station.latitude, station.height, 0.0, 0.0, 0.0, 0.0, 0.0, 0.55, &azimuth,
                &zenith, &hour_angle, &declination, &right_ascension, &origins);
  if (status < 0) return std::nullopt;
  return counterClockwise(azimuth, 0.5 * core::kPi - zenith);
}

/// From the apparent place: the hour angle is apparent sidereal time less right ascension.
std::optional<Eigen::Vector2d> fromApparent(const Eigen::Vector2d& place, const JulianDate& utc,
                                            const Station& station, double ut1_minus_utc) {
  double ut1[2], tai[2], tt[2];
  if (eraUtcut1(utc.day, utc.fraction, ut1_minus_utc, &ut1[0], &ut1[1]) < 0) return std::nullopt;
  if (eraUtctai(utc.day, utc.fraction, &tai[0], &tai[1]) < 0) return std::nullopt;
  eraTaitt(tai[0], tai[1], &tt[0], &tt[1]);
  const double sidereal = eraGst06a(ut1[0], ut1[1], tt[0], tt[1]) + station.longitude;
  double azimuth = 0.0, elevation = 0.0;
  eraHd2ae(sidereal - place.x(), place.y(), station.latitude, &azimuth, &elevation);
  return counterClockwise(azimuth, elevation);
}

}  // namespace

std::optional<Eigen::Vector2d> horizontalOf(const Eigen::Vector2d& right_ascension_declination,
                                            Equinox equinox, core::Time time, const Station& station,
                                            double ut1_minus_utc) {
  const auto date = julianDateOf(time);
  if (!date) return std::nullopt;
  const JulianDate& utc = *date;
  switch (equinox) {
    case Equinox::of_date:
      return fromApparent(right_ascension_declination, utc, station, ut1_minus_utc);
    case Equinox::b1950: {
      Eigen::Vector2d place;
      eraFk45z(right_ascension_declination.x(), right_ascension_declination.y(),
               eraEpb(utc.day, utc.fraction), &place.x(), &place.y());
      return fromCatalogue(place, utc, station, ut1_minus_utc);
    }
    default:
      return fromCatalogue(right_ascension_declination, utc, station, ut1_minus_utc);
  }
}

}  // namespace sightline::formats
