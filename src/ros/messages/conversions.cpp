#include "sightline/ros/messages/conversions.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "sightline/core/model/sphere.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1000000000;

/// Row-major, as all matrices of the messages.
template <typename Derived, typename Array>
void copyRows(const Eigen::MatrixBase<Derived>& matrix, Array& out) {
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    for (Eigen::Index col = 0; col < matrix.cols(); ++col) out[row * matrix.cols() + col] = matrix(row, col);
  }
}

template <int kSize, typename Array>
Eigen::Matrix<double, kSize, kSize> matrixOf(const Array& rows) {
  return Eigen::Map<const Eigen::Matrix<double, kSize, kSize, Eigen::RowMajor>>(rows.data());
}

}  // namespace

core::Time toCore(const ros::Time& stamp) {
  return core::timeOf(static_cast<std::int64_t>(stamp.sec) * kNanosecondsPerSecond + stamp.nsec);
}

ros::Time toRos(core::Time time) {
  const std::int64_t nanoseconds = time.time_since_epoch().count();
  const std::int64_t whole_seconds = nanoseconds / kNanosecondsPerSecond;
  if (nanoseconds < 0 || whole_seconds > std::numeric_limits<std::uint32_t>::max()) {
    throw std::range_error("a time of " + std::to_string(nanoseconds) +
                           " ns since 1970 does not fit into a ROS stamp");
  }
  return ros::Time(static_cast<std::uint32_t>(whole_seconds),
                   static_cast<std::uint32_t>(nanoseconds % kNanosecondsPerSecond));
}

sightline::Gate toMessage(const core::Gate& gate) {
  sightline::Gate message;
  message.azimuth = gate.centre.x();
  message.elevation = gate.centre.y();
  message.azimuth_half_width = gate.half_width.x();
  message.elevation_half_width = gate.half_width.y();
  copyRows(gate.covariance, message.covariance);
  return message;
}

core::Gate toCore(const sightline::Gate& message) {
  core::Gate gate;
  gate.centre = {message.azimuth, message.elevation};
  gate.half_width = {message.azimuth_half_width, message.elevation_half_width};
  gate.covariance = matrixOf<2>(message.covariance);
  return gate;
}

sightline::Track toMessage(const core::Track& track) {
  sightline::Track message;
  message.id = track.id;
  message.status = static_cast<std::uint8_t>(track.status);
  message.azimuth = track.state.mean(0);
  message.elevation = track.state.mean(1);
  message.azimuth_rate = track.state.mean(2);
  message.elevation_rate = track.state.mean(3);
  copyRows(track.state.covariance, message.covariance);
  message.gate = toMessage(track.gate);
  message.last_sighting = toRos(track.last_sighting);
  message.hits = track.hits;
  message.misses = track.misses;
  message.existence = track.existence;
  message.sources = track.sources;
  return message;
}

core::Track toCore(const sightline::Track& message) {
  core::Track track;
  track.id = message.id;
  track.status = static_cast<core::TrackStatus>(message.status);
  track.state.mean << message.azimuth, message.elevation, message.azimuth_rate, message.elevation_rate;
  track.state.covariance = matrixOf<4>(message.covariance);
  track.gate = toCore(message.gate);
  track.last_sighting = toCore(message.last_sighting);
  track.hits = message.hits;
  track.misses = message.misses;
  track.existence = message.existence;
  track.sources = message.sources;
  return track;
}

sightline::SightingArray toMessage(const core::Scan& scan, const std::string& frame) {
  sightline::SightingArray message;
  message.header.stamp = toRos(scan.time);
  message.header.frame_id = frame;
  message.sensor = scan.sensor;
  message.ifov = scan.ifov;
  message.detection_probability = scan.detection_probability;
  message.clutter_density = scan.clutter_density;
  message.sightings.resize(scan.sightings.size());
  for (std::size_t i = 0; i < scan.sightings.size(); ++i) {
    const Eigen::Vector2d angles = core::anglesOf(scan.sightings[i].direction);
    message.sightings[i].azimuth = angles.x();
    message.sightings[i].elevation = angles.y();
    copyRows(core::anglesCovariance(scan.sightings[i]), message.sightings[i].covariance);
    message.sightings[i].snr = scan.sightings[i].snr;
  }
  return message;
}

sightline::Association toMessage(const core::Association& association) {
  sightline::Association message;
  message.sighting = association.sighting;
  message.track = association.track;
  copyRows(association.innovation, message.innovation);
  copyRows(association.covariance, message.covariance);
  message.distance_squared = association.distance_squared;
  message.threshold = association.threshold;
  message.decision = static_cast<std::uint8_t>(association.decision);
  message.reason = association.reason;
  return message;
}

core::Association toCore(const sightline::Association& message) {
  core::Association association;
  association.sighting = message.sighting;
  association.track = message.track;
  association.innovation = {message.innovation[0], message.innovation[1]};
  association.covariance = matrixOf<2>(message.covariance);
  association.distance_squared = message.distance_squared;
  association.threshold = message.threshold;
  association.decision = static_cast<core::Decision>(message.decision);
  association.reason = message.reason;
  return association;
}

}  // namespace sightline_ros
