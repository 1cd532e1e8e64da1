#pragma once

#include <array>
#include <cstdint>
#include <string>

#include <Eigen/Core>

#include <ros/time.h>
#include <sightline/PositionTrackArray.h>
#include <sightline/TrackArray.h>

/// Messages of tracks as trackers publish them.
namespace sightline::test {

inline sightline::Track directionTrack(std::uint32_t id, double azimuth, double elevation,
                                       double sigma = 1e-3) {
  sightline::Track track;
  track.id = id;
  track.status = sightline::Track::CONFIRMED;
  track.azimuth = azimuth;
  track.elevation = elevation;
  track.covariance[0] = track.covariance[5] = sigma * sigma;
  track.covariance[10] = track.covariance[15] = sigma * sigma;
  track.existence = 0.99;
  return track;
}

inline sightline::PositionTrack positionTrack(std::uint32_t id, const Eigen::Vector3d& position,
                                              const Eigen::Vector3d& velocity, double sigma = 0.1) {
  sightline::PositionTrack track;
  track.id = id;
  track.status = sightline::PositionTrack::CONFIRMED;
  track.position.x = position.x();
  track.position.y = position.y();
  track.position.z = position.z();
  track.velocity.x = velocity.x();
  track.velocity.y = velocity.y();
  track.velocity.z = velocity.z();
  for (std::size_t i = 0; i < 6; ++i) track.covariance[7 * i] = sigma * sigma;
  track.existence = 0.99;
  return track;
}

template <typename Message>
Message stamped(const ros::Time& stamp, const std::string& frame) {
  Message message;
  message.header.stamp = stamp;
  message.header.frame_id = frame;
  message.tracker = "tracker";
  return message;
}

}  // namespace sightline::test
