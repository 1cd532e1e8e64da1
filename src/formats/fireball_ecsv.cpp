#include "sightline/formats/fireball_ecsv.h"

#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "sightline/core/model/sphere.h"
#include "sightline/formats/field_text.h"
#include "sightline/report/value_text.h"

namespace sightline::formats {
namespace {

const char* const kFormat = "fireball ECSV";
constexpr std::size_t kLongestHeader = std::size_t{1} << 20;  // [bytes]

/// The commented YAML at the top of the file, and the table below it.
struct Ecsv {
  char separator = ' ';
  std::map<std::string, std::string> units;  // by column
  std::map<std::string, std::string> meta;   // scalars
  std::map<std::string, std::size_t> columns;
  std::size_t header_line = 0;
};

void takeMeta(const YAML::Node& map, std::map<std::string, std::string>& meta) {
  for (const auto& entry : map) {
    if (entry.first.IsScalar() && entry.second.IsScalar()) meta[entry.first.Scalar()] = entry.second.Scalar();
  }
}

void readYaml(const TextFile& file, const std::string& text, Ecsv& ecsv) {
  try {
    const YAML::Node header = YAML::Load(text);
    if (const YAML::Node delimiter = header["delimiter"]) {
      if (!delimiter.IsScalar() || delimiter.Scalar().size() != 1)
        throw file.error(1, "delimiter: expected one character, a comma or a blank");
      ecsv.separator = delimiter.Scalar()[0];
    }
    for (const YAML::Node& column : header["datatype"]) {
      if (!column["name"]) throw file.error(1, "datatype: a column has no name");
      if (column["unit"]) ecsv.units[column["name"].as<std::string>()] = column["unit"].as<std::string>();
    }
    const YAML::Node meta = header["meta"];
    if (meta && meta.IsMap()) takeMeta(meta, ecsv.meta);
    if (meta && meta.IsSequence()) {
      for (const YAML::Node& entry : meta) {
        if (entry.IsMap()) takeMeta(entry, ecsv.meta);
      }
    }
  } catch (const YAML::Exception& problem) {
    const std::size_t line = problem.mark.is_null() ? 1 : static_cast<std::size_t>(problem.mark.line) + 1;
    throw file.error(line, "the header of an ECSV file is commented YAML, this is not: " + problem.msg);
  }
}

Ecsv readHeader(const TextFile& file) {
  Ecsv ecsv;
  std::string yaml;
  std::size_t line = 1;
  for (; line <= file.lines(); ++line) {
    const std::string_view text = file.wholeLine(line);
    if (trimmed(text).empty()) {
      yaml += '\n';
      continue;
    }
    if (text.front() != '#') break;
    // "# %ECSV" and "# ---" are YAML's directive and start of a document, which it would take apart
    std::string_view content = text.substr(text.size() > 1 && text[1] == ' ' ? 2 : 1);
    if (!content.empty() && (content.front() == '%' || content.substr(0, 3) == "---")) content = {};
    yaml.append(content).push_back('\n');
    if (yaml.size() > kLongestHeader) throw file.error(line, "the header is longer than a megabyte");
  }
  readYaml(file, yaml, ecsv);
  if (line > file.lines()) throw file.error(0, "ends within the header: it is not complete");
  ecsv.header_line = line;
  for (const std::string& column : fieldsOf(file.line(line), ecsv.separator)) {
    if (!ecsv.columns.emplace(column, ecsv.columns.size()).second)
      throw file.error(line, "column \"" + column + "\" stands twice in the header");
  }
  return ecsv;
}

class EcsvReader {
 public:
  EcsvReader(const TextFile& file, const ImportOptions& options)
      : file_(file), ecsv_(readHeader(file)), builder_(kFormat, file, options) {}

  Recording read() {
    checkColumns();
    sensor_ = builder_.sensorOr(nameOfCamera(), 0);
    readStation();
    for (std::size_t line = ecsv_.header_line + 1; line <= file_.lines(); ++line) {
      const std::string_view text = file_.line(line);
      if (text.empty() || text.front() == '#') continue;
      fields_ = fieldsOf(text, ecsv_.separator);
      if (fields_.size() != ecsv_.columns.size()) {
        throw file_.error(line, "expected " + std::to_string(ecsv_.columns.size()) + " fields, got " +
                                    std::to_string(fields_.size()) + ": is the file complete?");
      }
      readRow(line);
    }
    return builder_.finish();
  }

 private:
  bool has(const std::string& column) const { return ecsv_.columns.count(column) > 0; }

