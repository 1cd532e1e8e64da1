#include "sightline/formats/csv_columns.h"

#include <algorithm>
#include <set>
#include <string_view>
#include <utility>

#include "sightline/formats/field_text.h"
#include "sightline/report/value_text.h"

namespace sightline::formats {
namespace {

/// What a column can be, in the order of this package's own tables.
const std::vector<std::string>& meanings() {
  static const std::vector<std::string> all{
      "time", "sensor", "azimuth", "elevation", "sigma_azimuth", "sigma_elevation", "scan", "target", "snr"};
  return all;
}

bool isAngle(const std::string& what) {
  return what == "azimuth" || what == "elevation" || what == "sigma_azimuth" || what == "sigma_elevation";
}

std::string listed(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) {
    if (all.size() > 400) return all + ", ...";
    all += (all.empty() ? "" : ", ") + name;
  }
  return all;
}

bool containsAny(const std::string& name, const std::vector<std::string>& parts) {
  return std::any_of(parts.begin(), parts.end(),
                     [&](const std::string& part) { return name.find(part) != std::string::npos; });
}

/// A column that may be meant, for the example in an error only.
std::string likely(const std::string& what, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const std::string lower = lowerCase(name);
    const bool is_error = containsAny(lower, {"err", "sig", "std", "unc"});
    const bool is_azimuth = containsAny(lower, {"az", "bearing", "doa", "heading"});
    const bool is_elevation = !is_azimuth && containsAny(lower, {"el", "alt"});
    if (what == "time" && containsAny(lower, {"time", "date", "epoch", "stamp", "utc"})) return name;
    if (what == "sensor" && containsAny(lower, {"sensor", "cam", "station", "site"})) return name;
    if (what == "azimuth" && is_azimuth && !is_error) return name;
    if (what == "elevation" && is_elevation && !is_error) return name;
  }
  return "";
}

/// How --columns would look for this table.
std::string exampleFor(const std::vector<std::string>& names) {
  std::string example;
  for (const std::string what : {"time", "sensor", "azimuth", "elevation"}) {
    std::string name = likely(what, names);
    if (name.empty() && what == "sensor") continue;
    if (name.empty()) name = "COLUMN";
    example += (example.empty() ? "" : ",") + what + "=" + name;
    if (what == "azimuth") example += ":deg:compass";
    if (what == "elevation") example += ":deg";
  }
  return "--columns " + example;
}

/// One WHAT=COLUMN[:UNIT[:CONVENTION]]; the column's name may hold colons of its own.
struct Assignment {
  std::string what, column, unit, convention;
};

FormatError badColumns(const std::string& text, const std::string& why) {
  return FormatError(
      "--columns: " + why + ", got \"" + text +
      "\" (write for instance --columns time=utc:iso,azimuth=az_deg:deg:compass,elevation=alt:deg)");
}

bool isUnit(const std::string& what, const std::string& unit) {
  if (isAngle(what)) return angleUnit(unit).has_value();
  static const std::set<std::string> times{"s", "ms", "us", "ns", "iso", "jd"};
  return what == "time" && times.count(unit) > 0;
}

bool isConvention(const std::string& what, const std::string& convention) {
  if (what == "azimuth") return convention == "compass" || convention == "math";
  return what == "sigma_azimuth" && convention == "arc";
}

Assignment assignmentOf(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) throw badColumns(text, "expected WHAT=COLUMN[:UNIT[:CONVENTION]]");
  Assignment assignment{std::string(trimmed(text.substr(0, equals))),
                        std::string(trimmed(text.substr(equals + 1))), "", ""};
  const auto& all = meanings();
  if (std::find(all.begin(), all.end(), assignment.what) == all.end())
    throw badColumns(text, "a column is one of " + listed(all));
  std::vector<std::string> parts = fieldsOf(assignment.column, ':');
  const auto take = [&](std::string& into, bool (*is_one)(const std::string&, const std::string&)) {
    if (parts.size() < 2 || !is_one(assignment.what, lowerCase(parts.back()))) return;
    into = lowerCase(parts.back());
    parts.pop_back();
  };
  take(assignment.convention, isConvention);
  take(assignment.unit, isUnit);
  assignment.column = parts.front();
  for (std::size_t i = 1; i < parts.size(); ++i) assignment.column += ":" + parts[i];
  return assignment;
}

std::vector<Assignment> assignmentsOf(const std::string& columns) {
  std::vector<Assignment> all;
  std::set<std::string> seen;
  if (trimmed(columns).empty()) return all;
  for (const std::string& text : fieldsOf(columns, ',')) {
    all.push_back(assignmentOf(text));
    if (!seen.insert(all.back().what).second) throw badColumns(text, all.back().what + " stands twice");
  }
  return all;
}

/// Whether the fields of a line begin with a value rather than with the name of a column.
bool isData(const std::vector<std::string>& fields) {
  if (fields.empty()) return false;
  std::string first = fields.front();
  std::replace(first.begin(), first.end(), ',', '.');
  return report::numberFrom(first).has_value() || isoTime(first).has_value();
}

