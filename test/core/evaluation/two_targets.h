#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "sightline/core/evaluation/evaluation.h"

/// Two moving targets, and scans and reports of them, for the tests of the evaluation.
namespace sightline::test {

using namespace sightline::core;

inline Time at(double seconds_since_start) {
  return timeOf(1'000'000'000'000) + durationOf(seconds_since_start);
}

using Motions = std::map<std::uint32_t, Eigen::Vector4d>;

/// Target 1 on a sinusoid, target 2 half a radian beside it.
inline Eigen::Vector4d motion(std::uint32_t target, double t) {
  const double offset = target == 1 ? 0.0 : 0.5;
  return {0.2 * std::sin(t) + offset, 0.1 * std::cos(t), 0.2 * std::cos(t), -0.1 * std::sin(t)};
}

inline Motions both(double t) {
  return {{1, motion(1, t)}, {2, motion(2, t)}};
}

inline Sighting sightingAt(const Eigen::Vector2d& angles, double sigma) {
  return sightingOf(angles, Eigen::Matrix2d::Identity() * sigma * sigma);
}

inline Scan scan(double t, std::vector<Sighting> sightings, const std::string& sensor = "camera") {
  Scan result;
  result.time = at(t);
  result.sensor = sensor;
  result.sightings = std::move(sightings);
  return result;
}

inline Track track(std::uint32_t id, const Eigen::Vector4d& mean, double sigma = 0.01,
                   TrackStatus status = TrackStatus::confirmed) {
  Track result;
  result.id = id;
  result.status = status;
  result.state.mean = mean;
  result.state.covariance.diagonal().setConstant(sigma * sigma);
  return result;
}

inline TrackReport report(double t, std::vector<Track> tracks) {
  return {at(t), "tracker", false, std::move(tracks)};
}

inline EvaluationRow rowOf(const Evaluation& evaluation, const std::string& topic) {
  for (const EvaluationRow& row : evaluation.rows()) {
    if (row.topic == topic) return row;
  }
  ADD_FAILURE() << "no row for " << topic;
  return {};
}

}  // namespace sightline::test
