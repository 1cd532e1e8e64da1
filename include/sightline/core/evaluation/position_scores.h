#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "sightline/core/evaluation/position_evaluation.h"
#include "sightline/core/model/time.h"

namespace sightline::core {

/// Scores positions of several topics while they and the truth come in. A report waits until the truth is
/// known around it; of several reports at one time the last counts. Memory is bounded.
class PositionScores {
 public:
  /// `truth_gap`: see TruePath [s].
  PositionScores(const PositionEvaluationParams& params, double truth_gap)
      : params_(params), truth_gap_(truth_gap) {}
  PositionScores(const PositionScores&) = delete;  // each topic refers to the truth
  PositionScores& operator=(const PositionScores&) = delete;

  void addTruth(Time time, const std::string& target, const Eigen::Vector3d& position);

  /// False: the report is older than one that has been scored, and is left out.
  bool addTracks(const std::string& topic, Time time, const std::vector<EstimatedPosition>& tracks);

  /// Of the topics that have reported, with all that the truth is known for.
  std::map<std::string, PositionRow> rows();

 private:
  struct Topic {
    PositionEvaluation evaluation;
    std::map<Time, std::vector<EstimatedPosition>> waiting;
    Time scored = Time::min();
  };

  static void scoreUntil(Topic& topic, Time time);

  PositionEvaluationParams params_;
  double truth_gap_;
  std::map<std::string, TruePath> truth_;
  std::map<std::string, Topic> topics_;
  Time newest_truth_ = Time::min();
};

}  // namespace sightline::core
