#pragma once

#include <string>
#include <utility>

namespace sightline::core {

/// Why an input is not used, or why a result cannot be given.
struct Refusal {
  std::string kind;    ///< what such refusals are counted by: "late", "duplicate", ...
  std::string detail;  ///< the value, what was expected, the remedy; may be empty
};

/// Of an input whose values cannot be right.
inline Refusal invalid(std::string detail) {
  return {"invalid", std::move(detail)};
}

/// "kind: detail", for logs and reports.
inline std::string textOf(const Refusal& refusal) {
  return refusal.detail.empty() ? refusal.kind : refusal.kind + ": " + refusal.detail;
}

}  // namespace sightline::core
