#include "position_recordings.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "sightline/core/model/sphere.h"

#include "quantiles.h"

namespace sightline::bench {
namespace {

using Vector = Eigen::Vector3d;

constexpr double kSlope = 0.3;  // [s] on either side, of the path's slope

std::vector<std::vector<std::string>> readRows(const std::string& file, std::size_t columns) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(file + ": cannot be read");
  std::vector<std::vector<std::string>> rows;
  std::string line;
  std::getline(stream, line);
  while (std::getline(stream, line)) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    if (cells.size() < columns)
      throw std::runtime_error(file + ": expected " + std::to_string(columns) + " columns in \"" + line +
                               "\"");
    rows.push_back(cells);
  }
  return rows;
}

/// Earth-centred position of WGS-84 coordinates [degree, degree, m].
Vector earthCentred(double latitude, double longitude, double height) {
  constexpr double kEquator = 6378137.0, kFlattening = 1.0 / 298.257223563;
  const double e2 = kFlattening * (2.0 - kFlattening);
  const double sine = std::sin(latitude * core::kDegree), cosine = std::cos(latitude * core::kDegree);
  const double N = kEquator / std::sqrt(1.0 - e2 * sine * sine);
  return {(N + height) * cosine * std::cos(longitude * core::kDegree),
          (N + height) * cosine * std::sin(longitude * core::kDegree), (N * (1.0 - e2) + height) * sine};
}

/// Rows east, north, up: turns earth-centred vectors to the horizon of a place [degree].
Eigen::Matrix3d horizonOf(double latitude, double longitude) {
  const double s = std::sin(latitude * core::kDegree), c = std::cos(latitude * core::kDegree);
  const double sl = std::sin(longitude * core::kDegree), cl = std::cos(longitude * core::kDegree);
  Eigen::Matrix3d R;
  R << -sl, cl, 0.0, -s * cl, -s * sl, c, c * cl, c * sl, s;
  return R;
}

/// Sightings of time,sensor,azimuth,elevation,sigma_azimuth,sigma_elevation turned to the common frame.
void readSightings(const std::string& file, Recording& recording) {
  for (const auto& cells : readRows(file, 6)) {
    const auto name = std::find(recording.names.begin(), recording.names.end(), cells[1]);
    if (name == recording.names.end()) throw std::runtime_error(file + ": no station is called " + cells[1]);
    Seen seen;
    seen.time = timeAt(std::stod(cells[0]));
    seen.station = static_cast<int>(name - recording.names.begin());
    const Eigen::Vector2d angles(std::stod(cells[2]), std::stod(cells[3]));
    const double sigma_azimuth = std::stod(cells[4]) * std::cos(angles.y());
    const double sigma_elevation = std::stod(cells[5]);
    seen.direction =
        recording.R_common_station[static_cast<std::size_t>(seen.station)] * core::directionOf(angles);
    seen.variance = 0.5 * (sigma_azimuth * sigma_azimuth + sigma_elevation * sigma_elevation);
    recording.sightings.push_back(seen);
  }
  std::stable_sort(recording.sightings.begin(), recording.sightings.end(),
                   [](const Seen& a, const Seen& b) { return a.time < b.time; });
}

void printFigures(const char* name, const std::vector<Sample>& samples,
                  const std::function<bool(int)>& wanted, std::size_t of) {
  std::vector<double> distances, differences;
  double squares = 0.0, nees = 0.0;
  for (const Sample& sample : samples) {
    if (!wanted(sample.stations)) continue;
    distances.push_back(sample.distance);
    squares += sample.distance * sample.distance;
    nees += sample.nees;
    if (!std::isnan(sample.velocity_difference)) differences.push_back(sample.velocity_difference);
  }
  if (distances.empty()) return;
  const auto count = static_cast<double>(distances.size());
  std::printf("%-26s %6.3f %8.3f %8.3f %8.3f %8.2f %8.2f", name, count / static_cast<double>(of),
              std::sqrt(squares / count), median(distances), quantile(distances, 0.95),
              *std::max_element(distances.begin(), distances.end()), nees / count);
  if (differences.empty())
    std::printf("        -\n");
  else
    std::printf(" %8.3f\n", median(differences));
}

}  // namespace

