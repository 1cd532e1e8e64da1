#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "sightline/core/model/sighting.h"
#include "sightline/core/model/time.h"

namespace sightline::core {

/// What some of one sensor's sightings of one target say together: a sighting itself, at a time between
/// theirs and as sure as all of them. No prior is in it and no model of the target, so that the errors of
/// different tracklets are independent and any estimator can be run on them.
struct Tracklet {
  Time time{};
  std::string sensor;                                      ///< unique name
  double ifov = std::numeric_limits<double>::quiet_NaN();  ///< of the sensor [rad], NaN = not known
  Sighting sighting;                                       ///< in the tracking frame
  double sightings = 1.0;  ///< how many are in it; where several tracklets share them, this one's share
};

/// A tracklet of one local track.
struct TrackTracklet {
  std::uint32_t track = 0;  ///< id of the local track
  Tracklet tracklet;
};

/// What is new in the sightings of one tracker's tracks.
struct TrackletReport {
  std::string tracker;
  Time time{};                ///< every sighting up to here is in this report or in an earlier one
  std::optional<Time> since;  ///< `time` of the report before; none: this is the tracker's first
  std::vector<TrackTracklet> tracklets;
};

struct CompressionParams {
  double span = 0.15;  ///< sightings over so long are taken together [s], >= 0; 0 = each stays on its own
  int nodes = 2;       ///< tracklets that stand for the sightings of one span, 1 to kMostNodes
};

constexpr int kMostNodes = 4;

/// Fewer tracklets that say the same. `sightings` are of one sensor and one target, in order of time.
///
/// The sightings of a span are replaced by `nodes` tracklets at the nodes of Gauss's quadrature for their
/// weights in time, with values on the least squares polynomial of degree `nodes` - 1. One node is the
/// centroid (S-60). Two keep all that is in the sightings of a target in straight
/// flight - place, rate and their joint covariance, for any estimator - and, as the nodes are where the
/// straight line crosses a parabola, are not biased by a steady acceleration either. What is lost is what the
/// sightings of one span say of the coefficient of degree `nodes`; where that stands out of the noise the
/// span is halved. So is one whose covariances change their shape so much that the tracklets' errors would
/// not be independent. Not more sightings than nodes stay as they are.
std::vector<Tracklet> compress(const std::vector<Tracklet>& sightings, const CompressionParams& params);

}  // namespace sightline::core
