#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <sightline/PositionTrackArray.h>
#include <sightline/TrackArray.h>

#include "sightline/core/model/refusal.h"
#include "sightline/core/model/sphere.h"

/// Tracks of directions and of positions under one roof: what every output is made of.
namespace sightline_ros {

/// Mean and covariance over (x, y, z, vx, vy, vz) [m, m/s] in the metric frame.
struct MetricState {
  Eigen::Matrix<double, 6, 1> mean = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();

  Eigen::Vector3d position() const { return mean.head<3>(); }
  Eigen::Vector3d velocity() const { return mean.tail<3>(); }
};

struct OutputTrack {
  std::uint32_t id = 0;
  std::uint8_t status = 0;                                      ///< as in the messages
  double existence = std::numeric_limits<double>::quiet_NaN();  ///< NaN = not computed
  std::variant<sightline::core::AngularState, MetricState> state;
};

/// Usable tracks of one message.
struct OutputTracks {
  std_msgs::Header header;  ///< stamp at which the states are valid, frame that they are in
  bool are_positions = false;
  std::vector<OutputTrack> tracks;  ///< ascending id
};

/// Which tracks of a message are put out.
struct OutputChoice {
  bool coasting = true;  ///< besides confirmed ones
  bool tentative = false;
  int max_tracks = 200;  ///< of one message, those of the lowest ids
};

/// Whether tracks of this status (as in the messages) are put out.
bool isChosen(std::uint8_t status, const OutputChoice& choice);

/// The chosen tracks of a message. Those with numbers that cannot be used (not finite, off the sphere, a
/// covariance that is none, an id twice) and those beyond the limit are left out, each with a refusal.
OutputTracks outputTracksOf(const sightline::TrackArray& message, const OutputChoice& choice,
                            std::vector<sightline::core::Refusal>& refusals);
OutputTracks outputTracksOf(const sightline::PositionTrackArray& message, const OutputChoice& choice,
                            std::vector<sightline::core::Refusal>& refusals);

/// The track `h` seconds later (or earlier) at constant rates, with the white acceleration that its own
/// covariance speaks of (`impliedProcessNoise`); a direction in a chart around it, so that the zenith is no
/// special place.
OutputTrack predicted(const OutputTrack& track, double h);

/// Where the target is [m], in the frame of the tracks: its position, or the point of its line of sight at
/// `distance`.
Eigen::Vector3d placeOf(const OutputTrack& track, double distance);

/// Maps the target's frame to that of the tracks: x along the line of sight or, of a position, along the
/// velocity (no turn for one at rest); y level.
Eigen::Matrix3d attitudeOf(const OutputTrack& track);

/// x along a vector of any length, y level; no turn for a zero vector.
Eigen::Matrix3d attitudeAlong(const Eigen::Vector3d& forward);

/// Largest standard deviation of where the target is: of a direction on the sphere [rad], of a position [m].
double largestSigma(const OutputTrack& track);

/// A target as seen from another frame.
struct SeenDirection {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< unit vector
  double sigma = 0.0;                                    ///< largest, across the line of sight [rad]
};

/// `view_tracks` maps points in the frame of the tracks to the frame that looks. Of a direction only the
/// turn matters. A target at the origin of that frame has no direction: sigma is infinite.
SeenDirection seenFrom(const Eigen::Isometry3d& view_tracks, const OutputTrack& track);

}  // namespace sightline_ros
