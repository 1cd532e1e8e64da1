#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/core/model/time.h"
#include "sightline/formats/import_options.h"
#include "sightline/formats/text_file.h"

/// Which columns of a table are what, in which unit and convention.
namespace sightline::formats {

/// A column with what it means.
struct CsvColumn {
  std::size_t place = 0;  ///< in the row, from 0
  std::string name;
  std::string unit;        ///< empty = not told
  std::string convention;  ///< empty = not told
  bool is_told = false;    ///< by --columns, rather than by this package's name
};

/// The layout of a table.
struct CsvLayout {
  char separator = ',';
  std::size_t first_row = 1;                 ///< line of the first row below the header
  std::vector<std::string> names;            ///< of all columns; "#1", "#2" without a header
  std::map<std::string, CsvColumn> columns;  ///< by what they are: time, sensor, azimuth, ...

  bool has(const std::string& what) const { return columns.count(what) > 0; }
};

/// Whether a line is blank or a comment: #, % or // at its start.
bool isCsvComment(std::string_view line);

/// Line of the header: the first that is neither blank nor a comment; 0 when there is none.
std::size_t csvHeaderLine(const TextFile& file);

/// The character that separates the fields of a line: tab, semicolon, comma, bar, or else blank.
char separatorOf(std::string_view line);

/// Finds the columns. Throws FormatError for a column that is missing, twice, or without unit or convention,
/// with the option that says it.
CsvLayout csvLayoutOf(const TextFile& file, const ImportOptions& options);

}  // namespace sightline::formats
