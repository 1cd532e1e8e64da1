#include "sightline/ros/messages/position_messages.h"

#include <cmath>
#include <cstddef>
#include <limits>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

using RowMajor = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

template <typename Message>
Message vectorMessage(const Eigen::Vector3d& vector) {
  Message message;
  message.x = vector.x();
  message.y = vector.y();
  message.z = vector.z();
  return message;
}

template <typename Message>
Eigen::Vector3d vectorOf(const Message& message) {
  return {message.x, message.y, message.z};
}

sightline::RefusedCrossing toMessage(const core::RefusedCrossingReport& crossing) {
  sightline::RefusedCrossing message;
  message.sources = crossing.sources;
  message.position = vectorMessage<geometry_msgs::Point>(crossing.position);
  message.score = crossing.score;
  message.margin = crossing.margin;
  message.kind = crossing.reason.kind;
  message.reason = core::textOf(crossing.reason);
  return message;
}

sightline::UnlocatedTrack toMessage(const core::UnlocatedTrack& track) {
  sightline::UnlocatedTrack message;
  message.source = track.source;
  message.kind = track.reason.kind;
  message.reason = core::textOf(track.reason);
  return message;
}

sightline::StationError toMessage(const core::StationReport& station) {
  constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();
  sightline::StationError message;
  message.tracker = station.tracker;
  message.sensor = station.sensor;
  message.slow_scale = station.slow_scale;
  message.time_constant = station.time_constant;
  message.clock_behind = message.clock_sigma = kNotKnown;
  message.rotation.fill(kNotKnown);
  message.rotation_sigma.fill(kNotKnown);
  message.corrected = station.is_corrected;
  message.undecided = station.is_undecided;
  if (!station.alignment) return message;
  message.clock_behind = -station.alignment->clock;
  message.clock_sigma = station.alignment->clock_sigma;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    message.rotation[axis] = station.alignment->orientation(static_cast<Eigen::Index>(axis));
    message.rotation_sigma[axis] = station.alignment->orientation_sigma(static_cast<Eigen::Index>(axis));
  }
  return message;
}

geometry_msgs::Quaternion along(const Eigen::Vector3d& velocity) {
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  if (velocity.norm() > 0.0) {
    const double level = std::hypot(velocity.x(), velocity.y());
    turn = Eigen::AngleAxisd(std::atan2(velocity.y(), velocity.x()), Eigen::Vector3d::UnitZ()) *
           Eigen::AngleAxisd(-std::atan2(velocity.z(), level), Eigen::Vector3d::UnitY());
  }
  geometry_msgs::Quaternion message;
  message.x = turn.x();
  message.y = turn.y();
  message.z = turn.z();
  message.w = turn.w();
  return message;
}

}  // namespace

sightline::PositionTrack toMessage(const core::PositionTrack& track) {
  sightline::PositionTrack message;
  message.id = track.id;
  message.status = static_cast<std::uint8_t>(track.status);
  message.position = vectorMessage<geometry_msgs::Point>(track.position);
  message.velocity = vectorMessage<geometry_msgs::Vector3>(track.velocity);
  Eigen::Map<RowMajor>(message.covariance.data()) = track.covariance;
  message.existence = track.existence;
  message.last_sighting = toRos(track.last_sighting);
  message.parallax = track.parallax;
  message.sources = track.sources;
  return message;
}

core::PositionTrack toCore(const sightline::PositionTrack& message) {
  core::PositionTrack track;
  track.id = message.id;
  track.status = static_cast<core::TrackStatus>(message.status);
  track.position = vectorOf(message.position);
  track.velocity = vectorOf(message.velocity);
  track.covariance = Eigen::Map<const RowMajor>(message.covariance.data());
  track.existence = message.existence;
  track.last_sighting = toCore(message.last_sighting);
  track.parallax = message.parallax;
  track.sources = message.sources;
  return track;
}

sightline::PositionTrackArray toMessage(const core::PositionTrackArray& tracks, const std::string& tracker,
                                        const std::string& frame) {
  sightline::PositionTrackArray message;
  message.header.stamp = toRos(tracks.time);
  message.header.frame_id = frame;
  message.tracker = tracker;
  message.tracks.reserve(tracks.tracks.size());
  for (const core::PositionTrack& track : tracks.tracks) message.tracks.push_back(toMessage(track));
  return message;
}

core::PositionTrackArray toCore(const sightline::PositionTrackArray& message) {
  core::PositionTrackArray tracks;
  tracks.time = toCore(message.header.stamp);
  tracks.tracks.reserve(message.tracks.size());
  for (const sightline::PositionTrack& track : message.tracks) tracks.tracks.push_back(toCore(track));
  return tracks;
}

sightline::PositionReport toMessage(const core::PositionOutput& output, const std::string& frame) {
  sightline::PositionReport message;
  message.header.stamp = toRos(output.tracks.time);
  message.header.frame_id = frame;
  message.decided = toRos(output.report.time);
  message.complete = output.report.is_complete;
  for (const core::PositionTrack& track : output.tracks.tracks) {
    sightline::PositionSupport support;
    support.id = track.id;
    support.sources = track.sources;
    message.positions.push_back(support);
  }
  for (const core::RefusedCrossingReport& crossing : output.report.refused)
    message.refused.push_back(toMessage(crossing));
  for (const core::UnlocatedTrack& track : output.report.unlocated)
    message.unlocated.push_back(toMessage(track));
  for (const core::StationReport& station : output.report.stations)
    message.stations.push_back(toMessage(station));
  return message;
}

geometry_msgs::PoseArray posesOf(const sightline::PositionTrackArray& tracks) {
  geometry_msgs::PoseArray poses;
  poses.header = tracks.header;
  for (const sightline::PositionTrack& track : tracks.tracks) {
    if (track.status != sightline::PositionTrack::CONFIRMED) continue;
    geometry_msgs::Pose pose;
    pose.position = track.position;
    pose.orientation = along(vectorOf(track.velocity));
    poses.poses.push_back(pose);
  }
  return poses;
}

}  // namespace sightline_ros
