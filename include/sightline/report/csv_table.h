#pragma once

#include <istream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "sightline/core/model/time.h"

namespace sightline::report {

/// A CSV file with a mistake: "file:line: the mistake, the value, the remedy".
struct CsvError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A CSV file with a header line: comma-separated, no quotes, blank lines ignored.
class CsvTable {
 public:
  /// Reads all of it. The columns may stand in any order; every required one must be there, and none that is
  /// neither required nor optional. `name` is put before the line number in errors. Throws CsvError.
  CsvTable(std::istream& stream, std::string name, const std::vector<std::string>& required,
           const std::vector<std::string>& optional = {});

  /// The same from a file.
  static CsvTable fromFile(const std::string& path, const std::vector<std::string>& required,
                           const std::vector<std::string>& optional = {});

  std::size_t rows() const { return rows_.size(); }
  bool has(const std::string& column) const { return columns_.count(column) > 0; }

  const std::string& text(std::size_t row, const std::string& column) const;

  /// A finite number; `unit` is for the message only. Throws CsvError.
  double number(std::size_t row, const std::string& column, const std::string& unit) const;

  /// A time in seconds, exact to the nanosecond for plain decimals. Throws CsvError.
  core::Time time(std::size_t row, const std::string& column) const;

  /// An error about a row: "file:line: <complaint>".
  CsvError error(std::size_t row, const std::string& complaint) const;

 private:
  struct Row {
    std::size_t line;
    std::vector<std::string> fields;
  };

  void readHeader(const std::string& line, const std::vector<std::string>& required,
                  const std::vector<std::string>& optional);
  CsvError errorAt(std::size_t line, const std::string& complaint) const;

  std::string name_;
  std::map<std::string, std::size_t> columns_;
  std::vector<Row> rows_;
};

}  // namespace sightline::report
