#include "sightline/formats/rms_detections.h"

#include <cmath>
#include <optional>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/core/model/sphere.h"
#include "sightline/formats/field_text.h"
#include "sightline/report/value_text.h"

namespace sightline::formats {
namespace {

bool isRule(std::string_view text) {
  return text.size() >= 20 && text.find_first_not_of('-') == std::string_view::npos;
}

/// When the first frame of an image file was taken: FF_CODE_20180101_183012_345_0000256.fits, with milli- or
/// microseconds.
std::optional<core::Time> timeOfImage(const std::string& name) {
  static const std::regex pattern(
      R"(.*?(\d{4})(\d{2})(\d{2})_(\d{2})(\d{2})(\d{2})_(\d{3}|\d{6})(?:_.*|\..*|))");
  std::smatch match;
  if (name.size() > 200 || !std::regex_match(name, match, pattern)) return std::nullopt;
  const auto whole = stampOf(std::stoi(match[1]), std::stoi(match[2]), std::stoi(match[3]),
                             std::stoi(match[4]), std::stoi(match[5]), std::stoi(match[6]));
  if (!whole) return std::nullopt;
  std::string fraction = match[7];
  fraction.resize(9, '0');
  return *whole + core::Duration(std::stoll(fraction));
}

class RmsReader {
 public:
  RmsReader(const TextFile& file, const ImportOptions& options)
      : file_(file), builder_("RMS FTPdetectinfo", file, options) {}

  Recording read() {
    line_ = headEnd();
    while (line_ <= file_.lines()) {
      if (file_.line(line_).empty() || isRule(file_.line(line_)))
        ++line_;
      else
        readMeteor();
    }
    if (builder_.sightings() == 0 && uncalibrated_ > 0) {
      throw file_.error(first_uncalibrated_,
                        "all " + std::to_string(uncalibrated_) +
                            " meteors are uncalibrated, their azimuths and elevations are zeros: "
                            "calibrate them with RMS (a platepar) first");
    }
    if (uncalibrated_ > 0) {
      builder_.remark(std::to_string(uncalibrated_) +
                      " uncalibrated meteors are left out, the first on line " +
                      std::to_string(first_uncalibrated_));
    }
    builder_.remark("azimuths clockwise from north; times of the image files plus frame / fps");
    return builder_.finish();
  }

 private:
  /// First line below the head, whose last line names the columns of the picks.
  std::size_t headEnd() const {
    for (std::size_t line = 1; line <= file_.lines(); ++line) {
      if (file_.line(line).substr(0, 12) == "Per segment:") return line + 1;
    }
    throw file_.error(
        0, "there is no line \"Per segment: Frame# Col Row RA Dec Azim Elev\": the file is not complete");
  }

  std::string next(const std::string& expected) {
    if (line_ > file_.lines())
      throw file_.error(file_.lines(), "ends before " + expected + ": it is not complete");
    return std::string(file_.line(line_++));
  }

  void readMeteor() {
    const std::size_t first = line_;
    const std::string image = next("the name of an image file");
    const std::string calibration = next("a line on the calibration");
    const auto head = fieldsOf(next("a meteor's line of camera, number, segments and fps"), ' ');
    const auto segments = head.size() < 4 ? std::nullopt : report::numberFrom(head[2]);
    const auto fps = head.size() < 4 ? std::nullopt : report::numberFrom(head[3]);
    if (!segments || !fps || !(*segments >= 0.0 && *segments <= 1e6) || !(*fps > 0.0)) {
      throw file_.error(line_ - 1,
                        "expected camera, number of the meteor, number of picks and frames a second, got \"" +
                            std::string(file_.line(line_ - 1)) + "\"");
    }
    const auto begin = timeOfImage(image);
    if (!begin) {
      throw file_.error(
          first, "\"" + image +
                     "\" has no time in it: expected FF_CODE_YYYYMMDD_HHMMSS_mmm_FRAME, from which the "
                     "times of the picks are taken");
    }
    const bool is_calibrated = calibration.find("ncalibrated") == std::string::npos;
    if (!is_calibrated && uncalibrated_++ == 0) first_uncalibrated_ = first + 1;
    ++meteors_;
    std::size_t picks = 0;
    for (; line_ <= file_.lines() && !isRule(file_.line(line_)); ++line_) {
      if (file_.line(line_).empty()) continue;
      ++picks;
      if (is_calibrated) readPick(*begin, *fps, builder_.sensorOr(head[0], line_));
    }
    if (picks < static_cast<std::size_t>(*segments)) {
      // RMS leaves out picks that are not numbers, but not all of them at the end of the file.
      if (line_ > file_.lines() && picks == 0)
        throw file_.error(file_.lines(), "ends before the picks of a meteor: it is not complete");
      builder_.count("meteors with fewer picks than their line says", first);
    }
  }

  void readPick(core::Time begin, double fps, const std::string& sensor) {
    const std::string text(file_.line(line_));
    if (lowerCase(text).find("nan") != std::string::npos) {
      builder_.count("picks with NaN are left out", line_);
      return;
    }
    const auto fields = fieldsOf(text, ' ');
    std::vector<double> numbers;
    for (std::size_t i = 0; i < 7 && i < fields.size(); ++i) {
      const auto number = report::numberFrom(fields[i]);
      if (!number) break;
      numbers.push_back(*number);
    }
    if (numbers.size() < 7) {
      throw file_.error(
          line_, "expected frame, column, row, right ascension, declination, azimuth and elevation, got \"" +
                     text + "\": is the line complete?");
    }
    if (!(numbers[5] >= -360.0 && numbers[5] <= 360.0) || !(numbers[6] >= -90.0 && numbers[6] <= 90.0)) {
      throw file_.error(line_, "azimuth " + fields[5] + " and elevation " + fields[6] +
                                   " are no degrees of a direction: is this an FTPdetectinfo of RMS?");
    }
    FileSighting sighting;
    sighting.angles = {fromCompass(numbers[5] * core::kDegree), numbers[6] * core::kDegree};
    sighting.target = std::to_string(meteors_);
    builder_.add(line_, begin + core::durationOf(numbers[0] / fps), sensor, sighting);
  }

  const TextFile& file_;
  RecordingBuilder builder_;
  std::size_t line_ = 1, meteors_ = 0, uncalibrated_ = 0, first_uncalibrated_ = 0;
};

}  // namespace

bool isRmsDetections(const TextFile& file) {
  return file.lines() > 0 && file.line(1).substr(0, 12) == "Meteor Count";
}

Recording readRmsDetections(const TextFile& file, const ImportOptions& options) {
  return RmsReader(file, options).read();
}

}  // namespace sightline::formats
