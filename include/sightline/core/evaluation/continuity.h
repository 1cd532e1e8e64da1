#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace sightline::core {

/// Whether one tracker stays with its targets: counts the covered observations, the breaks and the changes of
/// identity. A target that leaves is forgotten.
class Continuity {
 public:
  /// How an observation differs from the one before.
  struct Change {
    bool lost = false;      ///< a break: the target had a track and goes on without
    bool switched = false;  ///< it came to a track of another id
  };

  /// Once a report and target: the target exists and has `track`, or none.
  Change observe(std::uint32_t target, std::optional<std::uint32_t> track);

  /// The target does not exist now.
  void forget(std::uint32_t target) { targets_.erase(target); }
  void forgetAll() { targets_.clear(); }

  /// Forgets every target that is not in `present` (ascending).
  void forgetAllBut(const std::vector<std::uint32_t>& present);

  /// The track that the target had at its last observation; nullopt when it had none or was not there.
  std::optional<std::uint32_t> trackOf(std::uint32_t target) const;

  std::uint32_t breaks() const { return breaks_; }           ///< times a target lost its track and went on
  std::uint32_t idSwitches() const { return id_switches_; }  ///< times a target came to a track of another id
  double coverage() const;  ///< share of the observations with a track, in [0, 1]; NaN without any

 private:
  struct Target {
    bool covered = false;               // at the last observation
    std::optional<std::uint32_t> last;  // the last track it had
  };

  std::map<std::uint32_t, Target> targets_;
  std::uint32_t breaks_ = 0, id_switches_ = 0;
  std::uint64_t observations_ = 0, covered_ = 0;
};

}  // namespace sightline::core
