#include "sightline/report/plain_words.h"

#include <cmath>
#include <iomanip>
#include <sstream>

namespace sightline_ros {

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

}  // namespace sightline_ros
