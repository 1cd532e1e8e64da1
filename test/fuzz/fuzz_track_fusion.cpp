#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <variant>

#include "sightline/core/fusion/track_fusion.h"
#include "sightline/core/model/sphere.h"
#include "sightline/core/tracking/local_tracker.h"
#include "sightline/core/tracking/tracklet_builder.h"

#include "fuzz/fuzz_targets.h"
#include "fuzz/random_params.h"
#include "fuzz/random_scans.h"

namespace sightline_fuzz {

namespace core = sightline::core;

namespace {

/// A fusion that is watched.
class WatchedFusion {
 public:
  WatchedFusion(RandomInput& input, Trial& trial)
      : input_(input), trial_(trial), fusion_(randomFusion(input)) {}

  /// In turn as a node does it, and at once.
  void take(const core::LocalReport& report) {
    is_at_once_ = !is_at_once_;
    trial_.call("TrackFusion::onReport", [&] {
      if (!is_at_once_ && (fusion_.take(report, arrival_) || !fusion_.isDue())) return;
      const core::FusionReport fused = is_at_once_ ? fusion_.onReport(report, arrival_) : fusion_.fuse();
      requireSound(fused);
      for (const core::FusedTrack& track : fused.tracks) {
        require(track.track.id > highest_before_reset_, "an id of before the reset is used again");
        highest_ = std::max(highest_, track.track.id);
      }
    });
  }

  void take(const core::TrackletReport& report) {
    trial_.call("TrackFusion::onTracklets", [&] { fusion_.onTracklets(report); });
  }

  /// The clock of arrival goes on, or is not known.
  void pass(double seconds) {
    if (arrival_) *arrival_ += core::durationOf(seconds);
    if (!input_.chance(0.002)) return;
    fusion_.reset();
    highest_before_reset_ = highest_;
  }

  void knowArrival() { arrival_ = core::timeOf(1000000000); }

 private:
  RandomInput& input_;
  Trial& trial_;
  core::TrackFusion fusion_;
  std::optional<core::Time> arrival_;
  bool is_at_once_ = false;
  std::uint32_t highest_ = 0, highest_before_reset_ = 0;
};

/// What local trackers could report of the targets: errors are right, too large or too small, and the
/// covariances of every shape.
class RandomReports {
 public:
  RandomReports(RandomInput& input, const Hazards& hazards)
      : input_(input), hazards_(hazards), scans_(input, Hazards{}) {
    trackers_ = input.oneOf({1, 2, 2, 3, 6});
    sigma_ = input.logBetween(1e-7, 0.3);
    rate_sigma_ = sigma_ * input.logBetween(0.1, 100.0);
    shape_ = input.oneOf({1.0, 1.0, 30.0, 1e4});
    shared_ = input.chance(0.2);
    interval_ = input.oneOf({0.03, 0.03, 0.5, 10.0});
    time_ = scans_.time();
  }

  double interval() const { return interval_; }

  core::LocalReport report() {
    const int tracker = input_.between(0, trackers_ - 1);
    time_ += core::durationOf(interval_ * input_.unit());
    core::LocalReport report{nameOf(tracker), stamp(), {}};
    int tracks = input_.between(0, 5);
    if (input_.chance(hazards_.floods)) tracks = 1500;
    for (int k = 0; k < tracks; ++k) report.tracks.push_back(track(k, tracker, report.time));
    return report;
  }

  core::TrackletReport tracklets() {
    const int tracker = input_.between(0, trackers_ - 1);
    core::TrackletReport report;
    report.tracker = nameOf(tracker);
    report.time = stamp();
    if (input_.chance(0.9)) report.since = report.time - core::durationOf(interval_);
    const int count = input_.chance(hazards_.floods) ? 3000 : input_.between(0, 8);
    for (int n = 0; n < count; ++n) {
      core::Tracklet tracklet;
      tracklet.time = report.time - core::durationOf(interval_ * input_.unit());
      tracklet.sensor = sensorOf(tracker);
      const int k = input_.between(0, 4);
      const Eigen::Matrix2d R = sigma_ * sigma_ * Eigen::Vector2d{1.0, shape_}.asDiagonal();
      const Eigen::Vector2d at = noisy(k, tracklet.time);
      if (core::rejectionOf(at, R)) continue;
      tracklet.sighting = core::sightingOf(at, R);
      if (absurd()) tracklet.sighting.covariance *= input_.absurd();
      if (absurd()) tracklet.sighting.direction(input_.between(0, 2)) = input_.absurd();
      if (absurd()) tracklet.sighting.covariance(0, input_.between(0, 2)) = input_.absurd();
      if (absurd()) tracklet.sightings = input_.absurd();
      if (absurd()) tracklet.ifov = input_.absurd();
      report.tracklets.push_back({static_cast<std::uint32_t>(k + 1), tracklet});
    }
    return report;
  }

 private:
  bool absurd() { return input_.chance(hazards_.values); }

  std::string nameOf(int tracker) {
    if (input_.chance(hazards_.newcomers)) return "newcomer_" + std::to_string(newcomers_++);
    return "tracker_" + std::to_string(tracker);
  }

  std::string sensorOf(int tracker) const { return "sensor_" + std::to_string(shared_ ? 0 : tracker); }

  core::Time stamp() {
    if (!input_.chance(hazards_.times)) return time_;
    const int kind = input_.between(0, 3);
    if (kind == 0) return core::timeOf(static_cast<std::int64_t>(input_.between(0.0, 4.2e18)));
    if (kind == 1 && input_.chance(0.1)) time_ += core::durationOf(input_.logBetween(0.1, 1e7));
    return std::max(core::Time{}, time_ - core::durationOf(input_.logBetween(1e-9, 30.0)));
  }

