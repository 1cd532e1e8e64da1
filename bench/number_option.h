#pragma once

#include <exception>
#include <stdexcept>
#include <string>

namespace sightline::bench {

/// The whole number that an option of a program was given. Throws std::invalid_argument, which names option
/// and value, for anything else and for what is below `least`.
inline int numberOf(const std::string& option, const std::string& text, int least) {
  std::size_t used = 0;
  int value = 0;
  try {
    value = std::stoi(text, &used);
  } catch (const std::exception&) {
  }
  if (used == 0 || used != text.size() || value < least)
    throw std::invalid_argument(option + ": expected a number from " + std::to_string(least) + " on, got \"" +
                                text + "\"");
  return value;
}

}  // namespace sightline::bench
