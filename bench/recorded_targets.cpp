#include "recorded_targets.h"

#include <array>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "sightline/core/model/sphere.h"

namespace sightline::bench {
namespace {

using Row = std::vector<std::string>;

constexpr std::size_t kStretches = 6;
constexpr std::size_t kLeastSightings = 40;
constexpr double kPause = 1.0;  // between stretches [s]

/// The lines of a CSV file below its header, each of at least `columns` cells.
std::vector<Row> rowsOf(const std::string& file, std::size_t columns) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(file + ": cannot be read");
  std::vector<Row> rows;
  std::string line;
  std::getline(stream, line);
  while (std::getline(stream, line)) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
    if (rows.back().size() < columns)
      throw std::runtime_error(file + ": expected " + std::to_string(columns) + " columns in \"" + line +
                               "\"");
  }
  return rows;
}

core::Time timeIn(const Row& row) {
  return core::Time(core::durationOf(std::stod(row[0])));
}

std::map<std::string, std::vector<Stretch>> sensorsOf(const std::string& file) {
  std::map<std::string, std::vector<Stretch>> sensors;
  for (Stretch& stretch : readStretches(file, kPause, kLeastSightings)) {
    auto& stretches = sensors[stretch.sensor];
    if (stretches.size() < kStretches) stretches.push_back(std::move(stretch));
  }
  return sensors;
}

/// Centres of the boxes of a thermal clip with one target, with a sigma of one pixel; field of view taken to
/// be 24 x 19 degrees over 320 x 256 pixels.
Stretch boxesOf(const std::string& file) {
  constexpr double kPixel = 24.0 / 320.0 * sightline::core::kDegree;
  Stretch stretch;
  for (const Row& row : rowsOf(file, 7)) {
    const core::Time time(core::durationOf(std::stod(row[1])));
    if (!stretch.times.empty() && time <= stretch.times.back()) continue;  // a second box
    const double x = std::stod(row[3]) + 0.5 * std::stod(row[5]);
    const double y = std::stod(row[4]) + 0.5 * std::stod(row[6]);
    stretch.times.push_back(time);
    stretch.sightings.push_back(core::sightingOf({-kPixel * (x - 160.0), -kPixel * (y - 128.0)},
                                                 Eigen::Matrix2d::Identity() * (kPixel * kPixel)));
  }
  return stretch;
}

/// Where the truth has each target: by target, (time, azimuth, elevation). Without an elevation (the harbour)
/// it is 0, as that of its sightings.
using Truth = std::map<std::string, std::map<core::Time, Eigen::Vector2d>>;

Truth truthOf(const std::string& file, bool has_elevation) {
  Truth truth;
  for (const Row& row : rowsOf(file, 4)) {
    truth[row[1]][timeIn(row)] = {std::stod(row[2]), has_elevation ? std::stod(row[3]) : 0.0};
  }
  return truth;
}

/// A sensor's sightings of one target: of each exposure the one nearest to the truth, within `radius` [rad].
/// Only the association is taken from the truth.
std::vector<Stretch> nearestTo(const std::map<core::Time, Eigen::Vector2d>& truth,
                               const std::vector<Row>& rows, const std::string& sensor, double radius) {
  std::map<core::Time, std::pair<double, const Row*>> nearest;
  for (const Row& row : rows) {
    const auto place = truth.find(timeIn(row));
    if (row[1] != sensor || place == truth.end()) continue;
    const Eigen::Vector2d angles(std::stod(row[2]), std::stod(row[3]));
    const double distance = core::angleBetween(core::directionOf(angles), core::directionOf(place->second));
    const auto known = nearest.find(place->first);
    if (distance <= radius && (known == nearest.end() || distance < known->second.first))
      nearest[place->first] = {distance, &row};
  }
  std::vector<Stretch> stretches;
  for (const auto& [time, found] : nearest) {
    const Row& row = *found.second;
    if (stretches.empty() || core::seconds(time - stretches.back().times.back()) > kPause)
      stretches.push_back({sensor, {}, {}});
    const Eigen::Vector2d sigma(std::stod(row[4]), std::stod(row[5]));
    stretches.back().times.push_back(time);
    stretches.back().sightings.push_back(core::sightingOf({std::stod(row[2]), std::stod(row[3])},
                                                          Eigen::Matrix2d(sigma.cwiseAbs2().asDiagonal())));
  }
  return stretches;
}

