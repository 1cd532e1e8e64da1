#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "sightline/core/model/time.h"

namespace sightline::core {

/// The sighting that started a track.
struct TrackOrigin {
  Time time{};
  std::string sensor;
  std::uint32_t sighting = 0;  ///< index in its scan
  std::uint32_t parent = 0;    ///< id of the track of which this is a second hypothesis; 0 = of none

  friend bool operator==(const TrackOrigin& a, const TrackOrigin& b) {
    return a.time == b.time && a.sighting == b.sighting && a.parent == b.parent && a.sensor == b.sensor;
  }
};

/// Gives ids to new tracks: an id that a track has had is never another target's, also where scans are
/// processed again and tracks start anew. Then a track that starts from the same sighting has the same id.
class TrackIds {
 public:
  std::uint32_t idOf(const TrackOrigin& origin) {
    const auto found = std::find_if(undone_.begin(), undone_.end(),
                                    [&](const auto& track) { return track.first == origin; });
    if (found == undone_.end()) return next_++;
    const std::uint32_t id = found->second;
    undone_.erase(found);  // scans whose stamps repeat start several tracks from the same origin
    return id;
  }

  /// From here on no id up to this one is given to a new track.
  void skip(std::uint32_t id) { next_ = std::max(next_, id + 1); }

  /// `tracks`: what there was before scans are processed again.
  template <typename Track>
  void remember(const std::vector<Track>& tracks) {
    undone_.clear();
    for (const Track& track : tracks) undone_.emplace_back(track.origin(), track.id());
  }
  void forget() { undone_.clear(); }

 private:
  std::uint32_t next_ = 1;
  std::vector<std::pair<TrackOrigin, std::uint32_t>> undone_;
};

}  // namespace sightline::core
