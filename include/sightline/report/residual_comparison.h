#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "sightline/core/evaluation/evaluation.h"
#include "sightline/core/evaluation/track_spans.h"

namespace sightline_ros {

/// What can be said of tracks where no truth is known: how the sightings lie about the tracks that were made
/// of them, and how long the tracks live.
///
/// All reports have to come before the first scan. A scan is compared with the tracks that its sensor
/// supports, directly or through other trackers. A track's path between its confirmed reports is the cubic
/// through states and rates. As the track has taken the sightings, residuals are somewhat smaller than the
/// sightings' errors.
class ResidualComparison {
 public:
  struct Topic {
    std::string tracker;
    bool fused = false;
    std::set<std::string> sources;  ///< sensors, or trackers
    sightline::core::TrackSpans spans;
    sightline::core::Evaluation evaluation;  ///< of the sightings, with the tracks for a truth
  };

  ResidualComparison(const sightline::core::EvaluationParams& params,
                     const sightline::core::ScoreListener& listener);

  void addTracks(const std::string& topic, const sightline::core::TrackReport& report);
  void addScan(const std::string& topic, const sightline::core::Scan& scan);

  /// By topic of the tracks.
  const std::map<std::string, Topic>& topics() const { return topics_; }

 private:
  Topic& topicOf(const std::string& name);
  bool isMadeOf(const Topic& topic, const std::string& sensor, int depth = 0) const;

  sightline::core::EvaluationParams params_;
  sightline::core::ScoreListener listener_;
  std::map<std::string, Topic> topics_;
};

}  // namespace sightline_ros
