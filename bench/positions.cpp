// Positions of one target from the directions of several stations, with the default settings: the core's
// position estimator and the plain intersection of rays, on recordings with a known or published path.
//
//   positions [--recordings DIR] [--table drone|fireball|tracker|field|misaligned] [--runs N]
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
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Cholesky>

#include "sightline/core/positions/position_estimator.h"
#include "sightline/core/positions/rays.h"
#include "sightline/core/positions/smoothing/position_smoother.h"
#include "sightline/core/positions/stations/station_alignment.h"
#include "sightline/core/positions/stations/station_noise.h"

#include "position_recordings.h"
#include "position_tables.h"
#include "processor_time.h"
#include "quantiles.h"

namespace sightline::bench {
namespace {

using core::Time;
using Vector = Eigen::Vector3d;

constexpr double kSeen = 0.1;     // [s] since its last sighting that a station counts as seeing the target
constexpr double kSettled = 1.0;  // [s] after the second station, from which a position is asked for
constexpr double kNeighbours = 0.15;  // [s] between sightings that are interpolated

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
    measurements.push_back(measurement);
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
  std::vector<core::StationMeasurement> measurements;  // taken

 private:
  const Recording& recording_;
  core::PositionEstimator estimator_;
  std::vector<core::StationNoise> noise_;
  std::vector<std::optional<Time>> last_;
};

/// Rays of all stations at an instant, with rates from straight lines over 0.3 s, slow errors in the
/// covariance.
std::vector<std::pair<int, core::Ray>> movingRaysAt(const Recording& recording,
                                                    const std::vector<std::vector<Seen>>& by_station,
                                                    double time, double slow_scale) {
  std::vector<std::pair<int, core::Ray>> rays;
  for (std::size_t station = 0; station < by_station.size(); ++station) {
    double n = 0.0, s1 = 0.0, s2 = 0.0, variance = 0.0;
    Vector y0 = Vector::Zero(), y1 = Vector::Zero();
    for (const Seen& seen : by_station[station]) {
      const double t = secondsOf(seen.time) - time;
      if (std::abs(t) > 0.15) continue;
      n += 1.0;
      s1 += t;
      s2 += t * t;
      y0 += seen.direction;
      y1 += t * seen.direction;
      variance = seen.variance;
    }
    const double D = n * s2 - s1 * s1;
    if (n < 4.0 || std::abs(s1 / n) > 0.03) continue;
    core::Ray ray;
    ray.origin = recording.origins[station];
    ray.direction = ((s2 * y0 - s1 * y1) / D).normalized();
    ray.covariance = slow_scale * slow_scale * variance * across(ray.direction);
    ray.motion = core::RayMotion{across(ray.direction) * ((n * y1 - s1 * y0) / D),
                                 variance * n / D * across(ray.direction), Vector::Zero()};
    rays.emplace_back(static_cast<int>(station), ray);
  }
  return rays;
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

/// Where the estimator told a position at a time of the path, and how many cameras saw the drone then.
struct Told {
  std::size_t at = 0;
  int seeing = 0;
};

void smoothedDrone(const std::vector<core::StationMeasurement>& measurements,
                   const std::vector<PathPoint>& path, const std::vector<Told>& told) {
  std::vector<Time> times;
  for (const Told& at : told) times.push_back(timeAt(path[at.at].time));
  for (const std::optional<double> lag : {std::optional<double>(), std::optional<double>(0.5)}) {
    const double start = processorTime();
    const auto positions = core::PositionSmoother().smooth(measurements, times, lag);
    const double used = processorTime() - start;
    std::vector<Sample> samples;
    for (std::size_t i = 0; i < told.size(); ++i) {
      if (!positions[i]) continue;
      const Vector error = positions[i]->mean.head<3>() - path[told[i].at].position;
      samples.push_back({told[i].seeing, error.norm(),
                         error.dot(positions[i]->covariance.topLeftCorner<3, 3>().llt().solve(error)) / 3.0,
                         (positions[i]->mean.tail<3>() - slopeOf(path, told[i].at)).norm()});
    }
    printHead(lag ? "drone_5_cameras: smoothed with a lag of 0.5 s" : "drone_5_cameras: smoothed", "m/s");
    printByStations(samples, path.size());
    std::printf("%.1f microseconds a sighting, the filter within\n",
                1e6 * used / static_cast<double>(measurements.size()));
  }
}

void drone(const std::string& folder) {
  const auto [recording, path] = readDrone(folder);
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
  std::vector<Told> told_at;
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
      told_at.push_back({next, seeing});
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
  smoothedDrone(follower.measurements, path, told_at);
}

void fireball(const std::string& folder) {
  const auto [recording, paths] = readFireball(folder);
  Follower follower(recording);
  std::vector<double> at_time, across_path, sigmas, between;
  for (const Seen& seen : recording.sightings) {
    follower.take(seen);
    const auto state = follower.positionAt(seen.time);
    if (!state || state->stations < 2) continue;
    PathDistance nearest{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
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

  // Clocks (P-14), ten instants a second.
  std::vector<std::vector<Seen>> by_station(recording.names.size());
  for (const Seen& seen : recording.sightings)
    by_station[static_cast<std::size_t>(seen.station)].push_back(seen);
  core::StationAlignmentParams alignment_params;
  alignment_params.orientation_sigma = 1e-3;
  core::StationAlignment alignment(alignment_params);
  const double first = secondsOf(recording.sightings.front().time),
               last = secondsOf(recording.sightings.back().time);
  for (double t = first; t <= last; t += 0.1) {
    std::vector<core::LocalView> views;
    for (const auto& [station, ray] : movingRaysAt(recording, by_station, t, 1.3))
      views.push_back({{station, 1}, ray, {0.5 * ray.covariance.trace(), 3.0}});
    for (std::size_t a = 0; a < views.size(); ++a)
      for (std::size_t b = a + 1; b < views.size(); ++b)
        alignment.take(timeAt(t), views[a], views[b], 2.0 / static_cast<double>(views.size()));
  }
  for (int station = 1; station < static_cast<int>(recording.names.size()); ++station) {
    if (const auto clock = alignment.clockDifference(0, station))
      std::printf("clock of %s against %s: %.4f +- %.4f s\n",
                  recording.names[static_cast<std::size_t>(station)].c_str(), recording.names[0].c_str(),
                  clock->difference, clock->sigma);
  }
}

int run(int argc, char** argv) {
  const char* shared = std::getenv("SIGHTLINE_SHARED_DIR");
  std::string recordings = shared ? std::string(shared) + "/data" : std::string(), table;
  int runs = 4;
  for (int i = 1; i < argc; ++i) {
    const std::string option = argv[i];
    if (i + 1 < argc && option == "--recordings")
      recordings = argv[++i];
    else if (i + 1 < argc && option == "--table")
      table = argv[++i];
    else if (i + 1 < argc && option == "--runs")
      runs = std::atoi(argv[++i]);
    else
      throw std::runtime_error(
          "positions: unknown option " + option +
          "; usage: positions [--recordings DIR] [--table drone|fireball|tracker|field|misaligned] [--runs "
          "N]");
  }
  const bool is_known = table.empty() || table == "drone" || table == "fireball" || table == "tracker" ||
                        table == "field" || table == "misaligned";
  if (!is_known)
    throw std::runtime_error("positions: no table is called " + table +
                             "; there are drone, fireball, tracker, field, misaligned");
  if (runs < 1) throw std::runtime_error("positions: --runs must be at least 1");
  if (recordings.empty() && table != "field" && table != "misaligned")
    throw std::runtime_error("positions: where the recordings are must be said with --recordings DIR");
  const auto wanted = [&](const char* name) { return table.empty() || table == name; };
  if (wanted("drone")) drone(recordings + "/drone_5_cameras");
  if (wanted("tracker")) trackedDrone(recordings + "/drone_5_cameras");
  if (wanted("fireball")) fireball(recordings + "/fireball_3_stations");
  if (wanted("field")) simulatedFields(runs);
  if (wanted("misaligned")) misalignedStation(runs);
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
