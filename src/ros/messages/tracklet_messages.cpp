#include "sightline/ros/messages/tracklet_messages.h"

#include <cmath>
#include <optional>

#include <Eigen/Core>

#include "sightline/core/model/name.h"
#include "sightline/core/model/sphere.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

constexpr double kLargestCorrelation = 1.0 - 5e-15;  // that rounding leaves positive definite
constexpr double kRounding = 1e-9;                   // of a correlation

std::optional<core::Refusal> whyUnusable(const sightline::Tracklet& message, const ros::Time& newest,
                                         const Eigen::Vector2d& angles, const Eigen::Matrix2d& covariance) {
  if (message.track == 0) return core::invalid("id 0 means no track; ids start at 1");
  if (message.sensor.empty()) return core::invalid("the sensor is not named");
  if (auto refusal = core::whyTooLong("the sensor's name", message.sensor)) return refusal;
  if (message.stamp > newest) return core::invalid("its stamp is after the message's");
  if (!(message.sightings > 0.0) || !std::isfinite(message.sightings))
    return core::invalid("sightings " + std::to_string(message.sightings) + " is not a number > 0");
  return core::rejectionOf(angles, covariance);
}

/// The covariance of a very elongated sighting may not be positive definite any more in (azimuth, elevation),
/// by rounding alone: its correlation is made as large as it can be.
Eigen::Matrix2d withoutRounding(Eigen::Matrix2d covariance) {
  const double scale = std::sqrt(covariance(0, 0)) * std::sqrt(covariance(1, 1));
  const double correlation = covariance(0, 1) / scale;
  const bool is_rounded = std::abs(correlation) > kLargestCorrelation &&
                          std::abs(correlation) <= 1.0 + kRounding &&
                          std::abs(covariance(0, 1) - covariance(1, 0)) <= kRounding * scale;
  if (is_rounded)
    covariance(0, 1) = covariance(1, 0) = std::copysign(kLargestCorrelation * scale, correlation);
  return covariance;
}

}  // namespace

sightline::TrackletArray toMessage(const core::TrackletReport& report, const std::string& frame) {
  sightline::TrackletArray message;
  message.header.stamp = toRos(report.time);
  message.header.frame_id = frame;
  message.tracker = report.tracker;
  if (report.since) message.since = toRos(*report.since);
  message.tracklets.resize(report.tracklets.size());
  for (std::size_t i = 0; i < report.tracklets.size(); ++i) {
    const core::Tracklet& tracklet = report.tracklets[i].tracklet;
    sightline::Tracklet& row = message.tracklets[i];
    const Eigen::Vector2d angles = core::anglesOf(tracklet.sighting.direction);
    const Eigen::Matrix2d covariance = core::anglesCovariance(tracklet.sighting);
    row.track = report.tracklets[i].track;
    row.sensor = tracklet.sensor;
    row.stamp = toRos(tracklet.time);
    row.azimuth = angles.x();
    row.elevation = angles.y();
    row.covariance = {covariance(0, 0), covariance(0, 1), covariance(1, 0), covariance(1, 1)};
    row.sightings = tracklet.sightings;
    row.ifov = tracklet.ifov;
  }
  return message;
}

ReadTracklets readTracklets(const sightline::TrackletArray& message) {
  ReadTracklets read;
  core::TrackletReport& report = read.report;
  report.tracker = message.tracker;
  report.time = toCore(message.header.stamp);
  if (!message.since.isZero()) report.since = toCore(message.since);
  for (const sightline::Tracklet& row : message.tracklets) {
    const Eigen::Vector2d angles(row.azimuth, row.elevation);
    const Eigen::Matrix2d covariance = withoutRounding(
        (Eigen::Matrix2d() << row.covariance[0], row.covariance[1], row.covariance[2], row.covariance[3])
            .finished());
    if (const auto why = whyUnusable(row, message.header.stamp, angles, covariance)) {
      read.refusal = core::invalid("tracklet of track " + std::to_string(row.track) + " of \"" +
                                   message.tracker + "\" by \"" + row.sensor + "\": " + why->detail);
      continue;
    }
    core::TrackTracklet it;
    it.track = row.track;
    it.tracklet.time = toCore(row.stamp);
    it.tracklet.sensor = row.sensor;
    it.tracklet.ifov = row.ifov;
    it.tracklet.sighting = core::sightingOf(angles, covariance);
    it.tracklet.sightings = row.sightings;
    report.tracklets.push_back(std::move(it));
  }
  return read;
}

}  // namespace sightline_ros
