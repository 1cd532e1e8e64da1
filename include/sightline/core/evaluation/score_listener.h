#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include <Eigen/Core>

#include "sightline/core/evaluation/gospa.h"
#include "sightline/core/evaluation/metrics.h"
#include "sightline/core/evaluation/ospa.h"
#include "sightline/core/model/time.h"

namespace sightline::core {

/// A sighting or track that was assigned to a target, and its error; one point of a plot.
struct ScoredPair {
  std::string topic;
  std::string name;  ///< sensor or tracker
  Time time{};
  std::uint32_t target = 0;
  std::uint32_t track = 0;  ///< id; 0 for a sighting
  Eigen::Vector2d angles;   ///< (azimuth, elevation) of the sighting or track, tracking frame [rad]
  Eigen::Vector2d truth;    ///< (azimuth, elevation) of the target, tracking frame [rad]
  DirectionError error;
};

/// The set metrics of one report.
struct ScoredReport {
  std::string topic;
  Time time{};
  Gospa gospa;
  Ospa ospa;  ///< of the same order and cutoff
};

/// Called for every pair and every report that is scored; either function may be empty.
struct ScoreListener {
  std::function<void(const ScoredPair&)> pair;
  std::function<void(const ScoredReport&)> report;
};

}  // namespace sightline::core
