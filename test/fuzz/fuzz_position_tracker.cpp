#include <algorithm>
#include <cmath>
#include <variant>

#include <Eigen/Geometry>

#include "sightline/core/model/sphere.h"
#include "sightline/core/positions/position_tracker.h"

#include "fuzz/fuzz_targets.h"
#include "fuzz/random_params.h"
#include "fuzz/random_scans.h"

namespace sightline_fuzz {

namespace core = sightline::core;

namespace {

/// Stations at rest or on their way, and targets that they see.
class RandomStations {
 public:
  using Message = std::variant<core::StationTracks, core::StationTracklet>;

  RandomStations(RandomInput& input, const Hazards& hazards) : input_(input), hazards_(hazards) {
    size_ = input.oneOf({100.0, 100.0, 1e-3, 1e5, 1e7});
    sigma_ = input.logBetween(1e-6, 0.1);
    interval_ = input.oneOf({0.03, 0.03, 0.5, 5.0});
    begin_ = time_ = core::timeOf(static_cast<std::int64_t>(input.oneOf({0.0, 1.7e9, 4.29e9}) * 1e9));
    for (int i = input.oneOf({1, 2, 3, 5, 8}); i > 0; --i) {
      stations_.push_back({vector(size_ * input.oneOf({1.0, 0.01, 0.0})),
                           vector(0.01 * size_ * input.oneOf({0.0, 1.0})), input.between(-3.0, 3.0)});
    }
    for (int i = input.oneOf({0, 1, 2, 5}); i > 0; --i)
      targets_.push_back({vector(size_ * input.oneOf({1.0, 1.0, 0.0, 100.0})), vector(0.1 * size_)});
  }

  Message next() {
    const int station = input_.between(0, static_cast<int>(stations_.size()) - 1);
    time_ += core::Duration(1);  // no two messages have the same place in the order
    if (input_.chance(0.3)) time_ += core::durationOf(interval_ * input_.unit());
    if (input_.chance(0.4) || targets_.empty()) return tracks(station);
    return tracklet(station, input_.between(0, static_cast<int>(targets_.size()) - 1));
  }

 private:
  struct Station {
    Eigen::Vector3d origin, velocity;
    double turn;  // about the vertical [rad]
  };
  struct Target {
    Eigen::Vector3d position, velocity;
  };

  bool absurd() { return input_.chance(hazards_.values); }

  Eigen::Vector3d vector(double size) {
    return size * Eigen::Vector3d{input_.normal(), input_.normal(), input_.normal()};
  }

  std::string nameOf(int station) {
    if (input_.chance(hazards_.newcomers)) return "newcomer_" + std::to_string(newcomers_++);
    return "station_" + std::to_string(station);
  }

  core::Time stamp() {
    if (!input_.chance(hazards_.times)) return time_;
    if (input_.chance(0.05)) return core::timeOf(static_cast<std::int64_t>(input_.between(0.0, 4.2e18)));
    if (input_.chance(0.05)) time_ += core::durationOf(input_.logBetween(0.1, 1e5));
    return std::max(core::Time{}, time_ - core::durationOf(input_.logBetween(1e-9, 5.0)));
  }

