#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <vector>

namespace sightline::core {

/// A figure that nothing tells.
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// How soon and how completely one tracker follows the targets: the delay from a target's appearance to its
/// first established track, and the share of an appearance that one track covers. An appearance is a target's
/// time without a gap.
class Appearances {
 public:
  /// Once a report and target: the target has existed for `age` [s] and has `track`, or none.
  void observe(std::uint32_t target, double age, std::optional<std::uint32_t> track);

  /// The appearances of all targets that are not in `present` (ascending) are over.
  void endAllBut(const std::vector<std::uint32_t>& present);
  void endAll() { endAllBut({}); }

  std::size_t count() const { return ended_ + now_.size(); }  ///< appearances during which there was a report
  std::size_t neverConfirmed() const { return count() - delays_.size(); }  ///< without any established track

  /// From appearance to the first established track [s], over those that came to one; NaN without any.
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
