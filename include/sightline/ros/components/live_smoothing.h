#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <vector>

#include <sightline/TrackArray.h>

#include "sightline/core/smoothing/fixed_lag_smoother.h"
#include "sightline/ros/components/local_tracker_component.h"

namespace sightline_ros {

/// The message's track with another state.
sightline::Track withState(const sightline::Track& message, const sightline::core::AngularState& state);

/// The tracks of a running local tracker once more, smoothed by the sightings up to a lag later: its messages
/// wait here until those have come. They leave in batches of half a lag, so that the smoothed tracks of a
/// time come between one and 1.5 lags after it.
///
/// Memory is bounded: beyond kMostMessages or kMostSightings that wait, messages leave early; what is known
/// of a track is forgotten ten seconds after its last sighting.
class LiveSmoothing {
 public:
  static constexpr std::size_t kMostMessages = 2000, kMostSightings = 20000;

  using Messages = std::vector<sightline::TrackArray::Ptr>;

  /// `estimator`: of the tracker. `lag` > 0 [s]. Throws std::invalid_argument for an estimator whose tracks
  /// cannot be smoothed, in one line with the remedy.
  LiveSmoothing(const sightline::core::EstimatorParams& estimator, double lag);

  /// Takes what the tracker, which has been told to `keepSightings`, reports of a scan. Returns the smoothed
  /// messages that are due, oldest first: state and covariance are the smoothed ones, all else is as the
  /// tracker said. A track without a sighting up to then is left out.
  Messages onReport(const TrackerReport& report);

  /// The clock is `now`: what waits when no scan has come for 1.5 lags.
  Messages overdue(sightline::core::Time now);

  double lag() const { return lag_; }
  std::size_t waiting() const { return messages_.size(); }
  std::size_t late() const { return late_; }  ///< sightings that came after the answer, and were not used

 private:
  struct Smoothed {
    sightline::core::FixedLagSmoother smoother;
    sightline::core::Time last;  // sighting
  };

  Messages answer(sightline::core::Time end);

  sightline::core::NogaConsistentParams bank_;
  double lag_;
  std::deque<sightline::TrackArray::ConstPtr> messages_;  // that wait, oldest first
  std::map<std::uint32_t, Smoothed> tracks_;
  std::size_t sightings_ = 0;  // since the last answer
  std::size_t late_ = 0;
};

}  // namespace sightline_ros
