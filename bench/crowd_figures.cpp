#include <algorithm>

#include "sightline/core/evaluation/track_score.h"
#include "sightline/core/model/sphere.h"

#include "crowd.h"
#include "processor_time.h"

namespace sightline::bench {
namespace {

constexpr double kCutoff = 0.01;  // [rad]

struct Life {
  int reports = 0, on_target = 0;
};

/// Those at scan k. Their rates are those between the scans before and after it.
std::vector<core::TrueTarget> targetsOf(const CrowdRecording& recording, std::size_t k) {
  const std::size_t before = k > 0 ? k - 1 : k, after = std::min(k + 1, recording.scans.size() - 1);
  std::vector<core::TrueTarget> targets;
  for (const auto& [id, angles] : recording.truths[k]) {
    const auto seenIn = [&, id = id](std::size_t scan) {  // the nearest scan in which the target is there
      return recording.truths[scan].count(id) > 0 ? scan : k;
    };
    const std::size_t from = seenIn(before), to = seenIn(after);
    const double h = core::seconds(recording.scans[to].time - recording.scans[from].time);
    core::TrueTarget target;
    target.id = id;
    target.state.mean << angles, 0.0, 0.0;
    if (h > 0.0)
      target.state.mean.tail<2>() =
          core::angleDifference(recording.truths[to].at(id), recording.truths[from].at(id)) / h;
    target.state.covariance.setZero();
    targets.push_back(target);
  }
  return targets;
}

}  // namespace

CrowdFigures follow(const CrowdRecording& recording, const core::LocalTrackerParams& params) {
  core::LocalTracker tracker(params);
  core::TrackScore score("tracks", core::Channels::azimuth_and_elevation, core::GospaParams{kCutoff, 2.0});
  std::map<std::uint32_t, Life> lives;
  core::ScoreListener listener;
  listener.pair = [&](const core::ScoredPair& pair) { ++lives[pair.track].on_target; };
  CrowdFigures figures;
  for (std::size_t k = 0; k < recording.scans.size(); ++k) {
    const double before = processorTime();
    core::ScanReport report = tracker.onScan(recording.scans[k]);
    figures.seconds += processorTime() - before;
    core::TrackReport tracks;
    tracks.time = report.time;
    tracks.tracks = std::move(report.tracks);
    for (const core::Track& track : tracks.tracks) {
      if (track.status != core::TrackStatus::tentative) ++lives[track.id].reports;
    }
    score.add(tracks, targetsOf(recording, k), kCutoff, listener);
  }
  figures.gospa = score.gospaMeans().distance();
  figures.localisation = score.gospaMeans().localisation();
  figures.missed = score.gospaMeans().missed();
  figures.extra = score.gospaMeans().extra();
  figures.id_switches = static_cast<int>(score.continuity().idSwitches());
  figures.breaks = static_cast<int>(score.continuity().breaks());
  figures.coverage = score.continuity().coverage();
  figures.position_anees = score.errors().aneesPosition();
  figures.state_anees = score.errors().aneesState();
  for (const auto& [id, life] : lives) {
    ++figures.tracks;
    if (2 * life.on_target < life.reports) ++figures.false_tracks;
  }
  if (!recording.scans.empty())
    figures.hours = core::seconds(recording.scans.back().time - recording.scans.front().time) / 3600.0;
  return figures;
}

}  // namespace sightline::bench
