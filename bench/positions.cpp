// Positions of one target from the directions of several stations, with the default settings: the core's
// position estimator and the plain intersection of rays, on recordings with a known or published path.
//
//   positions [--recordings DIR] [--table drone|fireball]
//
// DIR holds drone_5_cameras and fireball_3_stations (default: where SIGHTLINE_SHARED_DIR/data is). Figures of
// the drone are taken at the times of its RTK path, with what had been seen by then, and split by how many
// cameras saw it within the last 0.1 s: distance [m], ANEES of the position (1 is right), difference of the
// velocity from the slope of the path over 0.6 s [m/s]. The rays beside it use, at each instant, sightings
// interpolated between neighbours (so also the next one), weighted by the stated sigma. The fireball's
// distance is that to the nearest of four published paths, at the same time and across the path.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "sightline/core/model/sphere.h"
#include "sightline/core/positions/position_estimator.h"
#include "sightline/core/positions/rays.h"
#include "sightline/core/positions/station_noise.h"

#include "processor_time.h"
#include "quantiles.h"

namespace sightline::bench {
namespace {

using core::Time;
using Vector = Eigen::Vector3d;

constexpr double kSeen = 0.1;     // [s] since its last sighting that a station counts as seeing the target
constexpr double kSettled = 1.0;  // [s] after the second station, from which a position is asked for
constexpr double kNeighbours = 0.15;  // [s] between sightings that are interpolated
constexpr double kSlope = 0.3;        // [s] on either side, of the path's slope

/// A sighting in the common frame.
struct Seen {
  Time time{};
  int station = 0;
  Vector direction = Vector::UnitX();
  double variance = 0.0;  // of one angle across it, as stated [rad^2]
};

struct Recording {
  std::vector<std::string> names;
  std::vector<Vector> origins;  // [m]
  std::vector<Seen> sightings;  // in order of time
};

/// A point of a known path.
struct PathPoint {
  double time = 0.0;
  Vector position = Vector::Zero();
};

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

double secondsOf(Time time) {
  return core::seconds(time.time_since_epoch());
}

Time timeAt(double seconds) {
  return Time(core::durationOf(seconds));
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

/// Sightings of time,sensor,azimuth,elevation,sigma_azimuth,sigma_elevation turned by R_common_station.
void readSightings(const std::string& file, const std::vector<Eigen::Matrix3d>& R, Recording& recording) {
  for (const auto& cells : readRows(file, 6)) {
    const auto name = std::find(recording.names.begin(), recording.names.end(), cells[1]);
    if (name == recording.names.end()) throw std::runtime_error(file + ": no station is called " + cells[1]);
    Seen seen;
    seen.time = timeAt(std::stod(cells[0]));
    seen.station = static_cast<int>(name - recording.names.begin());
    const Eigen::Vector2d angles(std::stod(cells[2]), std::stod(cells[3]));
    const double sigma_azimuth = std::stod(cells[4]) * std::cos(angles.y());
    const double sigma_elevation = std::stod(cells[5]);
    seen.direction = R[static_cast<std::size_t>(seen.station)] * core::directionOf(angles);
    seen.variance = 0.5 * (sigma_azimuth * sigma_azimuth + sigma_elevation * sigma_elevation);
    recording.sightings.push_back(seen);
  }
  std::stable_sort(recording.sightings.begin(), recording.sightings.end(),
                   [](const Seen& a, const Seen& b) { return a.time < b.time; });
}

Eigen::Matrix3d across(const Vector& direction) {
  return Eigen::Matrix3d::Identity() - direction * direction.transpose();
}

/// The estimator with what it learns of the stations.
class Follower {
 public:
  explicit Follower(const Recording& recording)
      : recording_(recording), noise_(recording.names.size()), last_(recording.names.size()) {}

  void take(const Seen& seen) {
    const auto station = static_cast<std::size_t>(seen.station);
    core::StationNoise& noise = noise_[station];
    noise.noteDirection(seen.time, seen.direction, seen.variance);
    core::StationMeasurement measurement;
    measurement.time = seen.time;
    measurement.station = seen.station;
    measurement.ray.origin = recording_.origins[station];
    measurement.ray.direction = seen.direction;
    const double white = noise.whiteScale() * seen.variance;
    const double reference = core::slowReference(seen.variance, white);
    measurement.ray.covariance = white * across(seen.direction);
    measurement.slow = noise.slowError(reference);
    const core::MeasurementUse use = estimator_.update(measurement);
    if (use == core::MeasurementUse::started) ++starts;
    if (use == core::MeasurementUse::restarted) ++losses;
    if (const auto slow = estimator_.slowErrorOf(seen.station))
      noise.noteSlowError(*slow, reference, slow->since);
    last_[station] = seen.time;
  }

  std::optional<core::PositionState> positionAt(Time time) const {
    const auto state = estimator_.stateAt(time);
    if (!state || !estimator_.isPosition(*state)) return std::nullopt;
    return state;
  }

  int seeing(Time time) const {
    return static_cast<int>(std::count_if(last_.begin(), last_.end(), [time](const auto& last) {
      return last && core::seconds(time - *last) < kSeen;
    }));
  }

  const core::StationNoise& noiseOf(std::size_t station) const { return noise_[station]; }

  int starts = 0, losses = 0;

 private:
  const Recording& recording_;
  core::PositionEstimator estimator_;
  std::vector<core::StationNoise> noise_;
  std::vector<std::optional<Time>> last_;
};

/// One comparison with the path.
struct Sample {
  int stations = 0;
  double distance = 0.0, nees = 0.0;
  double velocity_difference = std::nan("");
};

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

/// Rays of all stations at an instant, interpolated between neighbours.
std::vector<core::Ray> raysAt(const Recording& recording, const std::vector<std::vector<Seen>>& by_station,
                              Time time) {
  std::vector<core::Ray> rays;
  for (std::size_t station = 0; station < by_station.size(); ++station) {
    const auto& seen = by_station[station];
    const auto after =
        std::lower_bound(seen.begin(), seen.end(), time, [](const Seen& a, Time t) { return a.time < t; });
    if (after == seen.begin() || after == seen.end()) continue;
    const auto before = after - 1;
    const double gap = core::seconds(after->time - before->time);
    if (gap > kNeighbours || !(gap > 0.0)) continue;
    const double share = core::seconds(time - before->time) / gap;
    core::Ray ray;
    ray.origin = recording.origins[station];
    ray.direction = ((1.0 - share) * before->direction + share * after->direction).normalized();
    ray.covariance = after->variance * across(ray.direction);
    rays.push_back(ray);
  }
  return rays;
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

void drone(const std::string& folder) {
  Recording recording;
  for (const auto& cells : readRows(folder + "/stations.csv", 4)) {
    recording.names.push_back(cells[0]);
    recording.origins.emplace_back(std::stod(cells[1]), std::stod(cells[2]), std::stod(cells[3]));
  }
  const std::vector<Eigen::Matrix3d> parallel(recording.names.size(), Eigen::Matrix3d::Identity());
  readSightings(folder + "/sightings.csv", parallel, recording);
  std::vector<PathPoint> path;
  for (const auto& cells : readRows(folder + "/truth_position.csv", 4))
    path.push_back({std::stod(cells[0]), {std::stod(cells[1]), std::stod(cells[2]), std::stod(cells[3])}});

  std::vector<std::vector<Seen>> by_station(recording.names.size());
  for (const Seen& seen : recording.sightings)
    by_station[static_cast<std::size_t>(seen.station)].push_back(seen);
  std::vector<Sample> of_rays;
  for (const PathPoint& point : path) {
    const auto rays = raysAt(recording, by_station, timeAt(point.time));
    const core::Crossing crossing = core::intersect(rays);
    if (crossing.verdict != core::CrossingVerdict::crossing) continue;
    const Vector error = crossing.at.point - point.position;
    of_rays.push_back({static_cast<int>(rays.size()), error.norm(),
                       error.dot(crossing.at.covariance.llt().solve(error)) / 3.0});
  }

  Follower follower(recording);
  std::vector<Sample> samples;
  std::size_t next = 0, asked = 0, told = 0;
  double together_since = std::nan(""), alone_since = std::nan("");  // [s]
  std::vector<double> alone_for;  // how long a position went on with one camera [s]
  const double start = processorTime();
  for (const Seen& seen : recording.sightings) {
    for (; next < path.size() && timeAt(path[next].time) < seen.time; ++next) {
      const PathPoint& point = path[next];
      const Time time = timeAt(point.time);
      const int seeing = follower.seeing(time);
      if (seeing < 2) together_since = std::nan("");
      if (seeing >= 2 && std::isnan(together_since)) together_since = point.time;
      const bool is_asked = point.time - together_since > kSettled;
      if (is_asked) ++asked;
      const auto state = follower.positionAt(time);
      if (state && seeing == 1) {
        if (std::isnan(alone_since)) {
          alone_since = point.time;
          alone_for.push_back(0.0);
        }
        alone_for.back() = point.time - alone_since;
      } else {
        alone_since = std::nan("");
      }
      if (!state) continue;
      if (is_asked) ++told;
      const Vector error = state->mean.head<3>() - point.position;
      const Vector slope = slopeOf(path, next);
      samples.push_back({seeing, error.norm(),
                         error.dot(state->covariance.topLeftCorner<3, 3>().llt().solve(error)) / 3.0,
                         (state->mean.tail<3>() - slope).norm()});
    }
    follower.take(seen);
  }
  const double used = processorTime() - start;

  printHead("drone_5_cameras: rays at one instant, weighted by stated sigma", "");
  printByStations(of_rays, path.size());
  printHead("drone_5_cameras: position estimator", "m/s");
  printByStations(samples, path.size());
  std::printf("share of the time from 1 s after the second camera with a position: %.4f\n",
              static_cast<double>(told) / static_cast<double>(asked));
  std::printf("positions that went on with one camera alone: %zu, for %.2f s (median), %.2f s at the most\n",
              alone_for.size(), median(alone_for), quantile(alone_for, 1.0));
  std::printf("started %d times, lost %d times; %.1f microseconds a sighting, with the queries\n",
              follower.starts, follower.losses, 1e6 * used / static_cast<double>(recording.sightings.size()));
  for (std::size_t i = 0; i < recording.names.size(); ++i) {
    const core::StationNoise& noise = follower.noiseOf(i);
    std::printf("%s: white noise %.2f, slow error %.2f of the stated sigma, %.1f s\n",
                recording.names[i].c_str(), std::sqrt(noise.whiteScale()), noise.slowScale(),
                noise.timeConstant());
  }
}

/// Distance of a point from a path, at the same time and across it.
struct PathDistance {
  double at_time = std::numeric_limits<double>::infinity();
  double across = std::numeric_limits<double>::infinity();
};

PathDistance distanceTo(const std::vector<PathPoint>& path, double time, const Vector& position) {
  PathDistance distance;
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

void fireball(const std::string& folder) {
  Recording recording;
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
  std::vector<Eigen::Matrix3d> R;
  for (std::size_t i = 0; i < centred.size(); ++i) {
    recording.origins.push_back(R_world * (centred[i] - origin));
    R.push_back(R_world * horizons[i].transpose());
  }
  readSightings(folder + "/sightings.csv", R, recording);
  std::map<std::string, std::vector<PathPoint>> paths;
  for (const auto& cells : readRows(folder + "/reference_positions.csv", 6)) {
    const Vector point = earthCentred(std::stod(cells[3]), std::stod(cells[4]), std::stod(cells[5]));
    paths[cells[0]].push_back({std::stod(cells[1]), R_world * (point - origin)});
  }

  Follower follower(recording);
  std::vector<double> at_time, across_path, sigmas, between;
  for (const Seen& seen : recording.sightings) {
    follower.take(seen);
    const auto state = follower.positionAt(seen.time);
    if (!state || state->stations < 2) continue;
    PathDistance nearest;
    for (const auto& [name, path] : paths) {
      const PathDistance distance = distanceTo(path, secondsOf(seen.time), state->mean.head<3>());
      nearest.at_time = std::min(nearest.at_time, distance.at_time);
      nearest.across = std::min(nearest.across, distance.across);
    }
    if (std::isfinite(nearest.at_time)) at_time.push_back(nearest.at_time);
    across_path.push_back(nearest.across);
    sigmas.push_back(std::sqrt(state->covariance.topLeftCorner<3, 3>().trace()));
  }
  for (const auto& [name, path] : paths) {  // how far the published paths are from each other
    for (const PathPoint& point : path) {
      for (const auto& [other_name, other] : paths)
        if (other_name > name) between.push_back(distanceTo(other, point.time, point.position).at_time);
    }
  }
  std::printf("\nfireball_3_stations: position estimator, clocks as recorded\n");
  std::printf(
      "distance to the nearest published path at the same time: median %.0f m, 95 %% %.0f m; across it: "
      "median %.0f m, 95 %% %.0f m; %zu positions\n",
      median(at_time), quantile(at_time, 0.95), median(across_path), quantile(across_path, 0.95),
      across_path.size());
  std::printf(
      "stated standard deviation: median %.0f m; the published paths from each other: median %.0f m\n",
      median(sigmas), median(between));
  std::printf("started %d times, lost %d times\n", follower.starts, follower.losses);
  for (std::size_t i = 0; i < recording.names.size(); ++i) {
    std::printf("%s: white noise %.2f, slow error %.2f of the stated sigma\n", recording.names[i].c_str(),
                std::sqrt(follower.noiseOf(i).whiteScale()), follower.noiseOf(i).slowScale());
  }
}

int run(int argc, char** argv) {
  const char* shared = std::getenv("SIGHTLINE_SHARED_DIR");
  std::string recordings = shared ? std::string(shared) + "/data" : std::string(), table;
  for (int i = 1; i < argc; ++i) {
    const std::string option = argv[i];
    if (i + 1 < argc && option == "--recordings")
      recordings = argv[++i];
    else if (i + 1 < argc && option == "--table")
      table = argv[++i];
    else
      throw std::runtime_error("positions: unknown option " + option +
                               "; usage: positions [--recordings DIR] [--table drone|fireball]");
  }
  if (recordings.empty())
    throw std::runtime_error("positions: where the recordings are must be said with --recordings DIR");
  if (!table.empty() && table != "drone" && table != "fireball")
    throw std::runtime_error("positions: no table is called " + table + "; there are drone and fireball");
  if (table.empty() || table == "drone") drone(recordings + "/drone_5_cameras");
  if (table.empty() || table == "fireball") fireball(recordings + "/fireball_3_stations");
  return 0;
}

}  // namespace
}  // namespace sightline::bench

int main(int argc, char** argv) {
  try {
    return sightline::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