/// The first stretches that are long enough, of every target of a recording with truth.
void addTargets(const std::string& sightings, const std::string& truth, bool has_elevation,
                const std::string& sensor, double radius, std::vector<Stretch>& stretches) {
  const std::vector<Row> rows = rowsOf(sightings, 6);
  for (const auto& [target, path] : truthOf(truth, has_elevation)) {
    for (Stretch& stretch : nearestTo(path, rows, sensor, radius)) {
      if (stretch.times.size() >= kLeastSightings && stretches.size() < kStretches)
        stretches.push_back(std::move(stretch));
    }
  }
}

void addSensors(const std::string& folder, std::vector<Recorded>& all) {
  struct Named {
    const char *file, *sensor, *name;
    double best;  // NaN: not in section 8
  };
  const double none = std::nan("");
  const Named named[] = {{"fireball_3_stations", "DFNSMALL36", "fireball 3, 36", 0.084},
                         {"fireball_3_stations", "DFNSMALL38", "fireball 3, 38", 0.067},
                         {"fireball_3_stations", "DFNSMALL40", "fireball 3, 40", 0.065},
                         {"fireball_2_stations", "APO", "fireball 2, APO", 0.116},
                         {"fireball_2_stations", "KOP", "fireball 2, KOP", 1.200},
                         {"drone_5_cameras", "cam3", "drone, cam3", 0.189},
                         {"drone_5_cameras", "cam5", "drone, cam5", 0.195},
                         {"drone_5_cameras", "cam0", "drone, cam0", none},
                         {"drone_5_cameras", "cam1", "drone, cam1", none},
                         {"drone_5_cameras", "cam4", "drone, cam4", none}};
  std::map<std::string, std::map<std::string, std::vector<Stretch>>> read;
  for (const Named& entry : named) {
    if (read.count(entry.file) == 0)
      read[entry.file] = sensorsOf(folder + "/" + entry.file + "/sightings.csv");
    all.push_back({entry.name, !std::isnan(entry.best), entry.best, read[entry.file][entry.sensor]});
  }
}

void addClips(const std::string& folder, std::vector<Recorded>& all) {
  const std::pair<const char*, std::vector<const char*>> clips[] = {
      {"thermal, drones", {"DRONE_021", "DRONE_059", "DRONE_060", "DRONE_061", "DRONE_142"}},
      {"thermal, aircraft", {"AIRPLANE_019", "AIRPLANE_041", "AIRPLANE_051", "HELICOPTER_015"}}};
  for (const auto& [name, files] : clips) {
    Recorded recorded;
    recorded.name = name;
    for (const char* file : files)
      recorded.stretches.push_back(boxesOf(folder + "/infrared/IR_" + file + "_boxes.csv"));
    all.push_back(std::move(recorded));
  }
}

}  // namespace

std::vector<Recorded> recordedTargets(const std::string& folder) {
  std::vector<Recorded> all;
  addSensors(folder, all);
  addClips(folder, all);
  Recorded harbour, crossing;
  harbour.name = "harbour, IR";
  for (const char* scenario : {"scenario2", "scenario3", "scenario5"}) {
    const std::string path = folder + "/harbour/" + scenario;
    addTargets(path + "_sightings.csv", path + "_truth.csv", false, "IR", 4.0 * sightline::core::kDegree,
               harbour.stretches);
  }
  crossing.name = "crossing, run1";
  addTargets(folder + "/crossing/run1/sightings.csv", folder + "/crossing/run1/truth.csv", true, "camera",
             4e-3, crossing.stretches);
  all.push_back(std::move(harbour));
  all.push_back(std::move(crossing));
  return all;
}

}  // namespace sightline::bench
