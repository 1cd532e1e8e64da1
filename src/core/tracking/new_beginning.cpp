#include "sightline/core/tracking/new_beginning.h"

#include <algorithm>
#include <utility>

namespace sightline::core {

std::uint32_t begunAnew(std::vector<LiveTrack>& tracks, const Scan& scan,
                        std::unique_ptr<Estimator> estimator, double odds, const RevisitTime& interval,
                        TrackIds& ids) {  // (S-96)
  const auto isOurs = [&](const LiveTrack& track) { return track.origin().sensor == scan.sensor; };
  const auto oldest = std::find_if(tracks.begin(), tracks.end(), [&](const LiveTrack& track) {
    return isOurs(track) && !track.lifecycle().isTentative();
  });
  const TrackOrigin origin{scan.time, scan.sensor, 0};
  LiveTrack fresh(oldest == tracks.end() ? ids.idOf(origin) : oldest->id(), origin, scan,
                  scan.sightings.front(), std::move(estimator), odds, interval);
  if (oldest != tracks.end()) fresh.resume(*oldest);
  const std::uint32_t id = fresh.id();
  tracks.erase(std::remove_if(tracks.begin(), tracks.end(), isOurs), tracks.end());
  const auto place =
      std::find_if(tracks.begin(), tracks.end(), [&](const LiveTrack& track) { return track.id() > id; });
  tracks.insert(place, std::move(fresh));
  return id;
}

}  // namespace sightline::core
