#include "sightline/ros/messages/frames.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include <Eigen/Geometry>

#include <tf2/exceptions.h>

#include "sightline/core/model/sphere.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

constexpr double kRateStep = 0.01;  // over which the rate of turn is measured [s]

using Complaint = std::pair<std::string, std::string>;

bool isKnown(double value) {
  return !std::isnan(value);
}

FramedScan dropped(const sightline::SightingArray::ConstPtr& message, Complaint complaint) {
  FramedScan framed;
  framed.message = message;
  framed.scan.time = toCore(message->header.stamp);
  framed.scan.sensor = message->sensor;
  framed.drop_reason = std::move(complaint.first);
  framed.drop_detail = std::move(complaint.second);
  return framed;
}

Eigen::Matrix3d rotationOf(const geometry_msgs::TransformStamped& transform) {
  const auto& q = transform.transform.rotation;
  return Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
}

core::Sighting unusableSighting() {
  core::Sighting sighting;
  sighting.covariance.setConstant(std::numeric_limits<double>::quiet_NaN());
  return sighting;
}

core::Sighting turned(const core::Sighting& sighting, const Turn& turn) {
  return core::rotate(
      turn.attitude_covariance ? core::withAttitude(sighting, *turn.attitude_covariance) : sighting,
      turn.R_tracking_sensor);
}

/// Fills the scan with the message's sightings, turned where it is not in the tracking frame already.
void takeSightings(const std::optional<Turn>& turn, FramedScan& framed) {
  const auto& sightings = framed.message->sightings;
  framed.scan.sightings.reserve(sightings.size());
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    const Eigen::Vector2d angles(sightings[i].azimuth, sightings[i].elevation);
    const Eigen::Matrix2d covariance =
        Eigen::Map<const Eigen::Matrix<double, 2, 2, Eigen::RowMajor>>(sightings[i].covariance.data());
    if (auto reason = core::rejectionOf(angles, covariance)) {
      framed.rejections.emplace_back(static_cast<std::uint32_t>(i), std::move(*reason));
      framed.scan.sightings.push_back(unusableSighting());
      continue;
    }
    const core::Sighting sighting = core::sightingOf(angles, covariance, sightings[i].snr);
    framed.scan.sightings.push_back(turn ? turned(sighting, *turn) : sighting);
  }
}

/// A scan of which nothing is left says neither "seen" nor "looked, and saw nothing".
void dropIfNothingIsLeft(FramedScan& framed) {
  if (framed.rejections.empty() || framed.rejections.size() < framed.scan.sightings.size()) return;
  framed.drop_reason = "no usable sighting";
  framed.drop_detail =
      "all its sightings are rejected, the first because its " + framed.rejections.front().second;
}

/// Half widths in azimuth and elevation [rad], by sensor.
std::map<std::string, Eigen::Vector2d> loadFieldsOfView(const ParamReader& reader) {
  std::map<std::string, Eigen::Vector2d> fields;
  for (const ParamReader& entry : reader.list("fields_of_view")) {
    const std::string sensor = entry.requiredText("sensor");
    const double azimuth =
        entry.requiredNumber("azimuth_half_width", Range{0.0, core::kPi, true, false}, "rad");
    const double elevation =
        entry.requiredNumber("elevation_half_width", Range{0.0, core::kPi / 2.0, true, false}, "rad");
    if (!fields.emplace(sensor, Eigen::Vector2d(azimuth, elevation)).second)
      throw entry.error("sensor", "the field of view of \"" + sensor + "\" is given twice");
  }
  return fields;
}

}  // namespace

FrameChangeParams loadFrameChangeParams(const ParamReader& reader, FrameChangeParams params) {
  params.tracking_frame = reader.text("tracking_frame", params.tracking_frame);
  params.tf_timeout = reader.number("tf_timeout", params.tf_timeout, atLeast(0.0), "s");
  params.max_future = reader.number("max_future", params.max_future, atLeast(0.0), "s");
  params.max_waiting = reader.integer("max_waiting", params.max_waiting, 1, 1000000);
  if (params.tracking_frame.empty() || params.tracking_frame.front() == '/') {
    throw reader.error("tracking_frame", "expected a frame name without leading slash, got the string \"" +
                                             params.tracking_frame + "\"");
  }
  return params;
}

