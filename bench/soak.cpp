// A day of simulated time through the core: two trackers of two sensors each, and their fusion.
// Memory must stay flat, and the target must keep its id.
//
//   soak [--hours H] [--rows N]      (0.2 h, 24 rows; at least 4)
//
// The target never leaves. Sensors miss one sighting in ten, each shows a false one in every third scan, each
// is covered for ten seconds now and then (never all at once), and every fiftieth scan comes 0.2 s late.
// Prints a row for every part of the time: memory on the heap, ids that a confirmed track near the target has
// had since the start, largest time without one, processor time. Exit code 1 when memory, as a mean of rows,
// grows by more than a tenth from the second quarter of the time to the last, or there is more than one id.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <deque>
#include <malloc.h>
#include <numeric>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "sightline/core/fusion/track_fusion.h"
#include "sightline/core/model/sphere.h"
#include "sightline/core/positions/position_tracker.h"
#include "sightline/core/tracking/local_tracker.h"
#include "sightline/core/tracking/tracklet_builder.h"
#include "sightline/report/command_line.h"

#include "processor_time.h"

namespace sightline::bench {
namespace {

constexpr double kInterval = 1.0 / 30.0;  // of each sensor [s]
constexpr double kSigma = 1e-3;           // [rad]
constexpr double kNear = 8e-3;            // from the target, for its track [rad]
constexpr double kFirst = 1000.0;         // stamp of the start [s]
constexpr double kGrowth = 1.1;           // of the memory, at most
constexpr int kSensors = 4;

/// Seconds since the start as a stamp.
core::Time stampOf(double t) {
  return core::Time{} + core::durationOf(kFirst + t);
}

Eigen::Vector2d directionAt(double t) {
  return {0.8 * std::sin(0.11 * t), 0.3 + 0.2 * std::sin(0.07 * t)};
}

double bytesOnHeap() {
  const auto info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

/// What was seen of the target so far.
struct Account {
  std::set<std::uint32_t> ids;
  double held = 0.0, longest_gap = 0.0;  // when a track was near last, and the longest time without [s]

  void take(const std::vector<core::FusedTrack>& tracks, core::Time time) {
    const double t = core::seconds(time - stampOf(0.0));
    for (const core::FusedTrack& fused : tracks) {
      if (fused.track.status != core::TrackStatus::confirmed) continue;
      if (core::angleDifference(fused.track.state.angles(), directionAt(t)).norm() > kNear) continue;
      ids.insert(fused.track.id);
      held = std::max(held, t);
    }
    longest_gap = std::max(longest_gap, t - held);
  }
};

/// Two trackers, each with two sensors, and the fusion of both.
class Platform {
 public:
  Platform() {
    for (Source& source : sources_) source.name = "tracker_" + std::to_string(&source - sources_.data());
  }

  void step(double t, Account& account) {
    for (int sensor = 0; sensor < kSensors; ++sensor) {
      const core::Scan scan = scanAt(t + kInterval * sensor / kSensors, sensor);
      if (chance(0.02))
        late_.push_back({t + 0.2, sensor, scan});
      else
        take(sensor, scan, account);
    }
    while (!late_.empty() && late_.front().due <= t) {
      take(late_.front().sensor, late_.front().scan, account);
      late_.pop_front();
    }
  }

 private:
  struct Source {
    std::string name;
    core::LocalTracker tracker{core::LocalTrackerParams{}};
    core::TrackletBuilder tracklets{core::TrackletParams{}};
  };
  struct Late {
    double due;
    int sensor;
    core::Scan scan;
  };

  bool chance(double probability) { return std::uniform_real_distribution<double>()(random_) < probability; }

  core::Scan scanAt(double t, int sensor) {
    core::Scan scan;
    scan.time = stampOf(t);
    scan.sensor = "sensor_" + std::to_string(sensor);
    const bool is_covered = std::fmod(t + 150.0 * sensor, 600.0) > 590.0;
    const Eigen::Matrix2d R = kSigma * kSigma * Eigen::Matrix2d::Identity();
    const Eigen::Vector2d noise = kSigma * Eigen::Vector2d(normal_(random_), normal_(random_));
    if (!is_covered && chance(0.9)) scan.sightings.push_back(core::sightingOf(directionAt(t) + noise, R));
    if (chance(0.3))
      scan.sightings.push_back(core::sightingOf({3.0 * normal_(random_), 0.3 * normal_(random_)}, R));
    return scan;
  }

  void take(int sensor, const core::Scan& scan, Account& account) {
    Source& source = sources_[static_cast<std::size_t>(sensor % 2)];
    const core::ScanReport tracked = source.tracker.onScan(scan);
    if (auto tracklets = source.tracklets.onScan(scan, tracked)) {
      tracklets->tracker = source.name;
      fusion_.onTracklets(*tracklets);
    }
    if (fusion_.take({source.name, tracked.time, tracked.tracks}) || !fusion_.isDue()) return;
    const core::FusionReport fused = fusion_.fuse();
    account.take(fused.tracks, fused.time);
  }

  std::array<Source, 2> sources_;
  core::TrackFusion fusion_{core::TrackFusionParams{}};
  std::deque<Late> late_;
  std::mt19937_64 random_{1};
  std::normal_distribution<double> normal_;
};

/// Mean of the rows from one quarter of the time to the next.
double meanOfQuarter(const std::vector<double>& rows, std::size_t quarter) {
  const auto first = static_cast<std::ptrdiff_t>(rows.size() * quarter / 4);
  const auto last = static_cast<std::ptrdiff_t>(rows.size() * (quarter + 1) / 4);
  return std::accumulate(rows.begin() + first, rows.begin() + last, 0.0) / static_cast<double>(last - first);
}

void soak(const std::vector<std::string>& words) {
  const report::CommandLine line(words, {"--hours", "--rows"}, 0, 0);
  const double hours = line.number("--hours", 0.2, report::NumberRange::above_zero);
  const int rows = std::max(4, line.wholeNumber("--rows", 24));
  Platform platform;
  Account account;
  std::vector<double> memory;
  const auto steps = static_cast<long>(hours * 3600.0 / kInterval);
  std::printf("%10s %12s %6s %16s %20s\n", "time [h]", "heap [MB]", "ids", "longest gap [s]",
              "processor time [s]");
  for (long k = 1, row = 1; k <= steps; ++k) {
    platform.step(kInterval * static_cast<double>(k), account);
    if (k * rows < row * steps) continue;
    ++row;
    memory.push_back(bytesOnHeap());
    std::printf("%10.2f %12.3f %6zu %16.2f %20.1f\n", kInterval * static_cast<double>(k) / 3600.0,
                memory.back() / 1e6, account.ids.size(), account.longest_gap, processorTime());
    std::fflush(stdout);
  }
  const double growth = meanOfQuarter(memory, 3) / meanOfQuarter(memory, 1);
  std::printf("heap of the last quarter over that of the second: %.3f\n", growth);
  if (growth > kGrowth) throw std::runtime_error("memory grows");
  if (account.ids.size() != 1) throw std::runtime_error("the target has had several ids, or none");
}

}  // namespace
}  // namespace sightline::bench

int main(int argc, char** argv) {
  return sightline::report::runTool(argc, argv, "usage: soak [--hours H] [--rows N]\n",
                                    sightline::bench::soak);
}