  core::StationPose poseAt(int number, core::Time time) {
    const Station& station = stations_[static_cast<std::size_t>(number)];
    core::StationPose pose;
    pose.origin = station.origin + core::seconds(time - begin_) * station.velocity;
    pose.velocity = station.velocity;
    pose.R_metric_station = Eigen::AngleAxisd(station.turn, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    if (absurd()) pose.origin(input_.between(0, 2)) = input_.absurd();
    if (absurd()) pose.velocity(input_.between(0, 2)) = input_.absurd();
    if (absurd()) pose.R_metric_station(input_.between(0, 2), input_.between(0, 2)) = input_.absurd();
    return pose;
  }

  Eigen::Vector2d anglesOf(const core::StationPose& pose, int target, core::Time time) {
    const Target& seen = targets_[static_cast<std::size_t>(target)];
    const Eigen::Vector3d ray = seen.position + core::seconds(time - begin_) * seen.velocity - pose.origin;
    const Eigen::Vector3d direction = pose.R_metric_station.transpose() * ray;
    Eigen::Vector2d angles =
        direction.allFinite() && direction.norm() > 0.0 ? core::anglesOf(direction) : Eigen::Vector2d(0, 0);
    angles += sigma_ * Eigen::Vector2d{input_.normal(), input_.normal()};
    return {core::wrapAngle(angles.x()), std::clamp(angles.y(), -core::kPi / 2.0, core::kPi / 2.0)};
  }

  core::StationTracks tracks(int station) {
    core::StationTracks report;
    report.tracker = nameOf(station);
    report.time = stamp();
    report.pose = poseAt(station, report.time);
    if (input_.chance(0.1)) report.views.resize(static_cast<std::size_t>(input_.between(1, 3)));
    const int copies = input_.chance(hazards_.floods) ? 200 : 1;
    for (int n = 0; n < copies; ++n) {
      for (std::size_t k = 0; k < targets_.size(); ++k) {
        core::Track track;
        track.id = static_cast<std::uint32_t>(k + 1 + static_cast<std::size_t>(n) * targets_.size());
        track.status = input_.chance(0.9) ? core::TrackStatus::confirmed : core::TrackStatus::coasting;
        track.state.mean.head<2>() = anglesOf(report.pose, static_cast<int>(k), report.time);
        const double rate_sigma = sigma_ * input_.oneOf({1.0, 10.0});
        track.state.mean.tail<2>() = rate_sigma * Eigen::Vector2d{input_.normal(), input_.normal()};
        track.state.covariance =
            Eigen::Vector4d{sigma_, sigma_, rate_sigma, rate_sigma}.cwiseAbs2().asDiagonal();
        track.last_sighting = report.time;
        track.sources = {"camera"};
        if (absurd()) track.state.mean(input_.between(0, 3)) = input_.absurd();
        if (absurd()) track.state.covariance(input_.between(0, 3), input_.between(0, 3)) = input_.absurd();
        if (absurd()) track.state.covariance *= input_.absurd();
        if (absurd()) track.id = 0;
        report.tracks.push_back(track);
      }
    }
    return report;
  }

  core::StationTracklet tracklet(int station, int target) {
    core::StationTracklet entry;
    entry.tracker = nameOf(station);
    entry.track = static_cast<std::uint32_t>(target + 1);
    entry.tracklet.time = stamp();
    entry.tracklet.sensor = input_.chance(0.9) ? "camera" : "other_camera";
    entry.pose = poseAt(station, entry.tracklet.time);
    const Eigen::Matrix2d R = sigma_ * sigma_ * Eigen::Matrix2d::Identity();
    const Eigen::Vector2d at = anglesOf(entry.pose, target, entry.tracklet.time);
    entry.tracklet.sighting = core::sightingOf(core::rejectionOf(at, R) ? Eigen::Vector2d(0, 0) : at, R);
    if (absurd()) entry.tracklet.sighting.covariance *= input_.absurd();
    if (absurd()) entry.tracklet.sighting.covariance(0, input_.between(0, 2)) = input_.absurd();
    if (absurd()) entry.tracklet.sighting.direction(input_.between(0, 2)) = input_.absurd();
    if (absurd()) entry.tracklet.sightings = input_.absurd();
    return entry;
  }

  RandomInput& input_;
  Hazards hazards_;
  double size_ = 100.0, sigma_ = 1e-3, interval_ = 0.03;  // [m], [rad], [s]
  core::Time begin_{}, time_{};
  std::vector<Station> stations_;
  std::vector<Target> targets_;
  std::size_t newcomers_ = 0;
};

void take(core::PositionTracker& tracker, const RandomStations::Message& message) {
  if (const auto* tracks = std::get_if<core::StationTracks>(&message))
    tracker.onTracks(*tracks);
  else
    tracker.onTracklets({std::get<core::StationTracklet>(message)});
}

core::Time timeOf(const RandomStations::Message& message) {
  if (const auto* tracks = std::get_if<core::StationTracks>(&message)) return tracks->time;
  return std::get<core::StationTracklet>(message).tracklet.time;
}

}  // namespace

void fuzzPositionTracker(RandomInput& input, Trial& trial) {
  core::PositionTracker tracker(randomPositions(input));
  RandomStations stations(input, randomHazards(input));
  for (int n = input.oneOf({30, 200, 600}); n > 0; --n) {
    const auto message = stations.next();
    trial.call("PositionTracker", [&] {
      take(tracker, message);
      if (!input.chance(0.5)) return;
      if (const auto output = tracker.report()) requireSound(*output);
    });
  }
}

void fuzzPositionArrivalOrder(RandomInput& input, Trial& trial) {
  core::PositionTrackerParams params = randomPositions(input);
  params.max_lag = std::max(params.max_lag, 1e-3);
  Hazards hazards = randomHazards(input);
  hazards.times = 0.0;
  RandomStations stations(input, hazards);
  struct Arrival {
    core::Time time;
    RandomStations::Message message;
  };
  std::vector<Arrival> sent;
  for (int n = input.oneOf({30, 200}); n > 0; --n) {
    const auto message = stations.next();
    sent.push_back({timeOf(message), message});
  }
  std::vector<Arrival> arrivals = sent;
  const double lag = 0.98 * params.max_lag * input.oneOf({1.0, 0.1, 0.001});
  for (Arrival& arrival : arrivals) arrival.time += core::durationOf(lag * input.unit());
  std::stable_sort(arrivals.begin(), arrivals.end(),
                   [](const Arrival& a, const Arrival& b) { return a.time < b.time; });
  const auto outputOf = [&](const std::vector<Arrival>& messages, double asked) {
    core::PositionTracker tracker(params);
    std::optional<core::PositionOutput> output;
    for (const Arrival& arrival : messages) {
      trial.call("PositionTracker", [&] {
        take(tracker, arrival.message);
        if (input.chance(asked)) tracker.report();
      });
    }
    trial.call("PositionTracker::report", [&] { output = tracker.report(); });
    return output ? bytesOf(*output) : std::string();
  };
  const std::string expected = outputOf(sent, 1.0);
  require(expected == outputOf(arrivals, 0.3), "positions depend on the order in which tracks arrive");
}

}  // namespace sightline_fuzz
