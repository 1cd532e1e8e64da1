#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

/// Numbers with units and lists of names, in the sentences that an operator reads.
namespace sightline::report {

/// A number with three significant digits, or all digits before the point, and its unit: "0.73 s", "3600 s".
std::string valueOf(double number, const std::string& unit);

/// "a, b, c"; of more than `most` names the first ones and "and N more".
std::string listOf(const std::set<std::string>& names, std::size_t most = 8);

/// The finite number that the whole text is; nullopt when it is none.
std::optional<double> numberFrom(const std::string& text);

/// A figure as a cell of a CSV file, ten digits; empty where it is not known (NaN).
std::string orEmpty(double value);

/// A text as a cell of a CSV file, in quotes where it needs them.
std::string csvCell(const std::string& text);

bool isAmong(const std::vector<std::string>& names, const std::string& name);

}  // namespace sightline::report