/// Slope of the path by least squares over kSlope on either side; NaN at its gaps.
Vector slopeOf(const std::vector<PathPoint>& path, std::size_t at) {
  double n = 0.0, s1 = 0.0, s2 = 0.0;
  Vector y = Vector::Zero(), ty = Vector::Zero();
  const auto add = [&](std::size_t i) {
    const double t = path[i].time - path[at].time;
    if (std::abs(t) > kSlope) return false;
    n += 1.0;
    s1 += t;
    s2 += t * t;
    y += path[i].position - path[at].position;
    ty += t * (path[i].position - path[at].position);
    return true;
  };
  for (std::size_t i = at; i < path.size() && add(i); ++i) {
  }
  for (std::size_t i = at; i-- > 0 && add(i);) {
  }
  const double D = n * s2 - s1 * s1;
  if (n < 8.0 || std::abs(s1 / n) > 0.02) return Vector::Constant(std::nan(""));
  return (n * ty - s1 * y) / D;
}

PathDistance distanceTo(const std::vector<PathPoint>& path, double time, const Vector& position) {
  PathDistance distance{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const PathPoint &a = path[i], &b = path[i + 1];
    const Vector along = b.position - a.position;
    const double share = std::clamp((position - a.position).dot(along) / along.squaredNorm(), 0.0, 1.0);
    distance.across = std::min(distance.across, (position - a.position - share * along).norm());
    if (time < a.time || time > b.time) continue;
    const double part = (time - a.time) / (b.time - a.time);
    distance.at_time = (position - a.position - part * along).norm();
  }
  return distance;
}

void printHead(const char* title, const char* last) {
  std::printf("\n%s\n%-26s %6s %8s %8s %8s %8s %8s %8s\n", title, "", "share", "rms m", "median m", "95 % m",
              "max m", "ANEES", last);
}

void printByStations(const std::vector<Sample>& samples, std::size_t of) {
  printFigures(
      "two cameras or more", samples, [](int n) { return n >= 2; }, of);
  printFigures(
      "  two", samples, [](int n) { return n == 2; }, of);
  printFigures(
      "  three", samples, [](int n) { return n == 3; }, of);
  printFigures(
      "  four", samples, [](int n) { return n == 4; }, of);
  printFigures(
      "  five", samples, [](int n) { return n == 5; }, of);
  printFigures(
      "one camera alone", samples, [](int n) { return n == 1; }, of);
  printFigures(
      "all with a position", samples, [](int) { return true; }, of);
}

DroneRecording readDrone(const std::string& folder) {
  DroneRecording drone;
  Recording& recording = drone.recording;
  for (const auto& cells : readRows(folder + "/stations.csv", 4)) {
    recording.names.push_back(cells[0]);
    recording.origins.emplace_back(std::stod(cells[1]), std::stod(cells[2]), std::stod(cells[3]));
  }
  recording.R_common_station.assign(recording.names.size(), Eigen::Matrix3d::Identity());
  readSightings(folder + "/sightings.csv", recording);
  for (const auto& cells : readRows(folder + "/truth_position.csv", 4))
    drone.path.push_back(
        {std::stod(cells[0]), {std::stod(cells[1]), std::stod(cells[2]), std::stod(cells[3])}});

  return drone;
}

FireballRecording readFireball(const std::string& folder) {
  FireballRecording fireball;
  Recording& recording = fireball.recording;
  std::vector<Vector> centred;
  std::vector<Eigen::Matrix3d> horizons;
  double latitude = 0.0, longitude = 0.0, height = 0.0;
  const auto stations = readRows(folder + "/stations.csv", 4);
  for (const auto& cells : stations) {
    recording.names.push_back(cells[0]);
    centred.push_back(earthCentred(std::stod(cells[1]), std::stod(cells[2]), std::stod(cells[3])));
    horizons.push_back(horizonOf(std::stod(cells[1]), std::stod(cells[2])));
    latitude += std::stod(cells[1]) / static_cast<double>(stations.size());
    longitude += std::stod(cells[2]) / static_cast<double>(stations.size());
    height += std::stod(cells[3]) / static_cast<double>(stations.size());
  }
  const Vector origin = earthCentred(latitude, longitude, height);
  const Eigen::Matrix3d R_world = horizonOf(latitude, longitude);
  for (std::size_t i = 0; i < centred.size(); ++i) {
    recording.origins.push_back(R_world * (centred[i] - origin));
    recording.R_common_station.push_back(R_world * horizons[i].transpose());
  }
  readSightings(folder + "/sightings.csv", recording);
  for (const auto& cells : readRows(folder + "/reference_positions.csv", 6)) {
    const Vector point = earthCentred(std::stod(cells[3]), std::stod(cells[4]), std::stod(cells[5]));
    fireball.paths[cells[0]].push_back({std::stod(cells[1]), R_world * (point - origin)});
  }
  return fireball;
}

}  // namespace sightline::bench
