#include "sightline/report/output_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

namespace sightline::report {

namespace fs = std::filesystem;

namespace {

bool isSameFile(const std::string& a, const std::string& b) {
  std::error_code ignored;
  if (fs::equivalent(a, b, ignored)) return true;
  const fs::path full_a = fs::weakly_canonical(a, ignored), full_b = fs::weakly_canonical(b, ignored);
  return !full_a.empty() && full_a == full_b;
}

/// Whether something is there that is written as it is, such as a device or a pipe.
bool isDevice(const std::string& path) {
  std::error_code ignored;
  return fs::exists(path, ignored) && !fs::is_regular_file(path, ignored);
}

/// The file itself, where `path` is a link to it: the link stays.
std::string targetOf(const std::string& path) {
  std::error_code problem;
  const fs::path target =
      fs::is_symlink(path, problem) ? fs::weakly_canonical(path, problem) : fs::path(path);
  return problem ? path : target.string();
}

}  // namespace

OutputError outputError(const std::string& file) {
  return OutputError(file + ": cannot be written" +
                     (errno != 0 ? std::string(": ") + std::strerror(errno) : ""));
}

OutputFile::OutputFile(std::string path, const std::vector<std::string>& inputs)
    : path_(std::move(path)), unfinished_(isDevice(path_) ? path_ : targetOf(path_) + ".unfinished") {
  std::error_code ignored;
  if (path_.empty()) throw OutputError("the name of the output is empty: name a file");
  if (fs::is_directory(path_, ignored)) throw OutputError(path_ + ": cannot be written: it is a folder");
  // Its folder would let it be replaced.
  errno = 0;
  if (fs::is_regular_file(path_, ignored) && !std::ofstream(path_, std::ios::app)) throw outputError(path_);
  for (const std::string& input : inputs) {
    if (input.empty()) continue;
    if (isSameFile(input, path_) || isSameFile(input, unfinished_))
      throw OutputError(input + " cannot be read and written at once: name another output");
  }
}

OutputFile::~OutputFile() {
  if (!is_finished_ && unfinished_ != path_) std::remove(unfinished_.c_str());
}

void OutputFile::finish() {
  if (unfinished_ != path_ && std::rename(unfinished_.c_str(), targetOf(path_).c_str()) != 0)
    throw outputError(path_);
  is_finished_ = true;
}

TextFile::TextFile(const std::string& path, const std::vector<std::string>& inputs) : file_(path, inputs) {
  errno = 0;
  stream_.open(file_.unfinished());
  if (!stream_) throw outputError(path);
}

void TextFile::finish() {
  if (!stream_) {  // once more, for the reason
    stream_.clear();
    errno = 0;
    stream_ << '\n' << std::flush;
    throw outputError(file_.path());
  }
  errno = 0;
  stream_.close();
  if (!stream_) throw outputError(file_.path());
  file_.finish();
}

}  // namespace sightline::report