core::AttitudeParams loadAttitudeParams(const ParamReader& reader, core::AttitudeParams params) {
  const Eigen::Vector3d& sigma = params.sigma;
  const std::vector<double> sigmas = reader.numbers("attitude_sigma", {sigma.x(), sigma.y(), sigma.z()},
                                                    between(0.0, core::kPi / 2.0), "rad");
  if (sigmas.size() != 3) {
    throw reader.error("attitude_sigma",
                       "expected three numbers [rad], of roll, pitch and yaw of the scans' frame, got " +
                           std::to_string(sigmas.size()));
  }
  params.sigma = {sigmas[0], sigmas[1], sigmas[2]};
  params.time_sigma = reader.number("attitude_time_sigma", params.time_sigma, atLeast(0.0), "s");
  return params;
}

FrameChangeParams loadTrackerFrameParams(const ParamReader& reader, FrameChangeParams params) {
  params = loadFrameChangeParams(reader, params);
  params.fields_of_view = loadFieldsOfView(reader);
  params.attitude = loadAttitudeParams(reader, params.attitude);
  return params;
}

std::optional<Complaint> complaintAbout(const sightline::SightingArray& message) {
  std::ostringstream detail;
  if (message.header.stamp.isZero()) {
    return Complaint("no stamp", "header.stamp is 0: set it to the middle of the exposure");
  }
  if (message.sensor.empty()) {
    return Complaint("no sensor name", "sensor is empty: give every sensor a unique name");
  }
  if (message.header.frame_id.empty()) {
    return Complaint("bad frame", "header.frame_id is empty: set it to the sensor's frame");
  }
  if (message.header.frame_id.front() == '/') {
    return Complaint("bad frame", "header.frame_id \"" + message.header.frame_id +
                                      "\" starts with a slash: tf2 frames have none");
  }
  if (isKnown(message.ifov) && !(message.ifov > 0.0 && std::isfinite(message.ifov))) {
    detail << "ifov is " << message.ifov << " rad: state an angle above 0, or NaN for not known";
    return Complaint("bad ifov", detail.str());
  }
  if (isKnown(message.detection_probability) &&
      !(message.detection_probability > 0.0 && message.detection_probability <= 1.0)) {
    detail << "detection_probability is " << message.detection_probability
           << ": state one in (0, 1], or NaN for not known";
    return Complaint("bad detection probability", detail.str());
  }
  if (isKnown(message.clutter_density) &&
      !(message.clutter_density >= 0.0 && std::isfinite(message.clutter_density))) {
    detail << "clutter_density is " << message.clutter_density
           << " per sr: state one of at least 0, or NaN for not known";
    return Complaint("bad clutter density", detail.str());
  }
  return std::nullopt;
}

FrameChange::FrameChange(FrameChangeParams params, const tf2::BufferCore& transforms)
    : params_(std::move(params)), transforms_(transforms) {}

void FrameChange::add(const sightline::SightingArray::ConstPtr& message, core::Time now) {
  if (auto complaint = complaintAbout(*message)) {
    finished_.push_back(dropped(message, std::move(*complaint)));
    return;
  }
  const double ahead = core::seconds(toCore(message->header.stamp) - now);
  if (now != core::Time{} && ahead > params_.max_future) {
    std::ostringstream detail;
    detail << "its stamp is " << ahead << " s ahead of the clock, more than max_future " << params_.max_future
           << " s: synchronise the sensor's clock";
    finished_.push_back(dropped(message, {"from the future", detail.str()}));
    return;
  }
  const std::string& frame = message->header.frame_id;
  if (waiting_.count(frame) == 0 && isHere(*message)) {
    finished_.push_back(inTrackingFrame(message));
    return;
  }
  waiting_[frame].push_back({message, now});
  ++waiting_count_;
}

std::vector<FramedScan> FrameChange::release(core::Time now) {
  for (auto it = waiting_.begin(); it != waiting_.end();) {
    releaseFirst(it->second, now);
    it = it->second.empty() ? waiting_.erase(it) : std::next(it);
  }
  while (waiting_count_ > static_cast<std::size_t>(params_.max_waiting)) dropOldest();
  return std::exchange(finished_, {});
}

/// The scans at the head of a frame's queue that have their transform, or have waited long enough.
void FrameChange::releaseFirst(std::deque<Waiting>& scans, core::Time now) {
  while (!scans.empty()) {
    Waiting& first = scans.front();
    if (isHere(*first.message)) {
      finished_.push_back(inTrackingFrame(first.message));
    } else if (hasWaitedEnough(first, now)) {
      finished_.push_back(withoutTransform(first, now));
    } else {
      return;
    }
    scans.pop_front();
    --waiting_count_;
  }
}

