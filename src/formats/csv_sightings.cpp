#include "sightline/formats/csv_sightings.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sightline/core/model/angle_range.h"
#include "sightline/core/model/sphere.h"
#include "sightline/formats/csv_columns.h"
#include "sightline/formats/field_text.h"
#include "sightline/report/value_text.h"

namespace sightline::formats {
namespace {

/// Units of numbers that are times, by their size: seconds since 1970 have ten digits before the point since
/// 2001.
constexpr double kMostSeconds = 9e9, kMostMillis = 1e14, kMostMicros = 1e17;

const char* nameOf(char separator) {
  switch (separator) {
    case '\t':
      return "tabs";
    case ' ':
      return "blanks";
    case ';':
      return "semicolons";
    case '|':
      return "bars";
    default:
      return "commas";
  }
}

bool saysNothing(const std::string& field) {
  static const std::set<std::string> words{"", "-", "--", "nan", "none", "null", "na", "n/a"};
  return words.count(lowerCase(field)) > 0;
}

class CsvReader {
 public:
  CsvReader(const TextFile& file, const ImportOptions& options)
      : file_(file), options_(options), layout_(csvLayoutOf(file, options)), builder_("CSV", file, options) {}

  Recording read() {
    for (line_ = layout_.first_row; line_ <= file_.lines(); ++line_) {
      const std::string_view text = file_.line(line_);
      if (isCsvComment(text)) continue;
      // Blanks at the ends are fields where tabs separate.
      fields_ = fieldsOf(layout_.separator == '\t' ? file_.wholeLine(line_) : text, layout_.separator);
      if (fields_.size() != layout_.names.size()) {
        throw file_.error(line_, "expected " + std::to_string(layout_.names.size()) + " fields between " +
                                     nameOf(layout_.separator) + ", got " + std::to_string(fields_.size()) +
                                     ": is the row complete? Another separator is said with --separator");
      }
      readRow();
    }
    describe();
    return builder_.finish();
  }

 private:
  bool has(const std::string& what) const { return layout_.has(what); }
  const CsvColumn& column(const std::string& what) const { return layout_.columns.at(what); }
  const std::string& text(const std::string& what) const { return fields_[column(what).place]; }

  /// The field with a point for a decimal comma.
  std::string plain(const std::string& what) {
    std::string value = text(what);
    const bool may_be_comma = options_.decimal_comma.value_or(layout_.separator != ',');
    if (!may_be_comma || std::count(value.begin(), value.end(), ',') != 1 ||
        value.find('.') != std::string::npos)
      return value;
    std::replace(value.begin(), value.end(), ',', '.');
    if (!saw_decimal_comma_) builder_.remark("decimal commas");
    saw_decimal_comma_ = true;
    return value;
  }

  double number(const std::string& what, const std::string& unit) {
    if (const auto value = report::numberFrom(plain(what))) return *value;
    throw file_.error(
        line_, column(what).name + ": expected a finite number [" + unit + "], got \"" + text(what) + "\"");
  }

  /// An angle in its column's unit [rad].
  double angle(const std::string& what) {
    const std::string unit = column(what).unit.empty() ? "rad" : column(what).unit;
    return number(what, unit) * *angleUnit(unit);
  }

  core::Time time() {
    std::string& unit = layout_.columns.at("time").unit;
    if (unit.empty()) unit = unitOfTimes();
    std::optional<core::Time> time;
    const std::string value = unit == "iso" ? text("time") : plain("time");
    if (unit == "iso") {
      time = isoTime(value);
      if (time && !namesZone(value) && !is_zone_said_) {
        builder_.remark("times without a zone are UTC");
        is_zone_said_ = true;
      }
    } else if (unit == "jd") {
      time = julianTime(value);
    } else {
      time = decimalTime(value, unit == "ms" ? -3 : unit == "us" ? -6 : unit == "ns" ? -9 : 0);
      if (time && std::abs(core::seconds(*time - core::Time{})) > kMostSeconds) time = std::nullopt;
    }
    if (time) return *time;
    throw file_.error(line_, column("time").name + ": expected a time in the unit " + unit + ", got \"" +
                                 text("time") + "\" (say another unit with --columns time=" +
                                 column("time").name + ":s, or ms, us, ns, iso, jd)");
  }

  /// What the first time of the file looks like.
  std::string unitOfTimes() {
    if (isoTime(text("time"))) return "iso";
    const double size = std::abs(number("time", "s"));
    if (size <= kMostSeconds) return "s";
    return size < kMostMillis ? "ms" : size < kMostMicros ? "us" : "ns";
  }

