#include "sightline/report/csv_table.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <regex>
#include <utility>

#include "sightline/report/value_text.h"

namespace sightline::report {
namespace {

constexpr double kLatestTime = 9e9;  // [s]; nanoseconds in 64 bits end at 9.2e9 s

std::string trimmed(const std::string& text) {
  const char* blank = " \t\r";
  const std::size_t first = text.find_first_not_of(blank);
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(blank) - first + 1);
}

std::vector<std::string> fieldsOf(const std::string& line) {
  std::vector<std::string> fields;
  std::size_t begin = 0;
  for (;;) {
    const std::size_t comma = line.find(',', begin);
    fields.push_back(trimmed(line.substr(begin, comma - begin)));
    if (comma == std::string::npos) return fields;
    begin = comma + 1;
  }
}

std::string joined(const std::vector<std::string>& parts) {
  std::string all;
  for (const std::string& part : parts) all += (all.empty() ? "" : ",") + part;
  return all;
}

/// Seconds as a plain decimal, to the nanosecond without a detour over double. Further digits are cut off.
std::optional<core::Time> plainDecimal(const std::string& text) {
  static const std::regex pattern(R"(([+-]?)(\d{1,10})(?:\.(\d*))?)");
  std::smatch match;
  if (!std::regex_match(text, match, pattern)) return std::nullopt;
  std::string fraction = match[3].str().substr(0, 9);
  fraction.resize(9, '0');
  const std::int64_t nanoseconds = std::stoll(match[2].str()) * 1000000000 + std::stoll(fraction);
  return core::timeOf(match[1].str() == "-" ? -nanoseconds : nanoseconds);
}

}  // namespace

CsvTable::CsvTable(std::istream& stream, std::string name, const std::vector<std::string>& required,
                   const std::vector<std::string>& optional)
    : name_(std::move(name)) {
  std::string text;
  for (std::size_t line = 1; std::getline(stream, text); ++line) {
    if (trimmed(text).empty()) continue;
    if (columns_.empty()) {
      readHeader(text, required, optional);
      continue;
    }
    Row row{line, fieldsOf(text)};
    if (row.fields.size() != columns_.size()) {
      throw errorAt(line, "expected " + std::to_string(columns_.size()) + " fields, got " +
                              std::to_string(row.fields.size()));
    }
    rows_.push_back(std::move(row));
  }
  if (columns_.empty()) throw errorAt(1, "expected a header line: " + joined(required));
}

CsvTable CsvTable::fromFile(const std::string& path, const std::vector<std::string>& required,
                            const std::vector<std::string>& optional) {
  std::ifstream stream(path);
  if (!stream) throw CsvError(path + ": cannot be opened (does it exist, and may it be read?)");
  return CsvTable(stream, path, required, optional);
}

void CsvTable::readHeader(const std::string& line, const std::vector<std::string>& required,
                          const std::vector<std::string>& optional) {
  const std::string byte_order_mark = "\xEF\xBB\xBF";
  const bool marked = line.compare(0, byte_order_mark.size(), byte_order_mark) == 0;
  const std::vector<std::string> columns = fieldsOf(marked ? line.substr(byte_order_mark.size()) : line);
  if (columns.size() == 1 && columns[0].find_first_of(";\t|") != std::string::npos) {
    throw errorAt(1, "the fields of the header \"" + columns[0] +
                         "\" are not between commas: import_sightings reads sightings between others");
  }
  for (const std::string& column : columns) {
    if (!isAmong(required, column) && !isAmong(optional, column)) {
      std::vector<std::string> known = required;
      known.insert(known.end(), optional.begin(), optional.end());
      throw errorAt(1, "unknown column \"" + column + "\" in the header; there are " + joined(known));
    }
    if (!columns_.emplace(column, columns_.size()).second) {
      throw errorAt(1, "column \"" + column + "\" stands twice in the header");
    }
  }
  for (const std::string& column : required) {
    if (!has(column))
      throw errorAt(1, "column \"" + column + "\" is missing in the header; needed are " + joined(required));
  }
}

const std::string& CsvTable::text(std::size_t row, const std::string& column) const {
  return rows_[row].fields[columns_.at(column)];
}

double CsvTable::number(std::size_t row, const std::string& column, const std::string& unit) const {
  if (const auto number = numberFrom(text(row, column))) return *number;
  throw error(row, column + ": expected a finite number [" + unit + "], got \"" + text(row, column) + "\"");
}

core::Time CsvTable::time(std::size_t row, const std::string& column) const {
  const double approximately = number(row, column, "s");
  if (std::abs(approximately) > kLatestTime) {
    throw error(row, column + ": expected seconds, got " + text(row, column) + " (milli- or nanoseconds?)");
  }
  const auto exact = plainDecimal(text(row, column));
  return exact ? *exact : core::Time(core::durationOf(approximately));
}

CsvError CsvTable::error(std::size_t row, const std::string& complaint) const {
  return errorAt(rows_[row].line, complaint);
}

CsvError CsvTable::errorAt(std::size_t line, const std::string& complaint) const {
  return CsvError(name_ + ":" + std::to_string(line) + ": " + complaint);
}

}  // namespace sightline::report
