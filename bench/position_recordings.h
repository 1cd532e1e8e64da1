#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/model/time.h"

/// Recordings of one target seen from several places, with a known or published path.
namespace sightline::bench {

/// A sighting in the common frame.
struct Seen {
  core::Time time{};
  int station = 0;
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
  double variance = 0.0;  // of one angle across it, as stated [rad^2]
};

struct Recording {
  std::vector<std::string> names;
  std::vector<Eigen::Vector3d> origins;  // [m]
  std::vector<Eigen::Matrix3d> R_common_station;
  std::vector<Seen> sightings;  // in order of time
};

/// A point of a known path.
struct PathPoint {
  double time = 0.0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
};

/// drone_5_cameras: metres east, north and up of the first camera; its RTK path.
struct DroneRecording {
  Recording recording;
  std::vector<PathPoint> path;
};

/// fireball_3_stations: east, north, up at the mean of the stations; the published paths by method.
struct FireballRecording {
  Recording recording;
  std::map<std::string, std::vector<PathPoint>> paths;
};

/// All throw std::runtime_error naming a file that cannot be read.
DroneRecording readDrone(const std::string& folder);
FireballRecording readFireball(const std::string& folder);

inline double secondsOf(core::Time time) {
  return core::seconds(time.time_since_epoch());
}

inline core::Time timeAt(double seconds) {
  return core::Time(core::durationOf(seconds));
}

/// Slope of the path by least squares over 0.3 s on either side; NaN at its gaps.
Eigen::Vector3d slopeOf(const std::vector<PathPoint>& path, std::size_t at);

/// Distance of a point from a path, at the same time and across it; infinite where the path is not.
struct PathDistance {
  double at_time = 0.0, across = 0.0;  // [m]
};
PathDistance distanceTo(const std::vector<PathPoint>& path, double time, const Eigen::Vector3d& position);

/// One comparison with the path.
struct Sample {
  int stations = 0;
  double distance = 0.0, nees = 0.0;
  double velocity_difference = std::nan("");
};

/// A table of them, by the number of cameras; `of`: how many there could be.
void printHead(const char* title, const char* last);
void printByStations(const std::vector<Sample>& samples, std::size_t of);

}  // namespace sightline::bench
