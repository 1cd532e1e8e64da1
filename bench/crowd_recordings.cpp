#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <sstream>
#include <stdexcept>

#include "sightline/core/model/sphere.h"

#include "crowd.h"

namespace sightline::bench {
namespace {

std::vector<std::vector<std::string>> readRows(const std::string& file, std::size_t columns) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(file + ": cannot be read");
  std::vector<std::vector<std::string>> rows;
  std::string line;
  std::getline(stream, line);  // the header
  while (std::getline(stream, line)) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    if (cells.size() < columns)
      throw std::runtime_error(file + ": expected " + std::to_string(columns) + " columns in \"" + line +
                               "\"");
    rows.push_back(std::move(cells));
  }
  return rows;
}

core::Time timeOf(double seconds) {
  return core::Time(core::durationOf(seconds));
}

core::Sighting sightingAt(const Eigen::Vector2d& angles, double sigma) {
  return core::sightingOf(angles, Eigen::Matrix2d(sigma * sigma * Eigen::Matrix2d::Identity()));
}

}  // namespace

Eigen::Vector2d CrowdTarget::placeAt(double time) const {
  const double phase = 2.0 * sightline::core::kPi * (time - meeting) / period;
  return at + (time - meeting) * rate + std::sin(phase) * weave;
}

CrowdRecording record(const CrowdScenario& scenario, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> gauss;
  std::uniform_real_distribution<double> uniform;
  std::poisson_distribution<int> clutter(scenario.clutter);
  CrowdRecording recording;
  recording.stated_sigma = scenario.sigma;
  const auto scans = static_cast<int>(scenario.duration * scenario.rate) * scenario.sensors;
  for (int k = 0; k < scans; ++k) {
    const double time = (k + 0.5) / (scenario.rate * scenario.sensors);
    core::Scan scan;
    scan.time = timeOf(time);
    scan.sensor = "camera_" + std::to_string(1 + k % scenario.sensors);
    std::map<std::uint32_t, Eigen::Vector2d> truth;
    for (std::size_t i = 0; i < scenario.targets.size(); ++i) {
      const CrowdTarget& target = scenario.targets[i];
      if (time < target.from || time >= target.to) continue;
      const Eigen::Vector2d at = target.placeAt(time);
      const Eigen::Vector2d off = (at - scenario.centre).cwiseAbs();
      if ((off.array() > scenario.half_field.array()).any()) continue;
      truth[static_cast<std::uint32_t>(i + 1)] = at;
      if (time >= target.hidden_from && time < target.hidden_to) continue;
      if (uniform(random) >= scenario.detection_probability) continue;
      const Eigen::Vector2d noise(gauss(random), gauss(random));
      scan.sightings.push_back(sightingAt(at + scenario.sigma * noise, scenario.sigma));
    }
    const int false_ones = scenario.clutter > 0.0 ? clutter(random) : 0;
    for (int j = 0; j < false_ones; ++j) {
      const Eigen::Vector2d place(2.0 * uniform(random) - 1.0, 2.0 * uniform(random) - 1.0);
      scan.sightings.push_back(
          sightingAt(scenario.centre + scenario.half_field.cwiseProduct(place), scenario.sigma));
    }
    std::shuffle(scan.sightings.begin(), scan.sightings.end(), random);
    recording.scans.push_back(std::move(scan));
    recording.truths.push_back(std::move(truth));
  }
  return recording;
}

CrowdRecording readCrowd(const std::string& folder) {
  const auto sightings = readRows(folder + "/sightings.csv", 7);
  const auto truths = readRows(folder + "/truth.csv", 4);
  if (sightings.empty()) throw std::runtime_error(folder + "/sightings.csv: has no sightings");
  CrowdRecording recording;
  const auto first_time = std::stod(sightings.front()[0]), last_time = std::stod(sightings.back()[0]);
  const auto first_scan = std::stol(sightings.front()[6]), last_scan = std::stol(sightings.back()[6]);
  const double interval =
      (last_time - first_time) / static_cast<double>(std::max(last_scan - first_scan, 1L));
  const auto scans = static_cast<std::size_t>(last_scan - first_scan + 1);
  recording.scans.resize(scans);
  recording.truths.resize(scans);
  for (std::size_t k = 0; k < scans; ++k) {
    recording.scans[k].time = timeOf(first_time + static_cast<double>(k) * interval);
    recording.scans[k].sensor = sightings.front()[1];
  }
  for (const auto& row : sightings) {
    const auto k = static_cast<std::size_t>(std::stol(row[6]) - first_scan);
    recording.stated_sigma = std::stod(row[4]);
    recording.scans.at(k).sightings.push_back(
        sightingAt({std::stod(row[2]), std::stod(row[3])}, recording.stated_sigma));
  }
  for (const auto& row : truths) {
    const double scan = std::round((std::stod(row[0]) - first_time) / interval);
    if (scan < 0.0 || scan >= static_cast<double>(scans)) continue;
    recording.truths[static_cast<std::size_t>(scan)][static_cast<std::uint32_t>(std::stoul(row[1]))] = {
        std::stod(row[2]), std::stod(row[3])};
  }
  return recording;
}

}  // namespace sightline::bench
