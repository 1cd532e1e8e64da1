#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "sightline/core/positions/position_tracker.h"
#include "sightline/core/simulation/random_stream.h"

#include "parallel.h"
#include "position_recordings.h"
#include "position_tables.h"
#include "quantiles.h"
#include "support/simulated_field.h"

namespace sightline::bench {
namespace {

using Vector = Eigen::Vector3d;

constexpr double kFrom = 20.0, kUntil = 40.0;  // [s] in which the errors count
constexpr double kLook = 0.1;                  // [s]
constexpr double kReach = 2.0;                 // [m] within which a position is a target's
constexpr std::size_t kFaulty = 3;             // number of the station

struct Fault {
  double clock = 0.0;  // stamps later than they should be [s]
  double angle = 0.0;  // by which it is turned, about an axis that differs from run to run [rad]
};

/// What one run gives, of the tracker that knows the station and of the one that does not.
struct Figures {
  double squares = 0.0, known_squares = 0.0, nees = 0.0, known_nees = 0.0;
  int looks = 0, known_looks = 0, asked = 0;
  std::optional<double> clock_error,
      orientation_error;  // over the standard deviation; the latter squared, of 3
  double clock_sigma = 0.0, orientation_sigma = 0.0, found_at = 0.0;
  int wrongly = 0;  // other stations that are corrected
};

test::Path circle(core::RandomStream& random) {
  const Vector centre(30 + 30 * random.uniform(), 35 + 30 * random.uniform(), 15 + 20 * random.uniform());
  const double radius = 8 + 12 * random.uniform(), rate = 0.3 + 0.3 * random.uniform(),
               phase = 6.28 * random.uniform();
  return [=](double t) {
    return Vector(centre.x() + radius * std::cos(rate * t + phase),
                  centre.y() + radius * std::sin(rate * t + phase),
                  centre.z() + 3.0 * std::sin(0.7 * rate * t + phase));
  };
}

/// Errors at `time`, to which positions are moved back: a late clock makes reports be ahead of the newest
/// data.
void score(const core::PositionOutput& output, double time, const std::vector<test::Path>& paths,
           double& squares, double& nees, int& looks) {
  const double ahead = secondsOf(output.tracks.time) - time;
  for (const test::Path& path : paths) {
    const Vector truth = path(time);
    const core::PositionTrack* nearest = nullptr;
    double reach = kReach;
    for (const core::PositionTrack& track : output.tracks.tracks) {
      const double distance = (track.position - ahead * track.velocity - truth).norm();
      if (track.status != core::TrackStatus::confirmed || distance > reach) continue;
      reach = distance;
      nearest = &track;
    }
    if (!nearest) continue;
    const Vector error = nearest->position - ahead * nearest->velocity - truth;
    squares += error.squaredNorm();
    nees += error.dot(nearest->covariance.topLeftCorner<3, 3>().llt().solve(error)) / 3.0;
    ++looks;
  }
}

Figures runOf(const Fault& fault, std::uint64_t seed) {
  core::RandomStream random(seed);
  std::vector<test::Path> paths;
  for (int i = 0; i < 3; ++i) paths.push_back(circle(random));
  Vector axis(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
  const Vector turned = fault.angle * axis.normalized();
  const Eigen::Matrix3d R = fault.angle > 0.0
                                ? Eigen::AngleAxisd(fault.angle, axis.normalized()).toRotationMatrix()
                                : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  test::SimulatedField field(test::fieldStations(4), paths, seed);
  core::PositionTracker knows, does_not;
  Figures figures;
  double next = kFrom;
  std::optional<core::PositionOutput> last;
  double next_report = 0.0;
  for (test::FieldMessage message = field.next(); message.time < kUntil; message = field.next()) {
    knows.onTracklets(message.tracklets);
    knows.onTracks(message.tracks);
    if (message.tracks.tracker == test::fieldStations(4)[kFaulty].name) {
      const core::Duration late = core::durationOf(fault.clock);
      message.tracks.time += late;
      message.tracks.pose.R_metric_station = R * message.tracks.pose.R_metric_station;
      for (core::StationTracklet& tracklet : message.tracklets) {
        tracklet.tracklet.time += late;
        tracklet.pose.R_metric_station = R * tracklet.pose.R_metric_station;
      }
    }
    does_not.onTracklets(message.tracklets);
    does_not.onTracks(message.tracks);
    if (message.time < next_report) continue;
    next_report += kLook;
    const auto known = knows.report();
    last = does_not.report();
    for (const core::StationReport& station : last->report.stations) {
      const bool is_faulty = station.tracker == test::fieldStations(4)[kFaulty].name;
      if (is_faulty && station.is_corrected && figures.found_at == 0.0) figures.found_at = message.time;
      if (!is_faulty && station.is_corrected && message.time > next) ++figures.wrongly;
    }
    if (message.time < next) continue;
    next += kLook;
    figures.asked += 3;
    const double time = secondsOf(known->tracks.time);
    score(*known, time, paths, figures.known_squares, figures.known_nees, figures.known_looks);
    score(*last, time, paths, figures.squares, figures.nees, figures.looks);
  }
  for (const core::StationReport& station : last->report.stations) {
    if (station.tracker != test::fieldStations(4)[kFaulty].name || !station.is_corrected) continue;
    const core::StationAlignmentEstimate& found = *station.alignment;
    figures.clock_error = (found.clock - fault.clock) / found.clock_sigma;
    double worst = 0.0;
    for (int i = 0; i < 3; ++i)
      worst = std::max(worst, std::abs(found.orientation(i) - turned(i)) / found.orientation_sigma(i));
    figures.orientation_error = worst;
    figures.clock_sigma = found.clock_sigma;
    figures.orientation_sigma = found.orientation_sigma.norm();
  }
  return figures;
}

}  // namespace

void misalignedStation(int runs) {
  std::printf("\none of four stations is off, unannounced, three targets, errors from 20 to 40 s, %d runs\n",
              runs);
  std::printf("%-18s %6s %6s %7s %7s %6s %6s %7s %7s %9s %9s %6s\n", "", "rms m", "/known", "ANEES", "known",
              "found", "at s", "clock", "turned", "sigma ms", "mrad", "false");
  const std::pair<const char*, Fault> faults[] = {
      {"5 mrad, 50 ms", {0.05, 5e-3}}, {"none", {}}, {"50 ms", {0.05, 0.0}}, {"2 mrad", {0.0, 2e-3}}};
  for (const auto& [name, fault] : faults) {
    std::vector<Figures> all(static_cast<std::size_t>(runs));
    forEachRun(runs, 2, [&, &fault = fault](int run) {
      all[static_cast<std::size_t>(run)] = runOf(fault, static_cast<std::uint64_t>(run + 1));
    });
    Figures sum;
    int found = 0, clock_honest = 0, turned_honest = 0;
    std::vector<double> at;
    for (const Figures& f : all) {
      sum.squares += f.squares;
      sum.known_squares += f.known_squares;
      sum.nees += f.nees;
      sum.known_nees += f.known_nees;
      sum.looks += f.looks;
      sum.known_looks += f.known_looks;
      sum.wrongly += f.wrongly > 0 ? 1 : 0;
      if (!f.clock_error) continue;
      ++found;
      at.push_back(f.found_at);
      if (std::abs(*f.clock_error) < 3.0) ++clock_honest;
      if (*f.orientation_error < 3.0) ++turned_honest;
      sum.clock_sigma += f.clock_sigma;
      sum.orientation_sigma += f.orientation_sigma;
    }
    const double rms = std::sqrt(sum.squares / sum.looks),
                 known = std::sqrt(sum.known_squares / sum.known_looks);
    std::printf("%-18s %6.4f %6.3f %7.2f %7.2f %6d %6.1f %7d %7d %9.2f %9.3f %6d\n", name, rms, rms / known,
                sum.nees / sum.looks, sum.known_nees / sum.known_looks, found, at.empty() ? 0.0 : median(at),
                clock_honest, turned_honest, 1e3 * sum.clock_sigma / std::max(found, 1),
                1e3 * sum.orientation_sigma / std::max(found, 1), sum.wrongly);
  }
}

}  // namespace sightline::bench
