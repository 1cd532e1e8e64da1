#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <sightline/SightingArray.h>

#include "sightline/ros/diagnosis/sensor_record.h"

namespace sightline_ros {

struct ReplaySettings {
  std::string config;     ///< YAML file with the sections local_tracker, sensor_fusion, track_fusion and
                          ///< position_tracker; empty = defaults
  std::string estimator;  ///< of every tracker and of the fusion, instead of what the configuration says;
                          ///< empty = as it says
  std::string rule;       ///< of the fusion, likewise
  bool live = false;      ///< scans count as late, and wait for transforms, as in live trackers
  /// Positions instead of fused directions; nullopt = where stations stand more than a metre apart.
  std::optional<bool> positions = std::nullopt;
  bool smooth =
      false;  ///< also write each local tracker's tracks, and positions, given earlier and later sightings
  std::optional<double> lag = std::nullopt;  ///< only sightings up to so much later are used [s], >= 0
  /// Of what trackers, fusion and positions say, only these topics are written; a * at the end of one stands
  /// for any rest of a name. Empty = all.
  std::vector<std::string> topics = {};
  /// Every message is written, as it always is of `topics`. Otherwise, where `topics` is empty, tracks and
  /// associations of a tracker that nobody goes on with (the one over all sensors) are written ten times a
  /// second at most, reports of the fusion when something is new in them or once a second, and tracklets not.
  bool all = false;
};

/// What a replay did.
struct ReplaySummary {
  std::size_t scans = 0;
  std::size_t sightings = 0;
  std::size_t track_messages = 0;
  std::size_t copied_messages = 0;
  std::size_t left_out_messages = 0;            ///< that ReplaySettings::all would write
  double recorded = 0.0;                        ///< from the first scan to the last [s]
  std::map<std::string, std::size_t> drops;     ///< "tracker: reason" to how often
  std::map<std::string, std::string> examples;  ///< likewise: the first one, with its values and the remedy
  std::map<std::string, std::string> topics;    ///< sensor to its topic, where that is not simply its name
  std::vector<std::string> notices;             ///< of stamps that jump
  std::vector<Finding> findings;  ///< of the inputs, and of the tracks that they start; as the doctor's

  /// Counts a drop. `example`: shown of the first one.
  void noteDrop(const std::string& reason, const std::string& example, std::size_t count = 1);
};

/// "of cam at 1000.500 s in frame mast: " and the detail, for the example of a drop.
std::string exampleOf(const sightline::SightingArray& scan, const std::string& detail);

/// Runs the local trackers and the fusion over a recording: one tracker for each sensor
/// (/sensors/<sensor>/tracks), one over all sightings (/sensor_fusion/tracks), and the fusion of the former
/// (/fusion/tracks), with associations and reports beside them. Every message of `in` that is not replaced by
/// these is copied to `out`.
///
/// Sensors that stand apart are no sensors of one place: each station's tracker then tracks in the station's
/// frame (the one over all sensors of a station with several on /stations/<station>/tracks), and instead of
/// fused directions there are positions (/positions/tracks, /positions/report).
///
/// With `smooth` the tracks of each local tracker are written once more beside them (/tracks_smoothed), where
/// they were by all sightings of the recording, or by those up to `lag` later: see TrackSmoother; positions
/// likewise (/positions/tracks_smoothed): see PositionSmoother.
///
/// Scans are followed in the order of their stamps, however they arrived, with all transforms of the
/// recording; with `live` as live trackers would have followed them, which drop what is later than `max_lag`
/// and wait `tf_timeout` for transforms. Where the stamps of all sensors go back (a recording of a loop),
/// everything starts anew; a sensor whose stamps alone step is left out until they agree with the others'
/// again. The same input and configuration give the same messages, byte for byte. Throws ParamError or
/// std::runtime_error; `out` is only there when all went well.
ReplaySummary replay(const std::string& in, const std::string& out, const ReplaySettings& settings);

}  // namespace sightline_ros
