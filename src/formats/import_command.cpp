#include "sightline/formats/import_command.h"

#include <optional>

#include "sightline/formats/field_text.h"
#include "sightline/formats/formats.h"
#include "sightline/formats/geodesy.h"
#include "sightline/report/value_text.h"

namespace sightline::formats {
namespace {

using report::CommandLine;
using report::NumberRange;
using report::UsageError;

UsageError mistaken(const std::string& option, const std::string& value, const std::string& example) {
  return UsageError(option + ": cannot be understood: \"" + value + "\" (write for instance " + option + " " +
                    example + ")");
}

/// "2px" [pixels].
std::optional<double> pixels(const std::string& text) {
  if (text.size() < 3 || text.substr(text.size() - 2) != "px") return std::nullopt;
  return report::numberFrom(std::string(trimmed(text.substr(0, text.size() - 2))));
}

void readSigma(const CommandLine& line, ImportOptions& options) {
  if (!line.has("--sigma")) return;
  const std::string text = line.option("--sigma", "");
  if (const auto size = pixels(text); size && *size > 0.0) {
    options.sigma_pixels = *size;
    return;
  }
  options.sigma = anglePairOption(text);
  if (!options.sigma || !(options.sigma->minCoeff() > 0.0)) throw mistaken("--sigma", text, "0.05deg");
}

std::optional<double> angle(const CommandLine& line, const std::string& option, const std::string& example) {
  if (!line.has(option)) return std::nullopt;
  const auto value = angleWithUnit(line.option(option, ""));
  if (!value) throw mistaken(option, line.option(option, ""), example);
  return value;
}

std::optional<double> number(const CommandLine& line, const std::string& option, NumberRange range) {
  if (!line.has(option)) return std::nullopt;
  return line.number(option, 0.0, range);
}

void readStationOptions(const CommandLine& line, ImportOptions& options) {
  if (line.has("--stations")) options.stations = readStations(line.option("--stations", ""));
  for (const std::string& text : line.all("--station")) {
    const auto station = stationOption(text);
    if (!station) {
      throw mistaken("--station", text,
                     "NAME=48.137,11.575,520 (degrees north, degrees east, metres above WGS-84)");
    }
    options.stations[station->first] = station->second;
  }
}

void readTableOptions(const CommandLine& line, ImportOptions& options) {
  options.columns = line.option("--columns", "");
  if (line.has("--separator")) {
    const std::string text = line.option("--separator", "");
    if (text == "tab" || text == "\\t")
      options.separator = '\t';
    else if (text == "blank")
      options.separator = ' ';
    else if (text.size() == 1 && std::string(",;|: \t").find(text) != std::string::npos)
      options.separator = text[0];
    else
      throw mistaken("--separator", text, "\";\" (or , | : tab blank)");
  }
  if (line.has("--decimal")) {
    const std::string text = line.option("--decimal", "");
    if (text != "comma" && text != "point") throw mistaken("--decimal", text, "comma (or point)");
    options.decimal_comma = text == "comma";
  }
}

void readCameraOptions(const CommandLine& line, ImportOptions& options) {
  options.camera = line.option("--camera", "");
  if (line.has("--field-of-view")) {
    const std::string text = line.option("--field-of-view", "");
    options.field_of_view = anglePairOption(text);
    if (!options.field_of_view || !(options.field_of_view->minCoeff() > 0.0) ||
        !(options.field_of_view->maxCoeff() < 3.1))
      throw mistaken("--field-of-view", text, "24deg,19deg");
  }
  if (line.has("--image-size")) {
    options.image_size = imageSizeOption(line.option("--image-size", ""));
    if (!options.image_size) throw mistaken("--image-size", line.option("--image-size", ""), "1920x1080");
  }
  options.frame_rate = number(line, "--frame-rate", NumberRange::above_zero);
}

}  // namespace

const std::vector<std::string>& importOptionNames() {
  static const std::vector<std::string> names{
      "--format",     "--sensor",     "--sigma",     "--elevation", "--heading",         "--station",
      "--stations",   "--columns",    "--separator", "--decimal",   "--camera",          "--field-of-view",
      "--image-size", "--frame-rate", "--offset",    "--ut1-utc",   "--least-confidence"};
  return names;
}

std::string importOptionUsage() {
  std::string known;
  for (const Format& format : formats()) known += (known.empty() ? "" : ", ") + format.name;
  return "  --format NAME           " + known +
         " (default: found by content)\n"
         "  --sensor NAME           name of the sensor, where the file has none\n"
         "  --sigma S[,S]           standard deviation along azimuth and elevation, where the file has none: "
         "0.05deg,\n"
         "                          1mrad, 3deg,20deg; of images also in pixels: 1px\n"
         "  --station [NAME=]LAT,LON,HEIGHT  position of a sensor: degrees north and east, metres above "
         "WGS-84\n"
         "  --stations FILE.csv     the same of several: sensor,latitude_deg,longitude_deg,height_m\n"
         "  --offset SECONDS        is added to all times: a bag cannot hold times up to 0\n"
         "  --ut1-utc SECONDS       UT1 - UTC of the day, for right ascensions (default 0; at most 14 arc "
         "seconds)\n"
         "  tables:\n"
         "  --columns WHAT=COLUMN[:UNIT[:CONVENTION]],...  time (s, ms, us, ns, iso, jd), sensor, azimuth "
         "(deg, rad, mrad,\n"
         "                          arcmin, arcsec; compass or math), elevation, sigma_azimuth (also arc), "
         "sigma_elevation,\n"
         "                          scan, target, snr; a column by its name or #NUMBER\n"
         "  --separator C           , ; | : tab blank (default: found by content)\n"
         "  --decimal comma|point   (default: found by content)\n"
         "  --elevation ANGLE       of all sightings, where there are azimuths alone\n"
         "  images, antenna and microphone arrays:\n"
         "  --camera FILE.yaml      calibration of the camera (camera_info), or\n"
         "  --field-of-view W,H     its field of view, 24deg,19deg, with --image-size 1920x1080\n"
         "  --frame-rate HZ         of files that count frames\n"
         "  --heading ANGLE         compass azimuth of the sensor's forward axis (default: azimuths from "
         "that axis)\n"
         "  --least-confidence C    detections below are left out\n";
}

ImportOptions importOptionsOf(const CommandLine& line) {
  ImportOptions options;
  options.format = line.option("--format", "");
  options.sensor = line.option("--sensor", "");
  readSigma(line, options);
  readStationOptions(line, options);
  readTableOptions(line, options);
  readCameraOptions(line, options);
  options.elevation = angle(line, "--elevation", "0deg");
  options.heading = angle(line, "--heading", "90deg");
  options.least_confidence = number(line, "--least-confidence", NumberRange::any);
  options.ut1_minus_utc = number(line, "--ut1-utc", NumberRange::any);
  if (options.ut1_minus_utc && !(*options.ut1_minus_utc >= -1.0 && *options.ut1_minus_utc <= 1.0))
    throw UsageError("--ut1-utc: expected -1 to 1 s, got \"" + line.option("--ut1-utc", "") + "\"");
  const double offset = line.number("--offset", 0.0);
  if (!(offset >= -9e9 && offset <= 9e9))
    throw UsageError("--offset: expected seconds, got \"" + line.option("--offset", "") + "\"");
  options.offset = core::durationOf(offset);
  return options;
}

}  // namespace sightline::formats
