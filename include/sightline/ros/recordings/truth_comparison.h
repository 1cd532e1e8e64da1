#pragma once

#include <map>
#include <string>
#include <vector>

#include "sightline/core/evaluation/evaluation.h"
#include "sightline/ros/recordings/recorded_truth.h"

namespace sightline_ros {

/// Evaluations against a recorded truth: one, or one for each sensor where these stand apart.
class TruthComparison {
 public:
  TruthComparison(const RecordedTruth& truth, sightline::core::EvaluationParams params,
                  const sightline::core::ScoreListener& listener);

  /// A scan or report of a sensor without a truth is only counted.
  void addScan(const std::string& topic, sightline::core::Scan scan);
  void addTracks(const std::string& topic, sightline::core::TrackReport report);

  std::vector<sightline::core::EvaluationRow> rows() const;

  /// One for each topic of tracks and each target.
  std::vector<sightline::core::TargetRow> targetRows() const;

  /// Stated sigma of the best sensor [rad]; NaN when each is compared with a truth of its own.
  double bestSigma() const;

  /// Messages without a truth, by topic.
  const std::map<std::string, std::size_t>& withoutTruth() const { return without_truth_; }

 private:
  sightline::core::Evaluation* evaluationFor(const std::string& topic, const std::string& name);

  std::map<std::string, sightline::core::Evaluation> by_sensor_;  // "" = of all
  std::map<std::string, std::size_t> without_truth_;
};

}  // namespace sightline_ros