  void checkColumns() const {
    if (!has("datetime"))
      throw file_.error(ecsv_.header_line, "column \"datetime\" is missing in the header");
    if (!isHorizontal() && !(has("ra") && has("dec"))) {
      throw file_.error(
          ecsv_.header_line,
          "there are neither the columns azimuth and altitude nor ra and dec: the picks of this file "
          "have not been calibrated yet");
    }
    for (const std::string column : {"azimuth", "altitude", "ra", "dec"}) {
      const auto unit = ecsv_.units.find(column);
      if (unit != ecsv_.units.end() && unit->second != "deg" && unit->second != "degree")
        throw file_.error(ecsv_.header_line,
                          column + ": expected the unit deg, got \"" + unit->second + "\"");
    }
  }

  bool isHorizontal() const { return has("azimuth") && has("altitude"); }

  std::string meta(const std::string& name) const {
    const auto found = ecsv_.meta.find(name);
    return found != ecsv_.meta.end() ? std::string(trimmed(found->second)) : "";
  }

  std::string nameOfCamera() const {
    for (const char* name : {"telescope", "dfn_camera_codename", "camera_id", "location"}) {
      if (!meta(name).empty()) return meta(name);
    }
    return "";
  }

  std::optional<double> metaNumber(const std::string& name) const {
    const std::string text = meta(name);
    if (text.empty()) return std::nullopt;
    if (const auto number = report::numberFrom(text)) return number;
    throw file_.error(0, name + ": expected a number, got \"" + text + "\"");
  }

  void readStation() {
    const auto latitude = metaNumber("obs_latitude"), longitude = metaNumber("obs_longitude"),
               height = metaNumber("obs_elevation");
    if (!latitude || !longitude || !height) {
      builder_.remark("the position of " + sensor_ +
                      " is not complete in the file (obs_latitude, obs_longitude, "
                      "obs_elevation)");
      return;
    }
    builder_.setStation(sensor_, {*latitude * core::kDegree, *longitude * core::kDegree, *height});
  }

  const std::string& text(const std::string& column) const { return fields_[ecsv_.columns.at(column)]; }

  /// Degrees; nullopt where the field says that there is none.
  std::optional<double> degrees(std::size_t line, const std::string& column) const {
    const std::string value = lowerCase(text(column));
    if (value.empty() || value == "nan" || value == "none" || value == "-" || value == "--")
      return std::nullopt;
    if (const auto number = report::numberFrom(value)) return *number * core::kDegree;
    throw file_.error(line, column + ": expected degrees, got \"" + text(column) + "\"");
  }

  double sigma(std::size_t line, const std::string& column) const {
    if (!has("err_minus_" + column) || !has("err_plus_" + column)) return kNotSaid;
    const auto minus = degrees(line, "err_minus_" + column), plus = degrees(line, "err_plus_" + column);
    if (!minus || !plus) return kNotSaid;
    const double mean = 0.5 * (std::abs(*minus) + std::abs(*plus));
    return mean > 0.0 ? mean : kNotSaid;
  }

  void readRow(std::size_t line) {
    const auto time = isoTime(text("datetime"));
    if (!time)
      throw file_.error(line, "datetime: expected 2014-11-25T15:21:15.386, got \"" + text("datetime") + "\"");
    const std::string first = isHorizontal() ? "azimuth" : "ra", second = isHorizontal() ? "altitude" : "dec";
    const auto a = degrees(line, first), b = degrees(line, second);
    if (!a || !b) {
      builder_.count("picks without " + first + " and " + second + " are left out", line);
      return;
    }
    FileSighting sighting;
    if (isHorizontal()) {
      sighting.angles = {fromCompass(*a), *b};
      sighting.sigma = {sigma(line, "azimuth"), sigma(line, "altitude")};
    } else {
      sighting.angles = builder_.fromStars(line, *time, sensor_, {*a, *b}, Equinox::j2000);
    }
    builder_.add(line, *time, sensor_, sighting);
  }

  const TextFile& file_;
  const Ecsv ecsv_;
  RecordingBuilder builder_;
  std::string sensor_;
  std::vector<std::string> fields_;
};

}  // namespace

bool isFireballEcsv(const TextFile& file) {
  for (std::size_t line = 1; line <= file.lines(); ++line) {
    if (!file.line(line).empty()) return file.line(line).substr(0, 7) == "# %ECSV";
  }
  return false;
}

Recording readFireballEcsv(const TextFile& file, const ImportOptions& options) {
  return EcsvReader(file, options).read();
}

}  // namespace sightline::formats
