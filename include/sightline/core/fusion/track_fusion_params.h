#pragma once

#include <optional>

#include "sightline/core/fusion/fusion_report.h"
#include "sightline/core/fusion/reports/local_reports.h"
#include "sightline/core/fusion/rules/fusion_rules.h"
#include "sightline/core/fusion/tracklets/tracklet_fusion.h"
#include "sightline/core/fusion/tracklets/tracklet_memory.h"
#include "sightline/core/model/refusal.h"

namespace sightline::core {

struct TrackFusionParams {
  FusionRule rule = FusionRule::best;
  IntersectionWeights intersection_weights =
      IntersectionWeights::determinant;  ///< for covariance_intersection

  /// Probability that two tracks of one target are recognised as such, if their covariances are right, in (0,
  /// 1).
  double gate_probability = 0.999;
  double leave_factor = 2.0;        ///< a supporter contradicts at this many times the gate's threshold, >= 1
  double leave_after = 0.5;         ///< a supporter that contradicts for so long goes [s], >= 0
  double registration_sigma = 0.0;  ///< misalignment between trackers to allow for in the gate [rad], >= 0;
                                    ///< what many targets show of it is allowed for beyond

  /// Density of white angular acceleration for predictions to the common time and for cross_covariance
  /// [rad^2/s^3], >= 0; 0 = what each local track's covariance implies.
  double process_noise = 0.0;

  /// Longest that a report waits for those of other trackers that are expected meanwhile, to be fused with
  /// them once [s], >= 0; 0 = it is fused at once.
  double max_wait = 0.05;

  double coasting_age = 0.5;  ///< a coasting local track counts so long after its last sighting [s], >= 0
  /// A global track that no tracker reports any more is not shown. A new local track may go on with it for so
  /// long [s], >= 0 ...
  double delete_after = 1.0;
  double remember =
      5.0;  ///< ... and a local track that it had and that returns under its id, for so long [s]
  bool allow_shared_sensors = false;  ///< fuse local tracks that list a sensor in common as if they did not
  int max_tracks = 1000;              ///< no global track is started beyond, >= 1
  LocalReportsParams reports;
  TrackletFusionParams tracklets;
};

/// Throws std::invalid_argument for parameters out of their range.
void requireValid(const TrackFusionParams& params);

/// Whether the rule can make use of tracklets.
bool usesTracklets(FusionRule rule);

/// Why a fusion with the parameters `now` cannot go on with `wanted`: the field that holds from the start of
/// the fusion on, or is out of range. nullopt when it can: the two differ only in
///
/// - `rule`, `intersection_weights`, `allow_shared_sensors`,
/// - `gate_probability`, `leave_factor`, `leave_after`,
/// - `coasting_age`, `delete_after`, `remember`,
/// - `tracklets.max_missing`, and of `tracklets.guard.health` `noise_threshold`, `bias_threshold`,
///   `noise_release`, `bias_release`, `least_exclusion`.
///
/// The rest is what global tracks and the memories of reports and tracklets were made with, and the limits.
std::optional<Refusal> whyNotInFlight(const TrackFusionParams& now, const TrackFusionParams& wanted);

/// Tracklets are kept as long as a global track could still take them.
TrackletMemoryParams memoryParamsOf(const TrackFusionParams& params);

/// Thresholds of normalised distances squared between states of four components [1].
struct DistanceThresholds {
  double join = 0.0;        ///< up to here two tracks may be of one target
  double contradict = 0.0;  ///< from here on a supporter contradicts the others
};

DistanceThresholds thresholdsOf(const TrackFusionParams& params);

}  // namespace sightline::core
