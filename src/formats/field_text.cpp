#include "sightline/formats/field_text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <erfa.h>
#include <limits>
#include <regex>

#include "sightline/core/model/sphere.h"
#include "sightline/report/value_text.h"

namespace sightline::formats {
namespace {

constexpr std::int64_t kSecond = 1000000000;  // [ns]
constexpr std::int64_t kDay = 86400;          // [s]

bool isBlank(char letter) {
  return letter == ' ' || letter == '\t' || letter == '\r' || letter == '\n';
}

/// Days from 1970-01-01 to a date of the Gregorian calendar, counted in years that begin with March.
std::int64_t daysTo(int year, int month, int day) {
  const std::int64_t y = year - (month <= 2 ? 1 : 0);
  const std::int64_t era = (y >= 0 ? y : y - 399) / 400;
  const std::int64_t year_of_era = y - era * 400;
  const std::int64_t day_of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
  return era * 146097 + year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year - 719468;
}

bool isLeap(int year) {
  return (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
}

int daysOf(int year, int month) {
  static constexpr std::array<int, 12> days{31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  return days.at(static_cast<std::size_t>(month - 1)) + (month == 2 && isLeap(year) ? 1 : 0);
}

/// The date of a day after 1970-01-01.
void dateOf(std::int64_t days, int& year, int& month, int& day) {
  year = 1970 + static_cast<int>(std::floor(static_cast<double>(days) / 365.2425));
  while (daysTo(year, 1, 1) > days) --year;
  while (daysTo(year + 1, 1, 1) <= days) ++year;
  month = 12;
  while (daysTo(year, month, 1) > days) --month;
  day = static_cast<int>(days - daysTo(year, month, 1)) + 1;
}

int integer(const std::csub_match& text) {
  return std::stoi(text.str());
}

const std::regex& isoPattern() {
  static const std::regex pattern(
      R"((\d{4})-(?:(\d{2})-(\d{2})|(\d{3}))(?:T| +)(\d{2}):(\d{2})(?::(\d{2})(?:[.,](\d*))?)?\s*(Z|z|UTC|[+-]\d{2}:?\d{2})?)");
  return pattern;
}

bool matchesIso(std::string_view text, std::cmatch& match) {
  text = trimmed(text);
  return text.size() < 64 && std::regex_match(text.data(), text.data() + text.size(), match, isoPattern());
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && isBlank(text.front())) text.remove_prefix(1);
  while (!text.empty() && isBlank(text.back())) text.remove_suffix(1);
  return text;
}

std::vector<std::string> fieldsOf(std::string_view line, char separator) {
  std::vector<std::string> fields;
  const bool by_blanks = separator == ' ';
  std::string field;
  bool is_quoted = false, was_quoted = false, is_open = !by_blanks;
  const auto close = [&] {
    fields.push_back(was_quoted ? field : std::string(trimmed(field)));
    field.clear();
    was_quoted = false;
  };
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char letter = line[i];
    if (is_quoted) {
      if (letter != '"') {
        field += letter;
      } else if (i + 1 < line.size() && line[i + 1] == '"') {
        field += '"';
        ++i;
      } else {
        is_quoted = false;
      }
    } else if (letter == '"' && trimmed(field).empty() && !was_quoted) {
      field.clear();
      is_quoted = was_quoted = is_open = true;
    } else if (by_blanks && isBlank(letter)) {
      if (is_open) close();
      is_open = false;
    } else if (!by_blanks && letter == separator) {
      close();
    } else if (!was_quoted || !isBlank(letter)) {
      field += letter;
      is_open = true;
    }
  }
  if (is_open) close();
  return fields;
}

std::string lowerCase(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return lower;
}

std::optional<core::Time> stampOf(int year, int month, int day, int hour, int minute, double second) {
  if (year < 1700 || year > 2200 || month < 1 || month > 12 || day < 1 || day > daysOf(year, month))
    return std::nullopt;
  if (hour < 0 || hour > 23 || minute < 0 || minute > 59 || !(second >= 0.0 && second < 61.0))
    return std::nullopt;
  const std::int64_t whole =
      daysTo(year, month, day) * kDay + hour * std::int64_t{3600} + minute * std::int64_t{60};
  return core::timeOf(whole * kSecond + std::llround(second * 1e9));
}

std::optional<core::Time> isoTime(std::string_view text) {
  std::cmatch match;
  if (!matchesIso(text, match)) return std::nullopt;
  const int year = integer(match[1]);
  int month = 1, day = 1, day_of_year = 0;
  if (match[4].matched) {
    day_of_year = integer(match[4]) - 1;
    if (day_of_year < 0 || day_of_year >= (isLeap(year) ? 366 : 365)) return std::nullopt;
  } else {
    month = integer(match[2]);
    day = integer(match[3]);
  }
  const int second = match[7].matched ? integer(match[7]) : 0;
  const auto whole = stampOf(year, month, day, integer(match[5]), integer(match[6]), second);
  if (!whole) return std::nullopt;
  std::string fraction = match[8].str().substr(0, 9);
  fraction.resize(9, '0');
  core::Time time = *whole + core::Duration(std::stoll(fraction) + day_of_year * kDay * kSecond);
  const std::string zone = match[9].str();
  if (!zone.empty() && (zone[0] == '+' || zone[0] == '-')) {
    const std::int64_t shift =
        std::stoll(zone.substr(1, 2)) * 3600 + std::stoll(zone.substr(zone.size() - 2)) * 60;
    time -= core::Duration((zone[0] == '-' ? -shift : shift) * kSecond);
  }
  return time;
}

bool namesZone(std::string_view iso_time) {
  std::cmatch match;
  return matchesIso(iso_time, match) && match[9].matched;
}

std::optional<core::Time> decimalTime(std::string_view text, int exponent) {
  static const std::regex pattern(R"(([+-]?)(\d{1,19})(?:\.(\d*))?)");
  text = trimmed(text);
  std::cmatch match;
  if (text.size() > 64) return std::nullopt;
  if (!std::regex_match(text.data(), text.data() + text.size(), match, pattern)) {
    const auto number = report::numberFrom(std::string(text));  // 1.7e9
    if (!number || std::abs(*number) * std::pow(10.0, exponent) > 9e9) return std::nullopt;
    return core::timeOf(std::llround(*number * std::pow(10.0, 9 + exponent)));
  }
  const int kept = 9 + exponent;  // digits of the fraction
  const auto digits = static_cast<std::size_t>(kept);
  std::string fraction = match[3].str().substr(0, digits);
  fraction.resize(digits, '0');
  const std::string all = match[2].str() + fraction;
  const std::size_t first = std::min(all.find_first_not_of('0'), all.size() - 1);
  if (all.size() - first > 18 && std::stold(all) > 9e18L) return std::nullopt;
  const std::int64_t nanoseconds = std::stoll(all.substr(first));
  return core::timeOf(match[1].str() == "-" ? -nanoseconds : nanoseconds);
}

std::optional<core::Time> julianTime(std::string_view text) {
  static const std::regex pattern(R"((\d{7})(\.\d*)?)");
  text = trimmed(text);
  std::cmatch match;
  if (text.size() > 64 || !std::regex_match(text.data(), text.data() + text.size(), match, pattern))
    return std::nullopt;
  const std::int64_t half_days =
      2 * std::stoll(match[1].str()) - 4881175;  // since 1970-01-01T00 (JD 2440587.5)
  if (std::abs(half_days) > 200000) return std::nullopt;
  const double fraction = match[2].length() > 1 ? std::stod("0" + match[2].str()) : 0.0;
  return core::timeOf(half_days * (kDay / 2) * kSecond +
                      std::llround(fraction * static_cast<double>(kDay * kSecond)));
}

std::optional<double> angleUnit(std::string_view unit) {
  const std::string name = lowerCase(trimmed(unit));
  if (name == "rad") return 1.0;
  if (name == "mrad") return 1e-3;
  if (name == "deg") return core::kDegree;
  if (name == "arcmin") return core::kDegree / 60.0;
  if (name == "arcsec") return core::kDegree / 3600.0;
  return std::nullopt;
}

std::optional<double> angleWithUnit(std::string_view text) {
  text = trimmed(text);
  std::size_t end = text.size();
  while (end > 0 && std::isalpha(static_cast<unsigned char>(text[end - 1])) != 0) --end;
  const auto unit = angleUnit(text.substr(end));
  const auto number = report::numberFrom(std::string(trimmed(text.substr(0, end))));
  if (!unit || !number) return std::nullopt;
  return *number * *unit;
}

std::string isoText(core::Time time) {
  const std::int64_t since = time.time_since_epoch().count();
  std::int64_t seconds = since / kSecond, fraction = since % kSecond;
  if (fraction < 0) {
    fraction += kSecond;
    --seconds;
  }
  std::int64_t days = seconds / kDay, rest = seconds % kDay;
  if (rest < 0) {
    rest += kDay;
    --days;
  }
  int year = 0, month = 0, day = 0;
  dateOf(days, year, month, day);
  char text[64];
  std::snprintf(text, sizeof text, "%04d-%02d-%02dT%02d:%02d:%02d.%03dZ", year, month, day,
                static_cast<int>(rest / 3600), static_cast<int>(rest / 60 % 60), static_cast<int>(rest % 60),
                static_cast<int>(fraction / 1000000));
  return text;
}

std::optional<core::Time> utcOf(core::Time in_system, const std::string& system) {
  if (system == "UTC") return in_system;
  core::Time tai = in_system;
  if (system == "GPS")
    tai += core::durationOf(19.0);
  else if (system == "TT")
    tai -= core::durationOf(32.184);
  else if (system != "TAI")
    return std::nullopt;
  // Twice, as the difference is tabled by UTC.
  core::Time utc = tai;
  for (int i = 0; i < 2; ++i) {
    const double second = core::seconds(utc - core::Time{});
    const auto days = static_cast<std::int64_t>(std::floor(second / static_cast<double>(kDay)));
    int year = 0, month = 0, day = 0;
    dateOf(days, year, month, day);
    double difference = 0.0;  // TAI - UTC [s]
    if (eraDat(year, month, day, second / static_cast<double>(kDay) - static_cast<double>(days),
               &difference) < 0)
      return std::nullopt;
    utc = tai - core::durationOf(difference);
  }
  return utc;
}

}  // namespace sightline::formats
