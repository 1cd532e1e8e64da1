#include "sightline/formats/krakensdr_bearings.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "sightline/core/model/sphere.h"
#include "sightline/formats/field_text.h"
#include "sightline/report/value_text.h"

namespace sightline::formats {
namespace {

constexpr std::size_t kSpectrum = 360, kLeastColumns = 7, kStationFields = 17;
constexpr double kPeakTolerance = 2.5;  // [deg]: spectrum and bearing are rounded to whole degrees

bool isArrangement(const std::string& text) {
  return text == "UCA" || text == "ULA" || text == "Custom" || text == "CUSTOM";
}

/// Angle of the highest value of the spectrum [deg]; nullopt when it is flat or has two peaks alike.
std::optional<double> peakOf(const std::vector<std::string>& fields) {
  if (fields.size() < kLeastColumns + kSpectrum) return std::nullopt;
  std::vector<double> values;
  for (std::size_t i = fields.size() - kSpectrum; i < fields.size(); ++i) {
    const auto value = report::numberFrom(fields[i]);
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  const auto highest = std::max_element(values.begin(), values.end());
  if (std::count(values.begin(), values.end(), *highest) != 1) return std::nullopt;
  return static_cast<double>(highest - values.begin());
}

/// Size of the difference of two angles [deg].
double apart(double a, double b) {
  return std::abs(core::wrapAngle((a - b) * core::kDegree)) / core::kDegree;
}

class KrakenReader {
 public:
  KrakenReader(const TextFile& file, const ImportOptions& options)
      : file_(file), options_(options), builder_("KrakenSDR", file, options) {}

  Recording read() {
    if (!options_.elevation) {
      throw file_.error(
          0,
          "a direction finder sees azimuths alone: state what is known of elevations with --elevation 0deg "
          "and --sigma AZIMUTH,ELEVATION, for instance --sigma 3deg,20deg");
    }
    findConventions();
    for (line_ = 1; line_ <= file_.lines(); ++line_) {
      if (!file_.line(line_).empty()) readRow(fieldsAt(line_));
    }
    describe();
    return builder_.finish();
  }

 private:
  std::vector<std::string> fieldsAt(std::size_t line) const {
    std::vector<std::string> fields = fieldsOf(file_.line(line), ',');
    while (!fields.empty() && fields.back().empty()) fields.pop_back();
    if (fields.size() < kLeastColumns || !isArrangement(fields[5])) {
      throw file_.error(
          line,
          "expected epoch, bearing, confidence, power, frequency, arrangement (UCA, ULA or Custom) and "
          "latency: is the line complete?");
    }
    return fields;
  }

  /// Which way bearings turn, and whether headings are known, is the same in the whole file.
  void findConventions() {
    std::size_t same = 0, opposite = 0;
    for (std::size_t line = 1; line <= file_.lines(); ++line) {
      if (file_.line(line).empty()) continue;
      const auto fields = fieldsAt(line);
      const auto bearing = report::numberFrom(fields[1]);
      if (const auto peak = peakOf(fields);
          peak && bearing && apart(*bearing, -*bearing) > 2.0 * kPeakTolerance) {
        same += apart(*bearing, *peak) <= kPeakTolerance ? 1 : 0;
        opposite += apart(-*bearing, *peak) <= kPeakTolerance ? 1 : 0;
      }
      const auto heading = headingOf(fields);
      has_heading_ = has_heading_ || (heading && *heading != 0.0);
    }
    is_clockwise_ = opposite > same;
  }

  /// The heading of the array that the row names as the main one [deg].
  static std::optional<double> headingOf(const std::vector<std::string>& fields) {
    if (fields.size() < kStationFields) return std::nullopt;
    return report::numberFrom(fields[lowerCase(fields[12]) == "compass" ? 11 : 10]);
  }

  void readRow(const std::vector<std::string>& fields) {
    const auto time = decimalTime(fields[0], -3);
    if (!time || *time < core::timeOf(0) + core::durationOf(1e8)) {
      throw file_.error(line_, "epoch: expected milliseconds since 1970 (13 digits), got \"" + fields[0] +
                                   "\"; are these seconds?");
    }
    const auto bearing = report::numberFrom(fields[1]), confidence = report::numberFrom(fields[2]);
    if (!bearing || !(*bearing >= -360.0 && *bearing <= 360.0))
      throw file_.error(line_, "bearing: expected degrees, 0 to 360, got \"" + fields[1] + "\"");
    if (!confidence) throw file_.error(line_, "confidence: expected dB, got \"" + fields[2] + "\"");
    const std::string sensor = builder_.sensorOr(fields.size() >= kStationFields ? fields[7] : "", line_);
    notePosition(fields);
    if (options_.least_confidence && *confidence < *options_.least_confidence) {
      builder_.count("bearings below the least confidence are left out: nothing seen", line_);
      builder_.addEmpty(line_, *time, sensor);
      return;
    }
    FileSighting sighting;
    sighting.angles.x() = core::wrapAngle((is_clockwise_ ? -*bearing : *bearing) * core::kDegree);
    if (options_.heading)
      sighting.angles.x() += fromCompass(*options_.heading);
    else if (has_heading_)
      sighting.angles.x() += fromCompass(headingOf(fields).value_or(0.0) * core::kDegree);
    sighting.angles = {core::wrapAngle(sighting.angles.x()), *options_.elevation};
    sighting.snr = std::pow(10.0, *confidence / 20.0);
    sighting.target = fields[4];
    builder_.add(line_, *time, sensor, sighting);
  }

  void notePosition(const std::vector<std::string>& fields) {
    if (fields.size() < kStationFields || positions_.size() > 2) return;
    const auto latitude = report::numberFrom(fields[8]), longitude = report::numberFrom(fields[9]);
    if (latitude && longitude && (*latitude != 0.0 || *longitude != 0.0))
      positions_.insert(fields[8] + "," + fields[9]);
  }

  void describe() {
    builder_.remark(std::string("bearings are ") +
                    (is_clockwise_ ? "clockwise, as the peaks of the spectra show" : "counter-clockwise") +
                    "; confidence [dB] becomes SNR");
    if (options_.heading || has_heading_)
      builder_.remark(std::string("azimuths from east, with the heading ") +
                      (options_.heading ? "as told" : "of the file"));
    else
      builder_.remark(
          "azimuths from the axis of the array: its heading is not in the file (--heading 90deg, from "
          "north)");
    if (positions_.size() == 1) {
      builder_.remark("position in the file, without height: " + *positions_.begin() +
                      "; --station NAME=LAT,LON,HEIGHT puts it into tf");
    } else if (positions_.size() > 1) {
      builder_.remark("the station moves: its positions are not used");
    }
  }

  const TextFile& file_;
  const ImportOptions& options_;
  RecordingBuilder builder_;
  std::size_t line_ = 0;
  bool is_clockwise_ = false, has_heading_ = false;
  std::set<std::string> positions_;
};

}  // namespace

bool isKrakenSdr(const TextFile& file) {
  for (std::size_t line = 1; line <= file.lines(); ++line) {
    if (file.line(line).empty()) continue;
    const auto fields = fieldsOf(file.line(line), ',');
    return fields.size() >= kLeastColumns && report::numberFrom(fields[0]) && isArrangement(fields[5]);
  }
  return false;
}

Recording readKrakenSdr(const TextFile& file, const ImportOptions& options) {
  return KrakenReader(file, options).read();
}

}  // namespace sightline::formats
