#pragma once

#include <functional>
#include <string>

namespace sightline::test {

/// What an action says when it throws an `Error`; empty when it throws none.
template <typename Error>
std::string complaintOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace sightline::test
