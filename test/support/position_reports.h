#pragma once

#include <string>
#include <vector>

#include <sightline/PositionReport.h>

/// A report about stations of one sensor each, of which all is known: 3 +- 2 ms ahead, turned by 0.1, -0.2
/// and 0.3 mrad +- 0.4, 0.5 and 0.6 mrad.
inline sightline::PositionReport positionReport(const std::vector<std::string>& stations) {
  sightline::PositionReport report;
  report.header.frame_id = "world";
  report.complete = true;
  for (const std::string& name : stations) {
    sightline::StationError station;
    station.tracker = station.sensor = name;
    station.slow_scale = 1.3;
    station.time_constant = 3.0;
    station.clock_behind = -0.003;
    station.clock_sigma = 0.002;
    station.rotation = {1e-4, -2e-4, 3e-4};
    station.rotation_sigma = {4e-4, 5e-4, 6e-4};
    report.stations.push_back(station);
  }
  return report;
}

/// `source` (`tracker/id`) is without a position for that reason.
inline sightline::UnlocatedTrack unlocatedTrack(const std::string& source, const std::string& kind) {
  sightline::UnlocatedTrack track;
  track.source = source;
  track.kind = kind;
  track.reason = kind + ": why";
  return track;
}