bool FrameChange::isHere(const sightline::SightingArray& message) const {
  const auto& header = message.header;
  return header.frame_id == params_.tracking_frame ||
         transforms_.canTransform(params_.tracking_frame, header.frame_id, header.stamp);
}

bool FrameChange::hasWaitedEnough(Waiting& scan, core::Time now) const {
  // The clock starts late, or goes back, under simulated time.
  if (scan.since == core::Time{} || scan.since > now) scan.since = now;
  return core::seconds(now - scan.since) >= params_.tf_timeout;
}

FramedScan FrameChange::inTrackingFrame(const sightline::SightingArray::ConstPtr& message) const {
  std::optional<Turn> turn;
  const auto& header = message->header;
  try {
    turn = turnOf(header);
  } catch (const tf2::TransformException& problem) {
    return dropped(message, {"no transform", problem.what()});
  }
  FramedScan framed;
  framed.message = message;
  framed.scan.time = toCore(header.stamp);
  framed.scan.sensor = message->sensor;
  framed.scan.ifov = message->ifov;
  framed.scan.detection_probability = message->detection_probability;
  framed.scan.clutter_density = message->clutter_density;
  framed.scan.view = viewOf(message->sensor, turn);
  takeSightings(turn, framed);
  dropIfNothingIsLeft(framed);
  return framed;
}

/// nullopt: the scan is in the tracking frame. Throws tf2::TransformException when the attitude is not known.
std::optional<Turn> FrameChange::turnOf(const std_msgs::Header& header) const {
  if (header.frame_id == params_.tracking_frame) return std::nullopt;
  Turn turn{rotationOf(transforms_.lookupTransform(params_.tracking_frame, header.frame_id, header.stamp)),
            {}};
  if (!params_.attitude.isExact()) {
    turn.attitude_covariance =
        core::attitudeCovariance(params_.attitude, angularVelocityOf(header, turn.R_tracking_sensor));
  }
  return turn;
}

/// In the sensor's frame [rad/s], from the transforms of a moment before or, at their beginning, after; zero
/// where there is but one.
Eigen::Vector3d FrameChange::angularVelocityOf(const std_msgs::Header& header,
                                               const Eigen::Matrix3d& R_tracking_sensor) const {
  if (params_.attitude.time_sigma == 0.0) return Eigen::Vector3d::Zero();
  for (const double step : {-kRateStep, kRateStep}) {
    const ros::Time other = header.stamp + ros::Duration(step);
    if (!transforms_.canTransform(params_.tracking_frame, header.frame_id, other)) continue;
    const Eigen::Matrix3d R_other =
        rotationOf(transforms_.lookupTransform(params_.tracking_frame, header.frame_id, other));
    return core::angularVelocity(R_tracking_sensor, R_other, step);
  }
  return Eigen::Vector3d::Zero();
}

std::optional<core::FieldOfView> FrameChange::viewOf(const std::string& sensor,
                                                     const std::optional<Turn>& turn) const {
  const auto field = params_.fields_of_view.find(sensor);
  if (field == params_.fields_of_view.end()) return std::nullopt;
  core::FieldOfView view;
  if (turn) view.R_sensor_tracking = turn->R_tracking_sensor.transpose();
  view.half_widths = field->second;
  return view;
}

FramedScan FrameChange::withoutTransform(const Waiting& scan, core::Time now) const {
  const auto& header = scan.message->header;
  std::string why;
  transforms_.canTransform(params_.tracking_frame, header.frame_id, header.stamp, &why);
  std::ostringstream detail;
  detail << "no transform from " << header.frame_id << " to " << params_.tracking_frame << " came within "
         << core::seconds(now - scan.since) << " s (tf_timeout " << params_.tf_timeout << " s)";
  if (!why.empty()) detail << ": " << why;
  if (why.find("extrapolation") != std::string::npos) {
    detail << " (transforms are interpolated between two stamps and never extrapolated: publish them for the "
              "stamps of the scans)";
  }
  return dropped(scan.message, {"no transform", detail.str()});
}

/// The scan that has waited longest makes room.
void FrameChange::dropOldest() {
  const auto oldest = std::min_element(waiting_.begin(), waiting_.end(), [](const auto& a, const auto& b) {
    return a.second.front().since < b.second.front().since;
  });
  finished_.push_back(dropped(
      oldest->second.front().message,
      {"too many waiting",
       "more than max_waiting " + std::to_string(params_.max_waiting) + " scans wait for their transforms"}));
  oldest->second.pop_front();
  if (oldest->second.empty()) waiting_.erase(oldest);
  --waiting_count_;
}

}  // namespace sightline_ros
