#pragma once

#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "sightline/core/fusion/fusion_report.h"
#include "sightline/core/fusion/reports/local_reports.h"

#include "support/times.h"

/// Local tracks as a tracker would report them, for tests of the fusion.
namespace sightline::test {

/// Covariance of a Kalman filter in its steady state: position sigma [rad], memory about `memory` seconds.
inline Eigen::Matrix4d steadyCovariance(double sigma, double memory = 0.2) {
  Eigen::Matrix4d P = Eigen::Matrix4d::Zero();
  const double P22 = 0.5 / (memory * memory), P12 = 0.5 / memory;
  P.diagonal() << 1.0, 1.0, P22, P22;
  P(0, 2) = P(2, 0) = P(1, 3) = P(3, 1) = P12;
  return sigma * sigma * P;
}

/// A confirmed track at (azimuth, elevation) [rad], at rest.
inline core::Track localTrack(std::uint32_t id, const Eigen::Vector2d& angles, double sigma = 1e-3,
                              const Eigen::Vector2d& rates = Eigen::Vector2d::Zero()) {
  core::Track track;
  track.id = id;
  track.status = core::TrackStatus::confirmed;
  track.state.mean << angles, rates;
  track.state.covariance = steadyCovariance(sigma);
  track.hits = 10;
  return track;
}

/// A report of tracks that were all seen at its stamp, by a sensor of the tracker's own.
inline core::LocalReport reportOf(const std::string& tracker, double t, std::vector<core::Track> tracks) {
  for (core::Track& track : tracks) {
    if (track.status != core::TrackStatus::coasting) track.last_sighting = at(t);
    if (track.sources.empty()) track.sources = {"sensor of " + tracker};
  }
  return {tracker, at(t), tracks};
}

inline std::vector<std::string> reasonsOf(const std::vector<core::SourceTrack>& rows) {
  std::vector<std::string> kinds;
  for (const core::SourceTrack& row : rows) {
    kinds.push_back(row.tracker + " " + std::to_string(row.id) + " " + (row.reason ? row.reason->kind : ""));
  }
  return kinds;
}

inline std::vector<std::string> sourcesOf(const core::FusedTrack& track) {
  std::vector<std::string> names;
  for (const core::SourceTrack& row : track.sources)
    names.push_back(row.tracker + " " + std::to_string(row.id));
  return names;
}

inline bool isPositiveDefinite(const Eigen::Matrix4d& P) {
  return P.allFinite() && P == P.transpose() && Eigen::LLT<Eigen::Matrix4d>(P).info() == Eigen::Success;
}

}  // namespace sightline::test
