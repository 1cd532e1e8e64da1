#pragma once

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "sightline/core/estimators/estimator.h"
#include "sightline/core/model/chart.h"
#include "sightline/core/model/sighting.h"

/// Recorded sightings of one target, sensor by sensor, and an estimator run over them in a closed loop.
namespace sightline::bench {

/// One sensor's sightings without a long pause.
struct Stretch {
  std::string sensor;
  std::vector<core::Time> times;
  std::vector<core::Sighting> sightings;
};

/// Reads a CSV of time,sensor,azimuth,elevation,sigma_azimuth,sigma_elevation[,...] (a header line, seconds
/// and radians), split by sensor and at pauses longer than `pause` [s]; shorter than `min_sightings` is left
/// out.
inline std::vector<Stretch> readStretches(const std::string& file, double pause = 1.0,
                                          std::size_t min_sightings = 40) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(file + ": cannot be read");
  std::map<std::string, std::vector<Stretch>> of_sensor;
  std::string line;
  std::getline(stream, line);
  while (std::getline(stream, line)) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    if (cells.size() < 6) throw std::runtime_error(file + ": expected six columns in \"" + line + "\"");
    const core::Time time(core::durationOf(std::stod(cells[0])));
    const Eigen::Vector2d angles(std::stod(cells[2]), std::stod(cells[3]));
    const Eigen::Vector2d sigma(std::stod(cells[4]), std::stod(cells[5]));
    auto& stretches = of_sensor[cells[1]];
    if (stretches.empty() || core::seconds(time - stretches.back().times.back()) > pause)
      stretches.push_back({cells[1], {}, {}});
    stretches.back().times.push_back(time);
    stretches.back().sightings.push_back(
        core::sightingOf(angles, Eigen::Matrix2d(sigma.cwiseAbs2().asDiagonal())));
  }
  std::vector<Stretch> all;
  for (auto& [sensor, stretches] : of_sensor) {
    for (auto& stretch : stretches)
      if (stretch.times.size() >= min_sightings) all.push_back(std::move(stretch));
  }
  return all;
}

struct RecordingFigures {
  int sightings = 0, accepted = 0, restarts = 0, innovations = 0;
  double sum_nis = 0.0;       // of accepted and rejected alike, one step ahead, two channels
  std::vector<double> ahead;  // angle between the state half a second ahead and the sighting then [rad]

  double nis() const { return sum_nis / 2.0 / static_cast<double>(std::max(innovations, 1)); }
  /// Of a channel: an angle has two.
  double aheadRms() const {
    double sum = 0.0;
    for (const double angle : ahead) sum += angle * angle;
    return std::sqrt(sum / 2.0 / static_cast<double>(std::max<std::size_t>(ahead.size(), 1)));
  }
};

/// Runs estimators made by `make` over a stretch: a sighting within the gate updates, eight outside it in
/// turn, or one second without, start anew.
template <typename Make>
void follow(const Stretch& stretch, const Make& make, RecordingFigures& figures, double threshold = 15.2) {
  using core::seconds;
  std::unique_ptr<core::Estimator> estimator;
  core::Chart chart;
  int rejected = 0;
  core::Time last{};
  for (std::size_t i = 0; i < stretch.times.size(); ++i) {
    const core::Time time = stretch.times[i];
    const core::Sighting& sighting = stretch.sightings[i];
    ++figures.sightings;
    if (!estimator || rejected >= 8 || seconds(time - last) > 1.0) {
      if (estimator) ++figures.restarts;
      estimator = make();
      chart = core::Chart::around(sighting.direction);
      rejected = 0;
      last = time;
    } else {
      const auto state = estimator->stateAt(time);
      if (!chart.holds(state->angles())) {
        const core::Chart next = core::Chart::around(chart.directionAt(state->angles()));
        estimator->rotate(next.R_chart_tracking() * chart.R_chart_tracking().transpose());
        chart = next;
      }
    }
    core::Measurement measurement;
    measurement.time = time;
    measurement.position = chart.coordinatesOf(sighting.direction);
    measurement.covariance = chart.covarianceOf(sighting);
    if (const auto state = estimator->stateAt(time)) {
      const Eigen::Matrix2d S = state->anglesCovariance() + measurement.covariance;
      const Eigen::Vector2d innovation = core::angleDifference(measurement.position, state->angles());
      const double distance = innovation.dot(S.llt().solve(innovation));
      figures.sum_nis += distance;
      ++figures.innovations;
      if (!(distance <= threshold)) {
        ++rejected;
        continue;
      }
    }
    ++figures.accepted;
    rejected = 0;
    last = time;
    estimator->update(measurement);

    for (std::size_t j = i; j < stretch.times.size(); ++j) {  // the sighting nearest to half a second ahead
      const double miss = seconds(stretch.times[j] - time) - 0.5;
      if (miss < -0.03) continue;
      const bool next_is_nearer = j + 1 < stretch.times.size() &&
                                  std::abs(seconds(stretch.times[j + 1] - time) - 0.5) < std::abs(miss);
      if (next_is_nearer) continue;
      if (miss <= 0.03) {
        const auto state = estimator->stateAt(stretch.times[j]);
        figures.ahead.push_back(
            core::angleBetween(chart.directionAt(state->angles()), stretch.sightings[j].direction));
      }
      break;
    }
  }
}

}  // namespace sightline::bench
