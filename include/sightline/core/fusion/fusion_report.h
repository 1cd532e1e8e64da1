#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/fusion/global_track.h"
#include "sightline/core/fusion/reports/local_reports.h"
#include "sightline/core/fusion/rules/fusion_rule_table.h"
#include "sightline/core/model/refusal.h"
#include "sightline/core/model/time.h"
#include "sightline/core/model/track.h"
#include "sightline/core/sensors/sensor_guard.h"

namespace sightline::core {

class GlobalTracks;

/// A local track's part in a global one: the fields of sightline/SourceTrack.
struct SourceTrack {
  std::string tracker;
  std::uint32_t id = 0;
  double weight = 0.0;  ///< share in the fused position, in [0, 1]; 0 when left out
  /// Normalised distance squared from the other local tracks of the global track [1]; NaN = there are none,
  /// or none that it can be compared with.
  double distance_squared = std::numeric_limits<double>::quiet_NaN();
  double age = 0.0;               ///< by how much the track was predicted to the common time [s]
  std::optional<Refusal> reason;  ///< only when left out
};

/// A global track and what it was made of.
struct FusedTrack {
  Track track;  ///< `sources` are the names of the trackers that contribute
  FusionRule rule = FusionRule::weighted_covariance;  ///< that was applied
  std::optional<Refusal> why_not_tracklets;  ///< when the rule was to be the best one, and they were not
  std::optional<Refusal> withheld;  ///< why the track is not shown: it is none, by its state; nullopt = shown
  std::vector<SourceTrack> sources;    ///< that contributed, by tracker name; none: the state is a prediction
  std::vector<SourceTrack> left_out;   ///< that belong to the target and were not used
  std::vector<WatchedSensor> sensors;  ///< whose tracklets are watched, and what is thought of them
  std::vector<SensorChange> sensor_changes;  ///< of that, noticed with this report
};

/// All global tracks at one instant.
struct FusionReport {
  Time time{};                     ///< at which every state is valid: the newest stamp of the local reports
  std::vector<FusedTrack> tracks;  ///< ascending id
  std::vector<SourceTrack> left_out;  ///< local tracks that belong to no global one
  /// Why the report that was handed in was not used; the rest is then as it was before. nullopt when used.
  std::optional<Refusal> refusal;
};

/// Each source's share in the fused position, summing to one: by the position block of its gain.
std::vector<double> positionShares(const std::vector<Eigen::Matrix4d>& gains);

/// Describes that `used` made the track's state, with these shares. Their `new_reports` are the track's hits.
void describeFusion(const GlobalTrack& track, const std::vector<std::size_t>& used,
                    const std::vector<double>& shares, const NewReports& new_reports,
                    FusedTrack& description);

/// Describes that no supporter did, and the state is a prediction.
void describeCoasting(const GlobalTrack& track, FusedTrack& description);

/// Lists the supporters that were not used, each with the reason.
void describeLeftOut(const GlobalTrack& track, const std::vector<std::pair<std::size_t, Refusal>>& left_out,
                     FusedTrack& description);

/// Why such a state is no track; nullopt when it is one. It must be finite, its covariance positive definite,
/// and its position not less certain than anywhere on the sphere.
std::optional<Refusal> whyNoTrack(const AngularState& state_tracking);

/// The report of all global tracks that are shown, and of the local tracks that support none: of these each
/// with the reason. `waiting`: local tracks whose place another supporter still has, with the id of that
/// global track.
FusionReport describe(const GlobalTracks& tracks, const LocalReports& reports,
                      const std::map<LocalKey, std::uint32_t>& waiting);

/// The latest report again, with the tracks of a local report that was refused left out (at most `max_tracks`
/// left out in all).
FusionReport describeRefused(const FusionReport& latest, const LocalReport& refused, const Refusal& why,
                             std::size_t max_tracks);

}  // namespace sightline::core
