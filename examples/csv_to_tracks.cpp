// From a CSV file of sightings to tracks, with the core alone: no ROS.
//
//   csv_to_tracks SIGHTINGS.csv
//
// Columns: time,sensor,azimuth,elevation,sigma_azimuth,sigma_elevation (seconds and radians), in order of
// time.

#include <cmath>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>

#include "sightline/core/tracking/local_tracker.h"

using namespace sightline::core;

// 1. A line of the file is a scan with one sighting: a direction and its covariance.
Scan scanFrom(const std::string& line) {
  std::istringstream fields(line);
  std::string time, sensor, azimuth, elevation, sigma_azimuth, sigma_elevation;
  for (std::string* field : {&time, &sensor, &azimuth, &elevation, &sigma_azimuth, &sigma_elevation})
    std::getline(fields, *field, ',');
  const Eigen::Vector2d angles(std::stod(azimuth), std::stod(elevation));
  const Eigen::Vector2d sigma(std::stod(sigma_azimuth), std::stod(sigma_elevation));

  Scan scan;
  scan.time = Time{} + durationOf(std::stod(time));
  scan.sensor = sensor;
  scan.sightings.push_back(sightingOf(angles, sigma.cwiseAbs2().asDiagonal()));
  return scan;
}

int main(int argc, char** argv) {
  std::ifstream file(argc == 2 ? argv[1] : "");
  std::string line;
  if (!std::getline(file, line)) {  // the header
    std::cerr << "usage: csv_to_tracks SIGHTINGS.csv\n";
    return 2;
  }

  // 2. One tracker takes the scans of all sensors. The defaults are those of config/local_tracker.yaml.
  LocalTrackerParams params;
  params.estimator.kind = EstimatorKind::twbls;
  LocalTracker tracker(params);

  // 3. Every scan yields a report: the tracks at the time of the scan. Only confirmed tracks are printed.
  std::cout.precision(9);
  std::cout << "time,track,azimuth,elevation,azimuth_rate,elevation_rate,sigma_azimuth,sigma_elevation\n";
  while (std::getline(file, line)) {
    const ScanReport report = tracker.onScan(scanFrom(line));
    for (const Track& track : report.tracks) {
      if (track.status != TrackStatus::confirmed) continue;
      std::cout << seconds(report.time - Time{}) << ',' << track.id;
      for (int i = 0; i < 4; ++i) std::cout << ',' << track.state.mean(i);
      for (int i = 0; i < 2; ++i) std::cout << ',' << std::sqrt(track.state.covariance(i, i));
      std::cout << '\n';
    }
  }
}
