#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <diagnostic_updater/DiagnosticStatusWrapper.h>

#include "sightline/core/model/refusal.h"
#include "sightline/core/model/time.h"

namespace sightline_ros {

/// A warning of one kind is given at most once in this time.
constexpr double kSecondsBetweenWarnings = 5.0;

/// Counts refusals by kind; gives a warning of each kind at most once in five seconds.
class Refusals {
 public:
  /// Counts, and returns a line to warn with when there was no warning of this kind in the last five seconds.
  /// `now` is the clock.
  std::optional<std::string> note(const sightline::core::Refusal& refusal, sightline::core::Time now);

  /// Adds a value for each kind, and a warning when there were new ones since the last call.
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  struct Counted {
    std::uint64_t count = 0;
    std::uint64_t count_before = 0;  // at the last diagnosis
    std::uint64_t count_warned = 0;  // at the last warning
    std::optional<sightline::core::Time> last_warning;
  };

  std::map<std::string, Counted> counts_;  // by kind
};

}  // namespace sightline_ros
