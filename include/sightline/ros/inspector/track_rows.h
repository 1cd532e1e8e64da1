#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include <Eigen/Core>

#include <sightline/PositionTrackArray.h>
#include <sightline/TrackArray.h>

/// Tracks as a person reads them in a table, whatever they are tracks of.
namespace sightline_ros {

/// A track: ids are unique in the messages of one topic only.
struct TrackKey {
  std::string topic;  ///< full name
  std::uint32_t id = 0;
};

inline bool operator==(const TrackKey& a, const TrackKey& b) {
  return a.id == b.id && a.topic == b.topic;
}
inline bool operator!=(const TrackKey& a, const TrackKey& b) {
  return !(a == b);
}
inline bool operator<(const TrackKey& a, const TrackKey& b) {
  return std::tie(a.topic, a.id) < std::tie(b.topic, b.id);
}

/// global: of a fusion. position: in metres.
enum class TrackKind : std::uint8_t { global, local, position };

struct TrackRow {
  TrackKey key;
  TrackKind kind = TrackKind::local;
  std::string tracker;                                          ///< name of the tracker or fusion
  std::uint8_t status = 0;                                      ///< as in the messages
  double existence = std::numeric_limits<double>::quiet_NaN();  ///< NaN = not computed
  double age = 0.0;                                             ///< since it was in a message first [s]
  double unseen = 0.0;                                          ///< from its last sighting to its state [s]
  double sigma = 0.0;                                ///< largest, of the direction [rad] or the position [m]
  double silence = 0.0;                              ///< since its tracker was heard [s]; 0 = it is heard
  std::vector<std::string> sources;                  ///< sensors, trackers or `tracker/id`
  std::string frame;                                 ///< of its state
  Eigen::Vector3d place = Eigen::Vector3d::UnitX();  ///< unit vector, or position [m], in `frame`
};

/// One row without age, silence and kind, which a message alone does not tell. `index`: of the track in it.
TrackRow rowOf(const std::string& topic, const sightline::TrackArray& message, std::size_t index);
TrackRow rowOf(const std::string& topic, const sightline::PositionTrackArray& message, std::size_t index);

/// Largest standard deviation of the direction, as an arc [rad], or of the position [m].
double sigmaOfTrack(const sightline::Track& track);
double sigmaOfTrack(const sightline::PositionTrack& track);

std::string wordOf(TrackKind kind);           ///< "global", "local", "position"
std::string statusWord(std::uint8_t status);  ///< "tentative", "confirmed", "coasting"

/// "0.52 mrad", "3.1 m": with the digits that matter. "-" for what is not finite.
std::string sigmaText(double sigma, TrackKind kind);

/// "confirmed", or "silent 3.2 s" of a tracker that is not heard any more.
std::string stateText(const TrackRow& row);

std::string joined(const std::vector<std::string>& names);  ///< "a, b"

/// Whether each word of `filter` (between blanks, upper and lower case alike) is in what the row says:
/// kind, tracker, id, state, sources.
bool matches(const TrackRow& row, const std::string& filter);

}  // namespace sightline_ros
