#include <set>

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

std::vector<core::TrueTarget> targetsOf(const std::map<std::uint32_t, Eigen::Vector2d>& truth) {
  std::vector<core::TrueTarget> targets;
  for (const auto& [id, angles] : truth) {
    core::TrueTarget target;
    target.id = id;
    target.state.mean << angles, 0.0, 0.0;
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
    score.add(tracks, targetsOf(recording.truths[k]), kCutoff, listener);
  }
  figures.gospa = score.gospaMeans().distance();
  figures.localisation = score.gospaMeans().localisation();
  figures.missed = score.gospaMeans().missed();
  figures.extra = score.gospaMeans().extra();
  figures.id_switches = static_cast<int>(score.continuity().idSwitches());
  figures.breaks = static_cast<int>(score.continuity().breaks());
  figures.coverage = score.continuity().coverage();
  for (const auto& [id, life] : lives) {
    ++figures.tracks;
    if (2 * life.on_target < life.reports) ++figures.false_tracks;
  }
  if (!recording.scans.empty())
    figures.hours = core::seconds(recording.scans.back().time - recording.scans.front().time) / 3600.0;
  return figures;
}

}  // namespace sightline::bench
