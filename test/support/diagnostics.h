#pragma once

#include <string>

#include <diagnostic_updater/DiagnosticStatusWrapper.h>

namespace sightline::test {

/// The value under a key of a status, or "(absent)".
inline std::string valueOf(const diagnostic_updater::DiagnosticStatusWrapper& status,
                           const std::string& key) {
  for (const auto& value : status.values) {
    if (value.key == key) return value.value;
  }
  return "(absent)";
}

}  // namespace sightline::test
