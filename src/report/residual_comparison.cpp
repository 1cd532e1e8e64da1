#include "sightline/report/residual_comparison.h"

#include <utility>

namespace sightline::report {
namespace {

constexpr double kForEver = 2e9;    // [s]
constexpr int kDeepestFusion = 10;  // fusions of fusions

/// The listener, called with the topic of the tracks instead of that of the sightings.
core::ScoreListener underTopic(const core::ScoreListener& listener, const std::string& topic) {
  if (!listener.pair) return {};
  const auto tell = [pair_listener = listener.pair, topic](core::ScoredPair pair) {
    pair.topic = topic;
    pair_listener(pair);
  };
  return {tell, {}};
}

std::map<std::uint32_t, Eigen::Vector4d> confirmedOf(const core::TrackReport& report) {
  std::map<std::uint32_t, Eigen::Vector4d> motions;
  for (const core::Track& track : report.tracks) {
    if (track.status == core::TrackStatus::confirmed) motions[track.id] = track.state.mean;
  }
  return motions;
}

}  // namespace

ResidualComparison::ResidualComparison(const core::EvaluationParams& params,
                                       const core::ScoreListener& listener)
    : params_(params), listener_(listener) {
  params_.truth_memory = kForEver;  // all of it is known before the first scan
}

ResidualComparison::Topic& ResidualComparison::topicOf(const std::string& name) {
  const auto [found, is_new] = topics_.try_emplace(name);
  if (is_new) {
    found->second.evaluation = core::Evaluation(params_);
    found->second.evaluation.listen(underTopic(listener_, name));
  }
  return found->second;
}

void ResidualComparison::addTracks(const std::string& name, const core::TrackReport& report) {
  Topic& topic = topicOf(name);
  topic.tracker = report.tracker;
  topic.fused = report.fused;
  for (const core::Track& track : report.tracks)
    topic.sources.insert(track.sources.begin(), track.sources.end());
  topic.spans.add(report);
  topic.evaluation.addTruth(report.time, confirmedOf(report));
}

void ResidualComparison::addScan(const std::string& name, const core::Scan& scan) {
  for (auto& [track_topic, topic] : topics_) {
    if (isMadeOf(topic, scan.sensor)) topic.evaluation.addScan(name, scan);
  }
}

/// A source that is the name of another tracker stands for that one's sources.
bool ResidualComparison::isMadeOf(const Topic& topic, const std::string& sensor, int depth) const {
  if (topic.sources.count(sensor) > 0) return true;
  if (depth >= kDeepestFusion) return false;
  for (const auto& [name, other] : topics_) {
    if (&other != &topic && topic.sources.count(other.tracker) > 0 && isMadeOf(other, sensor, depth + 1))
      return true;
  }
  return false;
}

}  // namespace sightline::report
