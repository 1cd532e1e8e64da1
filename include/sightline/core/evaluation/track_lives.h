#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

namespace sightline::core {

/// Counts the false tracks of one tracker, and how many targets its tracks mix. The life of a track is
/// counted in reports. Memory: a few numbers for every track.
class TrackLives {
 public:
  /// Once a report and established track: the track is on `target`, or on none.
  void observe(std::uint32_t track, std::optional<std::uint32_t> target);

  /// From now on the ids mean other tracks: the tracker, or time, has started anew.
  void restart() { ++run_; }

  std::size_t tracks() const { return lives_.size(); }

  /// Tracks that were on any target in less than half of their life.
  std::size_t falseTracks() const;

  /// Share of a track's life on the target on which it was most, the mean over tracks weighted by their
  /// lengths, in [0, 1]; NaN without tracks.
  double purity() const;

 private:
  struct Life {
    std::uint64_t reports = 0;
    std::map<std::uint32_t, std::uint64_t> on_target;  // reports by target
  };

  std::uint32_t run_ = 0;
  std::map<std::pair<std::uint32_t, std::uint32_t>, Life> lives_;  // by run and track
};

}  // namespace sightline::core