/// Names from the header, from a commented header right above the rows, or the numbers of the columns.
void readNames(const TextFile& file, std::size_t line, CsvLayout& layout) {
  layout.names = fieldsOf(file.line(line), layout.separator);
  layout.first_row = line + 1;
  if (!isData(layout.names)) return;
  const std::size_t columns = layout.names.size();
  layout.first_row = line;
  for (std::size_t above = line - 1; above > 0; --above) {
    std::string_view text = file.line(above);
    if (text.empty()) continue;
    text.remove_prefix(std::min(text.find_first_not_of("#%/ \t"), text.size()));
    std::vector<std::string> names = fieldsOf(text, layout.separator);
    if (names.size() != columns || columns < 2) break;
    layout.names = std::move(names);
    return;
  }
  for (std::size_t i = 0; i < columns; ++i) layout.names[i] = "#" + std::to_string(i + 1);
}

std::size_t placeOf(const TextFile& file, std::size_t line, const CsvLayout& layout,
                    const std::string& column) {
  const auto found = std::find(layout.names.begin(), layout.names.end(), column);
  if (found != layout.names.end()) return static_cast<std::size_t>(found - layout.names.begin());
  if (column.size() > 1 && column[0] == '#') {
    const auto number = report::numberFrom(column.substr(1));
    if (number && *number >= 1.0 && *number <= static_cast<double>(layout.names.size()))
      return static_cast<std::size_t>(*number) - 1;
  }
  std::string complaint =
      "--columns: there is no column \"" + column + "\"; there are " + listed(layout.names);
  if (column.find(':') != std::string::npos) {
    complaint += "; if \"" + column.substr(column.rfind(':') + 1) +
                 "\" is meant as a unit or convention: times have s, ms, us, ns, iso, jd; angles deg, rad, "
                 "mrad, arcmin, arcsec; "
                 "azimuths compass (clockwise from north) or math (counter-clockwise from x or east); "
                 "sigma_azimuth arc";
  }
  throw file.error(line, complaint);
}

void checkAngles(const TextFile& file, std::size_t line, const CsvLayout& layout) {
  for (const auto& [what, column] : layout.columns) {
    if (!isAngle(what) || !column.is_told) continue;
    if (column.unit.empty()) {
      throw file.error(line, "--columns: the unit of " + what + " is not said: write " + what + "=" +
                                 column.name + ":deg" + (what == "azimuth" ? ":compass" : "") +
                                 ", or rad, mrad, arcmin, arcsec");
    }
    if (what == "azimuth" && column.convention.empty()) {
      throw file.error(line,
                       "--columns: azimuth=" + column.name + ":" + column.unit +
                           ": say whether it is clockwise from north or counter-clockwise from x (east): add "
                           ":compass or :math");
    }
  }
}

void checkComplete(const TextFile& file, std::size_t line, const CsvLayout& layout,
                   const ImportOptions& options) {
  for (const std::string what : {"time", "azimuth"}) {
    if (layout.has(what)) continue;
    throw file.error(line, "column \"" + what + "\" is missing; there are " + listed(layout.names) +
                               ": say which column it is, for instance " + exampleFor(layout.names));
  }
  if (!layout.has("elevation") && !options.elevation) {
    if (!likely("elevation", layout.names).empty()) {
      throw file.error(line, "column \"elevation\" is missing; there are " + listed(layout.names) +
                                 ": say which column it is, for instance " + exampleFor(layout.names));
    }
    throw file.error(
        line,
        "there is no column of elevations: state what is known of them with --elevation 0deg and --sigma "
        "AZIMUTH,ELEVATION, for instance --sigma 0.06deg,20deg");
  }
}

}  // namespace

bool isCsvComment(std::string_view line) {
  return line.empty() || line.front() == '#' || line.front() == '%' || line.substr(0, 2) == "//";
}

std::size_t csvHeaderLine(const TextFile& file) {
  for (std::size_t line = 1; line <= file.lines(); ++line) {
    if (!isCsvComment(file.line(line))) return line;
  }
  return 0;
}

char separatorOf(std::string_view line) {
  for (const char separator : {'\t', ';', ',', '|'}) {
    if (line.find(separator) != std::string_view::npos) return separator;
  }
  return ' ';
}

CsvLayout csvLayoutOf(const TextFile& file, const ImportOptions& options) {
  const std::size_t line = csvHeaderLine(file);
  if (line == 0) throw file.error(0, "there is no header line in this table");
  CsvLayout layout;
  layout.separator = options.separator != 0 ? options.separator : separatorOf(file.line(line));
  readNames(file, line, layout);
  std::set<std::string> names;
  for (const std::string& name : layout.names) {
    if (!name.empty() && !names.insert(name).second)
      throw file.error(line, "column \"" + name + "\" stands twice in the header");
  }
  std::set<std::string> told;  // columns
  for (const Assignment& one : assignmentsOf(options.columns)) {
    const std::size_t place = placeOf(file, line, layout, one.column);
    layout.columns[one.what] = {place, layout.names[place], one.unit, one.convention, true};
    told.insert(layout.names[place]);
  }
  for (std::size_t place = 0; place < layout.names.size(); ++place) {
    const std::string& name = layout.names[place];
    const auto& all = meanings();
    if (std::find(all.begin(), all.end(), name) == all.end() || layout.has(name) || told.count(name) > 0)
      continue;
    layout.columns[name] = {place, name, "", "", false};
  }
  checkComplete(file, line, layout, options);
  checkAngles(file, line, layout);
  return layout;
}

}  // namespace sightline::formats
