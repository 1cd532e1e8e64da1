#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "sightline/core/evaluation/evaluation.h"
#include "sightline/core/evaluation/track_spans.h"

namespace sightline::report {

/// Compares tracks with their own sightings, where no truth is known: the residuals of the sightings, and the
/// spans of the tracks.
///
/// All reports are added before the first scan. A scan is compared with the tracks that its sensor supports,
/// directly or through other trackers. Between its confirmed reports a track is interpolated by the cubic
/// through states and rates. The sightings have updated the track, so residuals are somewhat smaller than
/// their errors.
class ResidualComparison {
 public:
  struct Topic {
    std::string tracker;
    bool fused = false;
    std::set<std::string> sources;  ///< sensors, or trackers
    core::TrackSpans spans;
    core::Evaluation evaluation;  ///< of the sightings, with the tracks as the truth
  };

  ResidualComparison(const core::EvaluationParams& params, const core::ScoreListener& listener);

  void addTracks(const std::string& topic, const core::TrackReport& report);
  void addScan(const std::string& topic, const core::Scan& scan);

  /// By topic of the tracks.
  const std::map<std::string, Topic>& topics() const { return topics_; }

 private:
  Topic& topicOf(const std::string& name);
  bool isMadeOf(const Topic& topic, const std::string& sensor, int depth = 0) const;

  core::EvaluationParams params_;
  core::ScoreListener listener_;
  std::map<std::string, Topic> topics_;
};

}  // namespace sightline::report