  void readRow() {
    const core::Time time = this->time();
    const std::string sensor = builder_.sensorOr(has("sensor") ? text("sensor") : "", line_);
    const std::string scan = has("scan") ? text("scan") : "row " + std::to_string(line_);
    if (has("scan") && scan.empty())
      throw file_.error(line_, "scan: is empty; name the exposure, or leave the column out");
    const bool no_azimuth = saysNothing(text("azimuth"));
    const bool no_elevation = has("elevation") && saysNothing(text("elevation"));
    if (no_azimuth && (no_elevation || !has("elevation"))) {
      builder_.count("rows without angles say that the sensor saw nothing", line_);
      builder_.addEmpty(line_, time, sensor, scan);
      return;
    }
    if (no_azimuth || no_elevation) {
      throw file_.error(line_,
                        std::string(no_azimuth ? "azimuth" : "elevation") +
                            " is empty, the other angle is not: both are empty where the sensor saw nothing");
    }
    if (!has("scan") && !stamps_.insert({sensor, time}).second)
      builder_.count(
          "rows share sensor and time with another row and are scans of their own; if they are one exposure, "
          "say --columns scan=" +
              column("time").name,
          line_);
    builder_.add(line_, time, sensor, sighting(), scan);
  }

  FileSighting sighting() {
    FileSighting sighting;
    sighting.angles.x() = angle("azimuth");
    sighting.angles.y() = has("elevation") ? angle("elevation") : *options_.elevation;
    checkUnit("azimuth", sighting.angles.x(), core::isAzimuth(sighting.angles.x()),
              ":deg:compass, or :deg:math");
    if (has("elevation"))
      checkUnit("elevation", sighting.angles.y(), core::isElevation(sighting.angles.y()), ":deg");
    if (column("azimuth").convention == "compass") sighting.angles.x() = fromCompass(sighting.angles.x());
    if (has("sigma_azimuth")) sighting.sigma.x() = sigma("sigma_azimuth");
    if (has("sigma_elevation")) sighting.sigma.y() = sigma("sigma_elevation");
    if (has("sigma_azimuth") && column("sigma_azimuth").convention == "arc")
      sighting.sigma.x() /= std::max(std::cos(sighting.angles.y()), 1e-6);
    if (has("snr") && !saysNothing(text("snr"))) sighting.snr = number("snr", "1");
    if (has("target")) sighting.target = text("target");
    return sighting;
  }

  double sigma(const std::string& what) { return saysNothing(text(what)) ? kNotSaid : angle(what); }

  void checkUnit(const std::string& what, double angle, bool is_one, const std::string& remedy) const {
    if (is_one) return;
    const CsvColumn& at = column(what);
    throw file_.error(line_, at.name + ": " + text(what) + " is no " + what + " in " +
                                 (at.unit.empty() ? "rad" : at.unit) + " (" + std::to_string(angle) +
                                 " rad): say the unit with --columns " + what + "=" + at.name + remedy);
  }

  void describe() {
    std::string used, extra;
    std::set<std::size_t> places;
    for (const auto& [what, at] : layout_.columns) {
      places.insert(at.place);
      const bool is_angle =
          what != "time" && what != "sensor" && what != "scan" && what != "target" && what != "snr";
      const std::string unit = at.unit.empty() ? (is_angle ? "rad" : "") : at.unit;
      used += (used.empty() ? "" : ", ") + what;
      if (at.name != what) used += " = " + at.name;
      if (!unit.empty()) used += " [" + unit + (at.convention.empty() ? "" : ", " + at.convention) + "]";
    }
    for (std::size_t place = 0; place < layout_.names.size() && extra.size() < 400; ++place) {
      if (places.count(place) == 0) extra += (extra.empty() ? "" : ", ") + layout_.names[place];
    }
    builder_.remark(std::string("fields between ") + nameOf(layout_.separator) + ": " + used);
    if (!extra.empty()) builder_.remark("columns not used: " + extra);
    if (!has("elevation")) builder_.remark("elevation of all sightings as told");
  }

  const TextFile& file_;
  const ImportOptions& options_;
  CsvLayout layout_;
  RecordingBuilder builder_;
  std::size_t line_ = 0;
  std::vector<std::string> fields_;
  std::set<std::pair<std::string, core::Time>> stamps_;
  bool saw_decimal_comma_ = false, is_zone_said_ = false;
};

}  // namespace

bool isCsv(const TextFile& file) {
  const std::size_t line = csvHeaderLine(file);
  return line > 0 && fieldsOf(file.line(line), separatorOf(file.line(line))).size() >= 2;
}

Recording readCsv(const TextFile& file, const ImportOptions& options) {
  return CsvReader(file, options).read();
}

}  // namespace sightline::formats
