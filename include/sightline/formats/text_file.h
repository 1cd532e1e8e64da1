#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace sightline::formats {

/// A file that cannot be imported: "file:line: what is wrong, the value, the remedy".
struct FormatError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

inline constexpr std::size_t kLargestFile = std::size_t{256} << 20;  ///< [bytes]
inline constexpr std::size_t kLongestLine = std::size_t{64} << 10;   ///< [bytes]

/// A text file in memory, by lines.
class TextFile {
 public:
  /// Throws FormatError for a file that cannot be read, is larger than kLargestFile, or is no text in UTF-8.
  static TextFile fromFile(const std::string& path);

  /// `name` is put before the line number in errors.
  TextFile(std::string name, std::string text);

  const std::string& name() const { return name_; }
  const std::string& text() const { return text_; }
  std::size_t lines() const { return begins_.size(); }

  /// Line `number`, from 1, without its end and without blanks around it. Throws FormatError for one longer
  /// than kLongestLine.
  std::string_view line(std::size_t number) const;

  /// The same with the blanks before it: for formats of fixed columns.
  std::string_view wholeLine(std::size_t number) const;

  /// The line on which a byte of the text stands, from 1.
  std::size_t lineOf(std::size_t byte) const;

  /// An error about a line, or about the whole file (line 0).
  FormatError error(std::size_t line, const std::string& complaint) const;

 private:
  std::string name_, text_;
  std::vector<std::size_t> begins_;  // of the lines, in the text
};

}  // namespace sightline::formats
