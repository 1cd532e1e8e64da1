#include "sightline/ros/params/param_text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace sightline_ros {

using XmlRpc::XmlRpcValue;

namespace {

/// The shortest text with sign and point in which YAML sees a number, e.g. 1.0e-03.
std::string withSignAndPoint(double value) {
  char text[64];
  for (int digits = 1; digits <= 17; ++digits) {
    std::snprintf(text, sizeof(text), "%.*e", digits, value);
    if (std::strtod(text, nullptr) == value) break;
  }
  return text;
}

/// Number of single-letter edits between two words (Levenshtein).
std::size_t editsBetween(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

}  // namespace

std::string shortestText(double value) {
  const int digits_before_point =
      std::abs(value) >= 1.0 && std::isfinite(value) ? 1 + static_cast<int>(std::log10(std::abs(value))) : 1;
  char text[64];
  for (int digits = std::min(digits_before_point, 15); digits <= 17; ++digits) {
    std::snprintf(text, sizeof(text), "%.*g", digits, value);
    if (std::strtod(text, nullptr) == value) break;
  }
  return text;
}

std::string quoted(const std::string& text) {
  return '"' + text + '"';
}

std::string joined(const std::vector<std::string>& parts, const std::string& separator) {
  std::string all;
  for (const std::string& part : parts) all += (all.empty() ? "" : separator) + part;
  return all;
}

std::string textOf(XmlRpcValue& value) {
  switch (value.getType()) {
    case XmlRpcValue::TypeBoolean:
      return static_cast<bool>(value) ? "true" : "false";
    case XmlRpcValue::TypeInt:
      return std::to_string(static_cast<int>(value));
    case XmlRpcValue::TypeDouble:
      return shortestText(static_cast<double>(value));
    case XmlRpcValue::TypeString:
      return "the string " + quoted(static_cast<std::string>(value));
    case XmlRpcValue::TypeArray:
      return "a list of " + std::to_string(value.size());
    case XmlRpcValue::TypeStruct:
      return "a namespace with parameters";
    default:
      return "no value";
  }
}

std::string remedyForNumber(XmlRpcValue& value) {
  if (value.getType() != XmlRpcValue::TypeString) return "";
  const std::string text = static_cast<std::string>(value);
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(number)) return "";
  return " (write " + shortestText(number) + " or " + withSignAndPoint(number) + " with a sign and a point)";
}

std::string nearestName(const std::string& unknown, const std::set<std::string>& asked) {
  const std::string key = unknown.substr(unknown.rfind('/') + 1);
  std::size_t fewest = 1 + std::max<std::size_t>(2, key.size() / 3);
  std::string best;
  for (const std::string& candidate : asked) {
    const std::size_t edits = editsBetween(unknown, candidate);
    if (edits < fewest) {
      fewest = edits;
      best = candidate;
    }
  }
  return best;
}

}  // namespace sightline_ros