  Eigen::Vector2d noisy(int k, core::Time time) {
    Eigen::Vector2d at = scans_.targetAt(static_cast<std::size_t>(k), time) +
                         sigma_ * Eigen::Vector2d{input_.normal(), std::sqrt(shape_) * input_.normal()};
    at = {core::wrapAngle(at.x()), std::clamp(at.y(), -core::kPi / 2.0, core::kPi / 2.0)};
    return at;
  }

  core::Track track(int k, int tracker, core::Time time) {
    core::Track track;
    track.id = static_cast<std::uint32_t>(input_.chance(0.95) ? k + 1 : input_.between(0, 2000));
    track.status = input_.oneOf({core::TrackStatus::confirmed, core::TrackStatus::confirmed,
                                 core::TrackStatus::tentative, core::TrackStatus::coasting});
    track.state.mean.head<2>() = noisy(k, time);
    track.state.mean.tail<2>() = scans_.ratesOf(static_cast<std::size_t>(k)) +
                                 rate_sigma_ * Eigen::Vector2d{input_.normal(), input_.normal()};
    const double correlation = input_.oneOf({0.0, 0.7, 0.999999, -1.0});
    Eigen::Vector4d sigmas{sigma_, sigma_ * std::sqrt(shape_), rate_sigma_, rate_sigma_};
    Eigen::Matrix4d& P = track.state.covariance;
    P = sigmas.cwiseAbs2().asDiagonal();
    P(0, 2) = P(2, 0) = correlation * sigmas(0) * sigmas(2);
    P(1, 3) = P(3, 1) = correlation * sigmas(1) * sigmas(3);
    track.last_sighting = time - core::durationOf(input_.oneOf({0.0, 0.01, 0.4, 3.0}));
    track.hits = static_cast<std::uint32_t>(input_.between(1, 100));
    track.existence = input_.unit();
    track.sources = {sensorOf(tracker)};
    if (absurd()) track.state.mean(input_.between(0, 3)) = input_.absurd();
    if (absurd()) P(input_.between(0, 3), input_.between(0, 3)) = input_.absurd();
    if (absurd()) P *= input_.absurd();
    if (absurd()) {
      const int i = input_.between(0, 3);
      const double factor = input_.absurd();
      P.row(i) *= factor;
      P.col(i) *= factor;
    }
    if (absurd()) track.existence = input_.absurd();
    if (absurd()) track.sources = {"", "", std::string(2000, 'x')};
    if (absurd()) track.status = static_cast<core::TrackStatus>(input_.between(0, 255));
    return track;
  }

  RandomInput& input_;
  Hazards hazards_;
  RandomScans scans_;  // of which only the targets are used
  int trackers_ = 1;
  double sigma_ = 1e-3, rate_sigma_ = 1e-2, shape_ = 1.0, interval_ = 0.03;
  bool shared_ = false;
  core::Time time_{};
  std::size_t newcomers_ = 0;
};

}  // namespace

void fuzzTrackFusion(RandomInput& input, Trial& trial) {
  WatchedFusion fusion(input, trial);
  if (input.chance(0.7)) fusion.knowArrival();
  RandomReports reports(input, randomHazards(input));
  const bool has_tracklets = input.chance(0.7);
  for (int n = input.oneOf({20, 100, 300}); n > 0; --n) {
    if (has_tracklets && input.chance(0.5)) fusion.take(reports.tracklets());
    fusion.take(reports.report());
    fusion.pass(reports.interval());
  }
}

/// Local trackers with each some of the sensors, and what lies between them and the fusion: losses, delays,
/// repeats.
void fuzzFusedTrackers(RandomInput& input, Trial& trial) {
  struct Source {
    std::string name;
    core::LocalTracker tracker;
    core::TrackletBuilder tracklets;
  };
  using Message = std::variant<core::LocalReport, core::TrackletReport>;

  WatchedFusion fusion(input, trial);
  if (input.chance(0.7)) fusion.knowArrival();
  std::vector<Source> sources;
  core::LocalTrackerParams params = randomTracker(input);
  for (int i = input.oneOf({1, 2, 3}); i > 0; --i) {
    if (input.chance(0.3)) params = randomTracker(input);
    sources.push_back(
        {"tracker_" + std::to_string(i), core::LocalTracker(params), core::TrackletBuilder({})});
  }
  RandomScans scans(input, randomHazards(input));
  const double lost = input.oneOf({0.0, 0.0, 0.1, 0.6}), repeated = input.oneOf({0.0, 0.0, 0.1});
  const double delayed = input.oneOf({0.0, 0.0, 0.3});
  std::deque<Message> held;
  const auto send = [&](Message message) {
    if (input.chance(lost)) return;
    if (input.chance(delayed)) {
      held.push_back(std::move(message));
      return;
    }
    std::visit([&](const auto& report) { fusion.take(report); }, message);
    if (input.chance(repeated)) std::visit([&](const auto& report) { fusion.take(report); }, message);
    if (!held.empty() && input.chance(0.3)) {
      std::visit([&](const auto& report) { fusion.take(report); }, held.front());
      held.pop_front();
    }
  };
  for (int n = input.oneOf({20, 150, 300}); n > 0; --n) {
    const core::Scan scan = scans.next();
    Source& source = sources[scan.sensor.back() % sources.size()];
    core::ScanReport tracked;
    trial.call("LocalTracker::onScan", [&] { tracked = source.tracker.onScan(scan); });
    if (auto tracklets = source.tracklets.onScan(scan, tracked)) {
      tracklets->tracker = source.name;
      send(*tracklets);
    }
    send(core::LocalReport{source.name, tracked.time, tracked.tracks});
    fusion.pass(0.01);
  }
}

}  // namespace sightline_fuzz
