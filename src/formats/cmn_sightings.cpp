#include "sightline/formats/cmn_sightings.h"

#include <optional>
#include <string>
#include <string_view>

#include "sightline/core/model/sphere.h"
#include "sightline/formats/field_text.h"
#include "sightline/report/value_text.h"

namespace sightline::formats {
namespace {

/// "017.357222 E" [rad]; west and south are negative.
std::optional<double> coordinate(const std::string& text, char positive, char negative) {
  const auto parts = fieldsOf(text, ' ');
  if (parts.size() != 2 || parts[1].size() != 1 || (parts[1][0] != positive && parts[1][0] != negative))
    return std::nullopt;
  const auto number = report::numberFrom(parts[0]);
  if (!number) return std::nullopt;
  return (parts[1][0] == negative ? -*number : *number) * core::kDegree;
}

class CmnReader {
 public:
  CmnReader(const TextFile& file, const ImportOptions& options)
      : file_(file), builder_("CMN", file, options) {}

  Recording read() {
    for (line_ = 1; line_ <= file_.lines(); ++line_) {
      const std::string text(file_.line(line_));
      if (text.empty()) continue;
      const std::size_t colon = text.find(':');
      if (colon != std::string::npos)
        readHead(text.substr(0, colon), std::string(trimmed(text.substr(colon + 1))));
      else
        readSighting(text);
    }
    return builder_.finish();
  }

 private:
  void readHead(const std::string& name, const std::string& value) {
    if (name == "Station_Code") station_code_ = value;
    if (name == "Long") longitude_ = required(coordinate(value, 'E', 'W'), name, value, "017.357222 E");
    if (name == "Lati") latitude_ = required(coordinate(value, 'N', 'S'), name, value, "045.819722 N");
    if (name != "Height") return;
    const auto parts = fieldsOf(value, ' ');
    const bool is_height = parts.size() == 2 && parts[1] == "m";
    height_ = required(is_height ? report::numberFrom(parts[0]) : std::nullopt, name, value, "0135 m");
  }

  double required(const std::optional<double>& number, const std::string& name, const std::string& value,
                  const std::string& example) const {
    if (number) return *number;
    throw file_.error(line_, name + ": expected for instance \"" + example + "\", got \"" + value + "\"");
  }

  void readSighting(const std::string& text) {
    if (sensor_.empty()) {
      sensor_ = builder_.sensorOr(station_code_, line_);
      if (longitude_ && latitude_ && height_)
        builder_.setStation(sensor_, {*latitude_, *longitude_, *height_});
    }
    const auto fields = fieldsOf(text, ' ');
    const auto time = julianTime(fields.front());
    if (fields.size() < 3 || !time) {
      throw file_.error(line_, "expected a Julian date, right ascension and declination in degrees, got \"" +
                                   text + "\": is the line complete?");
    }
    const auto right_ascension = report::numberFrom(fields[1]), declination = report::numberFrom(fields[2]);
    if (!right_ascension || !declination || !(*right_ascension >= 0.0 && *right_ascension <= 360.0) ||
        !(*declination >= -90.0 && *declination <= 90.0)) {
      throw file_.error(line_,
                        "expected right ascension (0 to 360) and declination (-90 to 90) in degrees, got \"" +
                            fields[1] + "\" and \"" + fields[2] + "\"");
    }
    FileSighting sighting;
    sighting.angles =
        builder_.fromStars(line_, *time, sensor_,
                           {*right_ascension * core::kDegree, *declination * core::kDegree}, Equinox::j2000);
    builder_.add(line_, *time, sensor_, sighting);
  }

  const TextFile& file_;
  RecordingBuilder builder_;
  std::size_t line_ = 0;
  std::string station_code_, sensor_;
  std::optional<double> longitude_, latitude_, height_;
};

}  // namespace

bool isCmn(const TextFile& file) {
  bool has_code = false, has_longitude = false, has_latitude = false;
  for (std::size_t line = 1; line <= file.lines() && line <= 20; ++line) {
    const std::string_view text = file.line(line);
    has_code = has_code || text.substr(0, 13) == "Station_Code:";
    has_longitude = has_longitude || text.substr(0, 5) == "Long:";
    has_latitude = has_latitude || text.substr(0, 5) == "Lati:";
  }
  return has_code && has_longitude && has_latitude;
}

Recording readCmn(const TextFile& file, const ImportOptions& options) {
  return CmnReader(file, options).read();
}

}  // namespace sightline::formats
