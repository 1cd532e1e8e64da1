#include "sightline/formats/observer_reports.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <regex>
#include <string>
#include <string_view>

#include "sightline/core/model/sphere.h"
#include "sightline/formats/field_text.h"
#include "sightline/report/value_text.h"

namespace sightline::formats {
namespace {

/// How the digits of an angle are packed after its hours or degrees.
enum class Packing { seconds, minutes, decimals };

/// One code of the angles: hours or degrees first, how both are packed, and the unit of the uncertainty.
struct AngleCode {
  bool is_horizontal = false;
  Packing first = Packing::seconds, second = Packing::seconds;
  bool is_refracted = false;

  double uncertaintyUnit() const {  // [rad]
    if (second == Packing::seconds) return core::kDegree / 3600.0;
    return second == Packing::minutes ? core::kDegree / 60.0 : core::kDegree;
  }
};

std::optional<AngleCode> iodCode(char code) {
  using P = Packing;
  static const std::array<AngleCode, 7> codes{{{false, P::seconds, P::seconds, false},
                                               {false, P::minutes, P::minutes, false},
                                               {false, P::minutes, P::decimals, false},
                                               {true, P::seconds, P::seconds, false},
                                               {true, P::minutes, P::minutes, false},
                                               {true, P::decimals, P::decimals, false},
                                               {false, P::seconds, P::decimals, false}}};
  if (code < '1' || code > '7') return std::nullopt;
  return codes.at(static_cast<std::size_t>(code - '1'));
}

std::optional<AngleCode> ukCode(char code) {
  if (code < '1' || code > '9') return std::nullopt;
  if (code <= '3') return iodCode(code);
  const int kind = (code - '1') % 3;
  const Packing packing = kind == 0 ? Packing::seconds : kind == 1 ? Packing::minutes : Packing::decimals;
  return AngleCode{true, packing, packing, code >= '7'};
}

/// Digits as hours or degrees of `lead` digits and what follows; digits that are blank at the end are not
/// known and count as zeros. nullopt when it is no such number.
std::optional<double> unpacked(std::string_view text, std::size_t lead, Packing packing) {
  std::string digits(trimmed(text));
  if (digits.size() < lead || digits.find_first_not_of("0123456789") != std::string::npos)
    return std::nullopt;
  digits.resize(std::max<std::size_t>(digits.size(), lead + 5), '0');
  const auto part = [&](std::size_t begin, std::size_t length) {
    return std::stod(digits.substr(begin, length));
  };
  const auto fraction = [&](std::size_t begin) { return std::stod("0." + digits.substr(begin)); };
  const double whole = part(0, lead);
  if (packing == Packing::decimals) return whole + fraction(lead);
  const double minutes = part(lead, 2);
  if (minutes >= 60.0) return std::nullopt;
  if (packing == Packing::minutes) return whole + (minutes + fraction(lead + 2)) / 60.0;
  const double seconds = part(lead + 2, 2);
  if (seconds >= 60.0) return std::nullopt;
  return whole + (minutes + (seconds + fraction(lead + 4)) / 60.0) / 60.0;
}

/// YYYYMMDDHHMMSS and fractions, of which the seconds may be left out.
std::optional<core::Time> packedTime(std::string_view text) {
  std::string digits(trimmed(text));
  if (digits.size() < 12 || digits.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
  digits.resize(std::max<std::size_t>(digits.size(), 15), '0');
  const auto part = [&](std::size_t begin, std::size_t length) {
    return std::stoi(digits.substr(begin, length));
  };
  const double second = part(12, 2) + std::stod("0." + digits.substr(14));
  return stampOf(part(0, 4), part(4, 2), part(6, 2), part(8, 2), part(10, 2), second);
}

/// A report, cut into its fields.
struct Report {
  std::string object, station, time;
  char code = ' ', epoch = ' ';
  std::string first, second;          // digits; the second one with its sign
  std::optional<double> uncertainty;  // in the unit of the code
};

std::string_view columns(std::string_view line, std::size_t first, std::size_t last) {
  if (line.size() < first) return {};
  return line.substr(first - 1, last - first + 1);
}

std::optional<Report> iodReport(std::string_view line) {
  static const std::regex pattern(R"(.{16}\d{4} [A-Z ] \d{8}.*)");
  if (line.size() > 200 || !std::regex_match(line.begin(), line.end(), pattern)) return std::nullopt;
  Report report;
  report.object = std::string(trimmed(columns(line, 1, 15)));
  report.station = std::string(columns(line, 17, 20));
  report.time = std::string(trimmed(columns(line, 24, 40)));
  const std::string_view codes = columns(line, 45, 46);
  if (!codes.empty()) report.code = codes[0];
  if (codes.size() > 1) report.epoch = codes[1];
  report.first = std::string(trimmed(columns(line, 48, 54)));
  report.second = std::string(trimmed(columns(line, 55, 61)));
  const std::string_view uncertainty = columns(line, 63, 64);
  if (uncertainty.size() == 2 && std::isdigit(static_cast<unsigned char>(uncertainty[0])) != 0 &&
      std::isdigit(static_cast<unsigned char>(uncertainty[1])) != 0 && uncertainty[0] != '0')
    report.uncertainty = (uncertainty[0] - '0') * std::pow(10.0, uncertainty[1] - '0' - 8);
  return report;
}

std::optional<Report> ukReport(std::string_view line) {
  static const std::regex pattern(R"(\d{5}[0-9A-Z]{2}\d{10}\d{6}[\d ]{10}[1-9][\d ]{8}[+\- ]\d[\d ]{0,6}.*)");
  if (line.size() > 200 || !std::regex_match(line.begin(), line.end(), pattern)) return std::nullopt;
  Report report;
  report.object = std::string(columns(line, 1, 7));
  report.station = std::string(columns(line, 8, 11));
  const std::string date(columns(line, 12, 17));
  // The first satellite flew in 1957.
  report.time = (date.substr(0, 2) < "57" ? "20" : "19") + date + std::string(trimmed(columns(line, 18, 27)));
  report.code = columns(line, 34, 34)[0];
  report.first = std::string(trimmed(columns(line, 35, 42)));
  report.second = std::string(trimmed(columns(line, 43, 50)));
  const std::string_view epoch = columns(line, 55, 55);
  if (!epoch.empty()) report.epoch = epoch[0];
  std::string accuracy(trimmed(columns(line, 51, 54)));
  const auto code = ukCode(report.code);
  const bool is_number = !accuracy.empty() && accuracy.find_first_not_of("0123456789") == std::string::npos;
  if (code && is_number) {
    const std::size_t lead = code->second == Packing::seconds ? 3 : code->second == Packing::minutes ? 2 : 1;
    accuracy.resize(std::max(accuracy.size(), lead), '0');
    const double value = std::stod(accuracy.substr(0, lead) + "." + accuracy.substr(lead) + "0");
    if (value > 0.0) report.uncertainty = value;
  }
  return report;
}

using CutLine = std::optional<Report> (*)(std::string_view line);
using FindCode = std::optional<AngleCode> (*)(char code);

class ReportReader {
 public:
  ReportReader(const std::string& format, CutLine cut, FindCode find_code, const TextFile& file,
               const ImportOptions& options)
      : file_(file), cut_(cut), find_code_(find_code), builder_(format, file, options) {}

  Recording read() {
    for (line_ = 1; line_ <= file_.lines(); ++line_) {
      if (file_.line(line_).empty()) continue;
      if (const auto report = cut_(file_.wholeLine(line_)))
        take(*report);
      else
        builder_.count("lines of other text are left out", line_);
    }
    return builder_.finish();
  }

 private:
  void take(const Report& report) {
    if (report.first.empty() || report.second.empty()) {
      builder_.count("reports without angles (brightness, or the state of the station) are left out", line_);
      return;
    }
    const auto code = find_code_(report.code);
    if (!code)
      throw file_.error(line_,
                        std::string("the code of the angles is \"") + report.code + "\", which there is not");
    const auto time = packedTime(report.time);
    if (!time) throw file_.error(line_, "expected a time YYYYMMDDHHMMSSsss, got \"" + report.time + "\"");
    FileSighting sighting;
    sighting.angles = code->is_horizontal ? horizontal(report, *code) : fromStars(report, *code, *time);
    sighting.target = report.object;
    if (report.uncertainty) {
      const double arc = *report.uncertainty * code->uncertaintyUnit();
      sighting.sigma = {arc / std::max(std::cos(sighting.angles.y()), 1e-6), arc};
    }
    builder_.add(line_, *time, report.station, sighting);
  }

  /// Both angles [rad].
  Eigen::Vector2d angles(const Report& report, const AngleCode& code) const {
    const bool has_sign = report.second[0] == '+' || report.second[0] == '-';
    const auto first = unpacked(report.first, code.is_horizontal ? 3 : 2, code.first);
    const auto second = unpacked(report.second.substr(has_sign ? 1 : 0), 2, code.second);
    const double turn = code.is_horizontal ? 360.0 : 24.0;
    if (!first || !second || *first > turn || *second > 90.0) {
      throw file_.error(line_, "angles of code " + std::string(1, report.code) + " cannot be \"" +
                                   report.first + "\" and \"" + report.second +
                                   "\": are the columns where the format has them?");
    }
    const double sign = report.second[0] == '-' ? -1.0 : 1.0;
    return {*first * (2.0 * core::kPi / turn), sign * *second * core::kDegree};
  }

  Eigen::Vector2d horizontal(const Report& report, const AngleCode& code) {
    const Eigen::Vector2d both = angles(report, code);
    if (code.is_refracted) builder_.count("elevations are as refracted by the air", line_);
    return {fromCompass(both.x()), both.y()};
  }

  Eigen::Vector2d fromStars(const Report& report, const AngleCode& code, core::Time time) {
    return builder_.fromStars(line_, time, report.station, angles(report, code), equinoxOf(report));
  }

  Equinox equinoxOf(const Report& report) const {
    if (report.epoch == '5') return Equinox::j2000;
    if (report.epoch == '4') return Equinox::b1950;
    if (report.epoch == '0' || report.epoch == ' ') return Equinox::of_date;
    throw file_.error(line_, std::string("the code of the equinox is \"") + report.epoch +
                                 "\": expected 0 (of date), 4 (1950) or 5 (2000); convert the position");
  }

  const TextFile& file_;
  CutLine cut_;
  FindCode find_code_;
  RecordingBuilder builder_;
  std::size_t line_ = 0;
};

bool hasReport(const TextFile& file, CutLine cut) {
  for (std::size_t line = 1; line <= file.lines() && line <= 2000; ++line) {
    if (cut(file.wholeLine(line))) return true;
  }
  return false;
}

}  // namespace

bool isIod(const TextFile& file) {
  return hasReport(file, iodReport);
}

bool isUk(const TextFile& file) {
  return hasReport(file, ukReport);
}

Recording readIod(const TextFile& file, const ImportOptions& options) {
  return ReportReader("IOD report", iodReport, iodCode, file, options).read();
}

Recording readUk(const TextFile& file, const ImportOptions& options) {
  return ReportReader("UK report", ukReport, ukCode, file, options).read();
}

}  // namespace sightline::formats
