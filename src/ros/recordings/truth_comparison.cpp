#include "sightline/ros/recordings/truth_comparison.h"

#include <algorithm>
#include <limits>

namespace sightline_ros {

namespace core = sightline::core;

namespace {

constexpr double kForEver = 2e9;  // [s]

bool isPartOf(const std::string& topic, const std::string& name) {
  return (topic + "/").find("/" + name + "/") != std::string::npos;
}

}  // namespace

TruthComparison::TruthComparison(const RecordedTruth& truth, core::EvaluationParams params,
                                 const core::ScoreListener& listener) {
  params.truth_memory = kForEver;  // all of it is known before the first message
  for (const auto& [sensor, motions] : truth.motions) {
    core::Evaluation& evaluation = by_sensor_.emplace(sensor, params).first->second;
    evaluation.listen(listener);
    for (const auto& [time, targets] : motions) evaluation.addTruth(time, targets);
  }
}

/// By the sensor's or tracker's name, or by a part of the topic's.
core::Evaluation* TruthComparison::evaluationFor(const std::string& topic, const std::string& name) {
  for (auto& [sensor, evaluation] : by_sensor_) {
    if (sensor.empty() || sensor == name || isPartOf(topic, sensor)) return &evaluation;
  }
  ++without_truth_[topic];
  return nullptr;
}

void TruthComparison::addScan(const std::string& topic, core::Scan scan) {
  if (core::Evaluation* evaluation = evaluationFor(topic, scan.sensor))
    evaluation->addScan(topic, std::move(scan));
}

void TruthComparison::addTracks(const std::string& topic, core::TrackReport report) {
  if (core::Evaluation* evaluation = evaluationFor(topic, report.tracker)) {
    evaluation->addTracks(topic, std::move(report));
  }
}

std::vector<core::EvaluationRow> TruthComparison::rows() const {
  std::vector<core::EvaluationRow> all;
  for (const auto& [sensor, evaluation] : by_sensor_) {
    const auto rows = evaluation.rows();
    all.insert(all.end(), rows.begin(), rows.end());
  }
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return std::make_pair(a.kind, a.topic) < std::make_pair(b.kind, b.topic);
  });
  return all;
}

std::vector<core::TargetRow> TruthComparison::targetRows() const {
  std::vector<core::TargetRow> all;
  for (const auto& [sensor, evaluation] : by_sensor_) {
    const auto rows = evaluation.targetRows();
    all.insert(all.end(), rows.begin(), rows.end());
  }
  return all;
}

double TruthComparison::bestSigma() const {
  return by_sensor_.size() == 1 ? by_sensor_.begin()->second.bestSigma()
                                : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace sightline_ros
