#include "sightline/formats/text_file.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <utility>

#include "sightline/formats/field_text.h"

namespace sightline::formats {
namespace {

bool startsWith(const std::string& text, const std::string& start) {
  return text.compare(0, start.size(), start) == 0;
}

}  // namespace

TextFile TextFile::fromFile(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw FormatError(path + ": is a folder: name the files in it");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw FormatError(path + ": cannot be opened (does it exist, and may it be read?)");
  const auto size = std::filesystem::file_size(path, ignored);
  if (!ignored && size > kLargestFile) {
    throw FormatError(path + ": has " + std::to_string(size >> 20) + " MiB, more than the " +
                      std::to_string(kLargestFile >> 20) + " MiB that are read at once: split it");
  }
  // A pipe has no size: it is read up to the limit.
  std::string text(ignored ? kLargestFile : static_cast<std::size_t>(size), ' ');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return TextFile(path, std::move(text));
}

TextFile::TextFile(std::string name, std::string text) : name_(std::move(name)), text_(std::move(text)) {
  if (startsWith(text_, "\xFF\xFE") || startsWith(text_, "\xFE\xFF"))
    throw error(1, "is written in UTF-16: save it in UTF-8");
  if (startsWith(text_, "#ROSBAG")) throw error(0, "is a bag already: replay and doctor read it as it is");
  if (startsWith(text_, "\xEF\xBB\xBF")) text_.erase(0, 3);
  const std::size_t zero = text_.find('\0');
  if (zero != std::string::npos) throw error(0, "is no text file: byte " + std::to_string(zero) + " is zero");
  for (std::size_t begin = 0; begin < text_.size();) {
    begins_.push_back(begin);
    const std::size_t end = text_.find('\n', begin);
    begin = end == std::string::npos ? text_.size() : end + 1;
  }
}

std::string_view TextFile::wholeLine(std::size_t number) const {
  const std::size_t begin = begins_.at(number - 1);
  const std::size_t end = number < begins_.size() ? begins_[number] : text_.size();
  if (end - begin > kLongestLine) {
    throw error(number, "has " + std::to_string(end - begin) + " bytes, more than the " +
                            std::to_string(kLongestLine) + " of a line: is this a text file?");
  }
  std::string_view line(text_.data() + begin, end - begin);
  while (!line.empty() && (line.back() == '\n' || line.back() == '\r')) line.remove_suffix(1);
  return line;
}

std::string_view TextFile::line(std::size_t number) const {
  return trimmed(wholeLine(number));
}

std::size_t TextFile::lineOf(std::size_t byte) const {
  return static_cast<std::size_t>(std::upper_bound(begins_.begin(), begins_.end(), byte) - begins_.begin());
}

FormatError TextFile::error(std::size_t line, const std::string& complaint) const {
  return FormatError(name_ + (line > 0 ? ":" + std::to_string(line) : "") + ": " + complaint);
}

}  // namespace sightline::formats
