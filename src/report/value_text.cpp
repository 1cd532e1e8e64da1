#include "sightline/report/value_text.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iomanip>
#include <sstream>

namespace sightline::report {

std::string valueOf(double number, const std::string& unit) {
  std::ostringstream text;
  if (std::abs(number) >= 1000.0 && std::abs(number) < 1e15)
    text << std::fixed << std::setprecision(0);
  else
    text << std::setprecision(3);
  text << number << " " << unit;
  return text.str();
}

std::string listOf(const std::set<std::string>& names, std::size_t most) {
  std::string list;
  std::size_t listed = 0;
  for (const std::string& name : names) {
    if (listed++ == most) return list + " and " + std::to_string(names.size() - most) + " more";
    list += (list.empty() ? "" : ", ") + name;
  }
  return list;
}

std::optional<double> numberFrom(const std::string& text) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(number)) return std::nullopt;
  return number;
}

std::string orEmpty(double value) {
  if (std::isnan(value)) return "";
  std::ostringstream text;
  text << std::setprecision(10) << value;
  return text.str();
}

std::string csvCell(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char letter : text) quoted += letter == '"' ? "\"\"" : std::string(1, letter);
  return quoted + "\"";
}

bool isAmong(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace sightline::report
