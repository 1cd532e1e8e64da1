#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "sightline/core/evaluation/metrics.h"
#include "sightline/core/evaluation/score_listener.h"
#include "sightline/core/evaluation/truth.h"
#include "sightline/core/model/sighting.h"

namespace sightline::core {

/// A sighting may be assigned to a target when it is within either of these.
struct SightingGate {
  double sigmas = 6.0;  ///< Mahalanobis distance by the stated covariance of the sighting
  double floor = 0.0;   ///< distance from the truth, whatever the sighting states [rad]
};

/// Scores the sightings of one sensor on one topic against the truth. A sighting without a target is clutter,
/// or of an unknown target.
class SightingScore {
 public:
  SightingScore(std::string topic, std::string sensor, Channels channels)
      : topic_(std::move(topic)), sensor_(std::move(sensor)), channels_(channels), errors_(channels) {}

  /// Notes the covariances that the sightings state. Needs no truth.
  void note(const Scan& scan_tracking);

  /// Assigns at most one sighting to each target: as many as lie within the gate, with the smallest sum of
  /// squared distances. `targets` are those at the time of the scan.
  void add(const Scan& scan_tracking, const std::vector<TrueTarget>& targets, const SightingGate& gate,
           const ScoreListener& listener);

  const std::string& topic() const { return topic_; }
  const std::string& sensor() const { return sensor_; }
  const ErrorStatistics& errors() const { return errors_; }
  double statedSigma()
      const;  ///< root mean stated variance of a channel [rad]; NaN before the first sighting
  double lastError() const {
    return last_error_;
  }  ///< rms over channels and targets, last scan with any [rad]
  std::uint64_t unmatched() const { return unmatched_; }

 private:
  std::string topic_, sensor_;
  Channels channels_;
  ErrorStatistics errors_;
  RunningMean stated_variance_;
  double last_error_ = std::numeric_limits<double>::quiet_NaN();
  std::uint64_t unmatched_ = 0;
};

}  // namespace sightline::core
