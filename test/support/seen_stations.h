#pragma once

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <geometry_msgs/TransformStamped.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>
#include <sightline/TrackletArray.h>

#include "sightline/core/model/sphere.h"
#include "sightline/ros/messages/transform_messages.h"

/// Stations that stand apart and see one target, as messages.
namespace sightline::test {

/// Where the target is at t [s], in the metric frame: a circle of 15 m that takes 20 s.
inline Eigen::Vector3d targetAt(double t) {
  return {40.0 + 15.0 * std::cos(0.3 * t), 30.0 + 15.0 * std::sin(0.3 * t), 20.0};
}

inline Eigen::Vector3d targetVelocityAt(double t) {
  return (targetAt(t + 1e-4) - targetAt(t - 1e-4)) / 2e-4;
}

/// A station with a frame of its own name, turned about z, whose directions have white noise.
class SeenStation {
 public:
  SeenStation(std::string name, const Eigen::Vector3d& origin, double yaw, unsigned seed)
      : name_(std::move(name)),
        origin_(origin),
        turn_(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix()),
        random_(seed) {}

  const std::string& name() const { return name_; }

  void moveTo(const Eigen::Vector3d& origin) { origin_ = origin; }

  geometry_msgs::TransformStamped transform(const ros::Time& stamp, const std::string& parent) const {
    return sightline_ros::transformMessage(stamp, parent, name_, origin_, turn_);
  }

  /// (azimuth, elevation) of a point, in the station's frame.
  Eigen::Vector2d anglesTo(const Eigen::Vector3d& point) const {
    return core::anglesOf((turn_.transpose() * (point - origin_)).normalized());
  }

  Eigen::Vector2d noisyAnglesTo(const Eigen::Vector3d& point) {
    const double a = normal_(random_), b = normal_(random_);
    return anglesTo(point) + kSigma * Eigen::Vector2d(a, b);
  }

  /// A scan with the sighting of a target at `point`.
  sightline::SightingArray scan(const ros::Time& stamp, const Eigen::Vector3d& point) {
    sightline::SightingArray scan;
    scan.header.stamp = stamp;
    scan.header.frame_id = name_;
    scan.sensor = "eye of " + name_;
    scan.ifov = scan.detection_probability = scan.clutter_density = std::numeric_limits<double>::quiet_NaN();
    sightline::Sighting sighting;
    const Eigen::Vector2d angles = noisyAnglesTo(point);
    sighting.azimuth = angles.x();
    sighting.elevation = angles.y();
    sighting.covariance = {kSigma * kSigma, 0.0, 0.0, kSigma * kSigma};
    sighting.snr = std::numeric_limits<double>::quiet_NaN();
    scan.sightings.push_back(sighting);
    return scan;
  }

  /// The local track 5 of a target at `point` that moves at `velocity`.
  sightline::TrackArray tracks(const ros::Time& stamp, const Eigen::Vector3d& point,
                               const Eigen::Vector3d& velocity) {
    sightline::TrackArray array;
    array.header.stamp = stamp;
    array.header.frame_id = name_;
    array.tracker = name_;
    array.tracks.resize(1);
    sightline::Track& track = array.tracks[0];
    const Eigen::Vector2d angles = noisyAnglesTo(point);
    const Eigen::Vector2d rates =
        (anglesTo(point + 1e-3 * velocity) - anglesTo(point - 1e-3 * velocity)) / 2e-3;
    track.id = 5;
    track.status = sightline::Track::CONFIRMED;
    track.azimuth = angles.x();
    track.elevation = angles.y();
    track.azimuth_rate = rates.x();
    track.elevation_rate = rates.y();
    track.covariance[0] = track.covariance[5] = kSigma * kSigma;
    track.covariance[10] = track.covariance[15] = 25.0 * kSigma * kSigma;
    track.last_sighting = stamp;
    track.hits = 10;
    track.existence = 0.999;
    return array;
  }

  /// The tracklet of one sighting of it.
  sightline::TrackletArray tracklets(const ros::Time& stamp, const Eigen::Vector3d& point) {
    sightline::TrackletArray array;
    array.header.stamp = stamp;
    array.header.frame_id = name_;
    array.tracker = name_;
    array.tracklets.resize(1);
    sightline::Tracklet& tracklet = array.tracklets[0];
    const Eigen::Vector2d angles = noisyAnglesTo(point);
    tracklet.track = 5;
    tracklet.sensor = "eye of " + name_;
    tracklet.stamp = stamp;
    tracklet.azimuth = angles.x();
    tracklet.elevation = angles.y();
    tracklet.covariance = {kSigma * kSigma, 0.0, 0.0, kSigma * kSigma};
    tracklet.sightings = 1.0;
    tracklet.ifov = std::numeric_limits<double>::quiet_NaN();
    return array;
  }

  static constexpr double kSigma = 5e-4;  // [rad]

 private:
  std::string name_;
  Eigen::Vector3d origin_;
  Eigen::Matrix3d turn_;  // R_metric_station
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

}  // namespace sightline::test
