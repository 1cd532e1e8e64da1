#pragma once

#include <cstddef>
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

/// The detail as a person may read it: of one that is too long, as it quotes a name without end, the
/// beginning and its length.
inline std::string readableDetail(const Refusal& refusal) {
  constexpr std::size_t kMostLetters = 1000;
  if (refusal.detail.size() <= kMostLetters) return refusal.detail;
  return refusal.detail.substr(0, kMostLetters) + "... (" + std::to_string(refusal.detail.size()) +
         " letters)";
}

/// "kind: detail", for logs and reports.
inline std::string textOf(const Refusal& refusal) {
  return refusal.detail.empty() ? refusal.kind : refusal.kind + ": " + readableDetail(refusal);
}

}  // namespace sightline::core
