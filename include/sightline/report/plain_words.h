#pragma once

#include <set>
#include <string>

/// Pieces of sentences that an operator reads.
namespace sightline_ros {

/// A number with three digits, or all before the point, and its unit: "0.73 s", "3600 s".
std::string valueOf(double number, const std::string& unit);

/// "a, b, c", and how many more where there are more than `most`.
std::string listOf(const std::set<std::string>& names, std::size_t most = 8);

}  // namespace sightline_ros
