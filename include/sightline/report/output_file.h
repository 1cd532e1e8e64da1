#pragma once

#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace sightline::report {

/// A file could not be written: "file: cannot be written: No space left on device".
struct OutputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The error about `file`, with the reason of the last system call that failed (errno), where there is one.
OutputError outputError(const std::string& file);

/// A file that is complete or not there: it is written as `path().unfinished` beside its place, and `finish`
/// puts it there. Without `finish` it is removed, and what stood in its place before stays. What is no
/// regular file (/dev/stdout, a pipe) is written directly.
class OutputFile {
 public:
  /// Writes nothing yet. `inputs`: files that are read meanwhile (an empty name is none). Throws OutputError
  /// when one of them is this file, under whatever name, or when this is a folder or may not be written.
  explicit OutputFile(std::string path, const std::vector<std::string>& inputs = {});
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  const std::string& path() const { return path_; }

  /// Where to write.
  const std::string& unfinished() const { return unfinished_; }

  /// Puts the file, which is written and closed, in its place. Throws OutputError.
  void finish();

 private:
  std::string path_;
  std::string unfinished_;
  bool is_finished_ = false;
};

/// A text file, complete or not there.
class TextFile {
 public:
  /// Throws OutputError when the file cannot be written.
  explicit TextFile(const std::string& path, const std::vector<std::string>& inputs = {});

  std::ostream& stream() { return stream_; }

  /// Throws OutputError when something could not be written.
  void finish();

 private:
  OutputFile file_;  // outlives its stream
  std::ofstream stream_;
};

}  // namespace sightline::report
