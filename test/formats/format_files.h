#pragma once

#include <functional>
#include <string>

#include "sightline/core/model/sphere.h"
#include "sightline/formats/formats.h"

#include "support/paths.h"

/// Samples of the formats, and what is said of bad ones.
namespace sightline::test {

inline constexpr double kDegree = core::kDegree;

inline std::string sample(const std::string& name) {
  return sourceDirectory() + "/test/formats/data/" + name;
}

/// The text of a sample with a part replaced.
inline std::string changed(const std::string& name, const std::string& from, const std::string& to) {
  std::string text = formats::TextFile::fromFile(sample(name)).text();
  return text.replace(text.find(from), from.size(), to);
}

inline formats::ImportOptions withSigma() {
  formats::ImportOptions options;
  options.sigma = Eigen::Vector2d(0.001, 0.002);
  return options;
}

/// Reads by content a file called "file".
inline formats::Recording read(const std::string& text, const formats::ImportOptions& options = {}) {
  return formats::readRecording(formats::TextFile("file", text), options);
}

/// The words of a refusal; empty when there is none.
inline std::string refusal(const std::function<void()>& what) {
  try {
    what();
  } catch (const std::exception& problem) {
    return problem.what();
  }
  return "";
}

inline std::string refusalOf(const std::string& text, const formats::ImportOptions& options = {}) {
  return refusal([&] { read(text, options); });
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

inline std::string remarksOf(const formats::Recording& recording) {
  std::string all;
  for (const std::string& remark : recording.remarks) all += remark + "\n";
  return all;
}

inline std::string timeOf(const formats::FileScan& scan) {
  return std::to_string(scan.time.time_since_epoch().count());
}

inline std::size_t sightingsOf(const formats::Recording& recording) {
  std::size_t all = 0;
  for (const formats::FileScan& scan : recording.scans) all += scan.sightings.size();
  return all;
}

/// Angle between two directions [rad].
inline double apart(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return core::angleBetween(core::directionOf(a), core::directionOf(b));
}

}  // namespace sightline::test
