#pragma once

#include <limits>
#include <string>

namespace sightline_ros {

/// Of a count without a limit.
constexpr int kMany = std::numeric_limits<int>::max();

/// The numbers that a parameter may take. Infinite ends are always open.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false;
  bool high_open = false;

  bool holds(double value) const;
};

Range anyNumber();                       ///< any finite number
Range atLeast(double low);               ///< [low, inf)
Range above(double low);                 ///< (low, inf)
Range between(double low, double high);  ///< [low, high]
Range inside(double low, double high);   ///< (low, high)

/// What a parameter is expected to be, for messages: `a number in (0, 1) [rad]`.
std::string expectedNumber(const Range& range, const std::string& unit);

}  // namespace sightline_ros
