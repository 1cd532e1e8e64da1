#include "sightline/core/evaluation/position_scores.h"

#include <algorithm>

namespace sightline::core {
namespace {

constexpr double kWait = 0.25;         // [s] of truth after a report before it is scored
constexpr double kTruthMemory = 10.0;  // [s]
constexpr std::size_t kMostWaiting =
    1000;  // reports of a topic; beyond, the oldest is scored with what is known

}  // namespace

void PositionScores::addTruth(Time time, const std::string& target, const Eigen::Vector3d& position) {
  TruePath& path = truth_.try_emplace(target, truth_gap_).first->second;
  path.add(time, position);
  if (time <= newest_truth_) return;
  newest_truth_ = time;
  for (auto& [name, topic] : topics_) scoreUntil(topic, time - durationOf(kWait));
  for (auto& [name, other] : truth_) other.forgetBefore(time - durationOf(kTruthMemory));
}

bool PositionScores::addTracks(const std::string& name, Time time,
                               const std::vector<EstimatedPosition>& tracks) {
  auto found = topics_.find(name);
  if (found == topics_.end())
    found = topics_.emplace(name, Topic{PositionEvaluation(truth_, params_), {}}).first;
  Topic& topic = found->second;
  if (time <= topic.scored) return false;
  topic.waiting[time] = tracks;
  if (topic.waiting.size() > kMostWaiting) scoreUntil(topic, topic.waiting.begin()->first);
  return true;
}

void PositionScores::scoreUntil(Topic& topic, Time time) {
  while (!topic.waiting.empty() && topic.waiting.begin()->first <= time) {
    topic.evaluation.add(topic.waiting.begin()->first, topic.waiting.begin()->second);
    topic.scored = topic.waiting.begin()->first;
    topic.waiting.erase(topic.waiting.begin());
  }
}

std::map<std::string, PositionRow> PositionScores::rows() {
  std::map<std::string, PositionRow> rows;
  for (auto& [name, topic] : topics_) {
    scoreUntil(topic, newest_truth_ - durationOf(kWait));
    rows[name] = topic.evaluation.row();
  }
  return rows;
}

}  // namespace sightline::core
