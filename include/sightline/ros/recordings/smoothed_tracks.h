#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include <sightline/TrackArray.h>

#include "sightline/core/smoothing/track_smoother.h"
#include "sightline/ros/components/local_tracker_component.h"

namespace sightline_ros {

/// The tracks of one tracker of a replay, smoothed when it is over: what the tracker said, and the sightings
/// that it had taken for each track, are kept until then.
class SmoothedTracks {
 public:
  /// `estimator`: of the tracker. `lag`: as in BankSmoother [s]; nullopt = all sightings. Throws
  /// std::invalid_argument for an estimator whose tracks cannot be smoothed, in one line with the remedy.
  SmoothedTracks(const sightline::core::EstimatorParams& estimator, std::optional<double> lag);

  /// Keeps what the tracker, which has been told to `keepSightings`, reports of a scan.
  void keep(const TrackerReport& report);

  /// The tracker's messages in their order with smoothed states: azimuth, elevation, their rates and the
  /// covariance. All else, also the gates, is as the tracker said. A track is left out at times before its
  /// first known sighting.
  std::vector<sightline::TrackArray> smooth() const;

 private:
  using States = std::map<sightline::core::Time, sightline::core::AngularState>;

  sightline::core::TrackSmoother smoother_;
  std::optional<double> lag_;
  std::vector<sightline::TrackArray::ConstPtr> tracks_;
  std::map<std::uint32_t, std::vector<sightline::core::TakenSighting>> sightings_;  // by track, by time
};

}  // namespace sightline_ros
