#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace sightline::core {

/// How one tracker took up the targets: told at every report which track each target had, it says how long
/// after a target's appearance its first believed track came, and how much of an appearance one track held.
/// An appearance is a target's time without a gap.
class Appearances {
 public:
  /// The target has been there for `age` [s] and has `track`, or none.
  void observe(std::uint32_t target, double age, std::optional<std::uint32_t> track);

  /// The appearances of all targets that are not in `present` (ascending) are over.
  void endAllBut(const std::vector<std::uint32_t>& present);
  void endAll() { endAllBut({}); }

  std::size_t count() const { return ended_ + now_.size(); }  ///< appearances during which there was a report
  std::size_t neverConfirmed() const { return count() - delays_.size(); }  ///< without any believed track

  /// From appearance to the first believed track [s], over those that came to one; NaN without any.
  double medianDelay() const;
  double worstDelay() const;

  /// Share of an appearance with the track that it had most, the mean over appearances weighted by their
  /// lengths (in reports), in [0, 1]; NaN without any.
  double completeness() const;

 private:
  struct Appearance {
    std::uint64_t reports = 0;
    std::map<std::uint32_t, std::uint64_t> with_track;  // reports by track

    std::uint64_t most() const;
  };

  std::map<std::uint32_t, Appearance> now_;  // by target
  std::size_t ended_ = 0;
  std::uint64_t reports_ = 0, most_ = 0;  // of those that ended
  std::vector<double> delays_;            // [s]
};

}  // namespace sightline::core
