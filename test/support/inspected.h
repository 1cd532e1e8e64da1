#pragma once

#include <boost/make_shared.hpp>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <sightline/AssociationArray.h>
#include <sightline/FusionReport.h>
#include <sightline/PositionTrackArray.h>
#include <sightline/TrackArray.h>

#include "support/output_tracks.h"
#include "support/times.h"

/// Messages as the inspector hears them.
namespace sightline::test {

inline boost::shared_ptr<TrackArray> tracksOf(const std::string& tracker, double stamp,
                                              const std::vector<std::uint32_t>& ids, double sigma = 1e-3) {
  auto message = boost::make_shared<TrackArray>();
  message->header.stamp = ros::Time(stamp);
  message->header.frame_id = "platform_enu";
  message->tracker = tracker;
  message->estimator = "imm";
  for (const std::uint32_t id : ids) {
    message->tracks.push_back(directionTrack(id, 0.001 * id, 0.1, sigma));
    message->tracks.back().gate.azimuth_half_width = 4.0 * sigma;
    message->tracks.back().gate.elevation_half_width = 3.0 * sigma;
    message->tracks.back().last_sighting = ros::Time(stamp - 0.25);
    message->tracks.back().sources = {"left", "right"};
  }
  return message;
}

/// S = (1e-3)^2 I, threshold 9: the distance squared follows from the innovation, in mrad.
inline Association decisionOn(std::uint32_t track, std::uint8_t decision, double azimuth_mrad,
                              double elevation_mrad) {
  Association row;
  row.track = track;
  row.decision = decision;
  row.innovation[0] = 1e-3 * azimuth_mrad;
  row.innovation[1] = 1e-3 * elevation_mrad;
  row.covariance[0] = row.covariance[3] = 1e-6;
  row.distance_squared = azimuth_mrad * azimuth_mrad + elevation_mrad * elevation_mrad;
  row.threshold = 9.0;
  return row;
}

inline AssociationArray decisionsOf(const std::string& sensor, double stamp,
                                    const std::vector<Association>& rows) {
  AssociationArray message;
  message.header.stamp = ros::Time(stamp);
  message.header.frame_id = "platform_enu";
  message.sensor = sensor;
  message.associations = rows;
  return message;
}

inline SourceTrack sourceOf(const std::string& tracker, std::uint32_t id, double weight,
                            const std::string& reason = "") {
  SourceTrack source;
  source.tracker = tracker;
  source.id = id;
  source.weight = weight;
  source.distance_squared = 1.5;
  source.reason = reason;
  return source;
}

inline boost::shared_ptr<FusionReport> reportOf(double stamp, std::uint32_t id,
                                                const std::vector<SourceTrack>& sources) {
  auto report = boost::make_shared<FusionReport>();
  report->header.stamp = ros::Time(stamp);
  report->tracks.resize(1);
  report->tracks[0].id = id;
  report->tracks[0].rule = "tracklets";
  report->tracks[0].sources = sources;
  return report;
}

}  // namespace sightline::test
