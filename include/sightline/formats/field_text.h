#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/core/model/time.h"

/// Times, angles and fields as files write them.
namespace sightline::formats {

/// Without blanks around it.
std::string_view trimmed(std::string_view text);

/// The fields of a line, trimmed; quotes around a field keep separators in it. A blank as separator stands
/// for any number of blanks and tabs.
std::vector<std::string> fieldsOf(std::string_view line, char separator);

std::string lowerCase(std::string_view text);

/// The stamp of a date and time of day (UTC) in the Gregorian calendar; nullopt for no such day or hour.
/// Second 60 (a leap second) is the first second of the next minute.
std::optional<core::Time> stampOf(int year, int month, int day, int hour, int minute, double second);

/// 2014-11-25T15:21:15.386, also with a blank for the T, with a day of the year for month and day, without
/// seconds, and with Z, UTC, +02:00 or +0200 at the end. Without a zone it is UTC.
std::optional<core::Time> isoTime(std::string_view text);

/// Whether an ISO time names its zone.
bool namesZone(std::string_view iso_time);

/// A plain decimal in units of 10^exponent seconds (0 = s, -3 = ms), to the nanosecond: no detour over
/// double.
std::optional<core::Time> decimalTime(std::string_view text, int exponent);

/// A Julian date in days.
std::optional<core::Time> julianTime(std::string_view text);

/// An angle with its unit, "0.05deg", "3 mrad", "1e-3rad", "20arcsec", "5arcmin" [rad]; nullopt without a
/// unit.
std::optional<double> angleWithUnit(std::string_view text);

/// Radians in one of deg, rad, mrad, arcmin, arcsec; nullopt for another unit.
std::optional<double> angleUnit(std::string_view unit);

/// A stamp as 2014-11-25T15:21:15.386Z.
std::string isoText(core::Time time);

/// UTC of an instant in another time system: UTC, TAI, GPS or TT; nullopt for another one.
std::optional<core::Time> utcOf(core::Time in_system, const std::string& system);

}  // namespace sightline::formats
