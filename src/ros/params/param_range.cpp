#include "sightline/ros/params/param_range.h"

#include <cmath>

#include "sightline/ros/params/param_text.h"

namespace sightline_ros {
namespace {

std::string boundsOf(const Range& range) {
  const bool bounded_below = std::isfinite(range.low);
  const bool bounded_above = std::isfinite(range.high);
  if (!bounded_below && !bounded_above) return "";
  if (!bounded_above) return (range.low_open ? " > " : " >= ") + shortestText(range.low);
  if (!bounded_below) return (range.high_open ? " < " : " <= ") + shortestText(range.high);
  return std::string(" in ") + (range.low_open ? "(" : "[") + shortestText(range.low) + ", " +
         shortestText(range.high) + (range.high_open ? ")" : "]");
}

}  // namespace

bool Range::holds(double value) const {
  return std::isfinite(value) && (low_open ? value > low : value >= low) &&
         (high_open ? value < high : value <= high);
}

Range anyNumber() {
  return Range{};
}

Range atLeast(double low) {
  Range range;
  range.low = low;
  return range;
}

Range above(double low) {
  Range range = atLeast(low);
  range.low_open = true;
  return range;
}

Range between(double low, double high) {
  return Range{low, high, false, false};
}

Range inside(double low, double high) {
  return Range{low, high, true, true};
}

std::string expectedNumber(const Range& range, const std::string& unit) {
  return "a number" + boundsOf(range) + (unit.empty() ? "" : " [" + unit + "]");
}

}  // namespace sightline_ros
