#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <diagnostic_updater/DiagnosticStatusWrapper.h>

#include "sightline/core/model/time.h"

namespace sightline_ros {

/// Something that came in and is not used.
struct Refusal {
  std::string reason;  ///< short and of few kinds, for counting
  std::string detail;  ///< the whole story: the thing, the value, the remedy
};

/// Counts refusals by reason; says each reason aloud at most once in five seconds.
class Refusals {
 public:
  /// Counts, and returns a line to warn with when this reason was not complained of lately. `now` is the
  /// clock.
  std::optional<std::string> note(const Refusal& refusal, sightline::core::Time now);

  /// Adds a value for each reason, and a warning when there were new ones since the last call.
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  struct Counted {
    std::uint64_t count = 0;
    std::uint64_t count_before = 0;  // at the last diagnosis
    std::uint64_t count_warned = 0;  // at the last warning
    std::optional<sightline::core::Time> last_warning;
  };

  std::map<std::string, Counted> counts_;
};

}  // namespace sightline_ros
