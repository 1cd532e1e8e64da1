#include "sightline/core/fusion/track_fusion.h"

#include <utility>

namespace sightline::core {
namespace {

void add(TrackletLosses losses, TrackletLosses& sum) {
  sum.late += losses.late;
  if (losses.failed.count == 0) return;
  sum.failed.count += losses.failed.count;
  sum.failed.latest = std::move(losses.failed.latest);
}

}  // namespace

TrackFusion::TrackFusion(const TrackFusionParams& params)
    : params_(params),
      thresholds_(thresholdsOf(params)),
      reports_(params.reports),
      tracklets_(memoryParamsOf(params)),
      tracks_(params),
      association_(params) {
  requireValid(params);
}

FusionReport TrackFusion::onReport(const LocalReport& report, std::optional<Time> arrival) {
  if (const auto refusal = reports_.take(report, arrival))
    return describeRefused(latest_, report, *refusal, static_cast<std::size_t>(params_.reports.max_tracks));
  tracks_.follow(reports_, report.tracker);
  association_.learnMisalignment(tracks_, report.tracker);
  association_.splitContradicting(tracks_, tracklets_, report.tracker);
  association_.reassign(tracks_, reports_, tracklets_, report.tracker);
  for (const auto& [tracker, _] : reports_.trackers())
    association_.associate(tracks_, reports_, tracklets_, tracker, tracker == report.tracker);
  for (GlobalTrackEntry& entry : tracks_.entries())
    add(fuse(entry, report.tracker, tracklets_, params_, thresholds_), losses_);
  tracks_.deleteSilent();
  latest_ = describe(tracks_, reports_, association_.waiting());
  return latest_;
}

std::optional<Refusal> TrackFusion::onTracklets(const TrackletReport& report) {
  return tracklets_.take(report);
}

void TrackFusion::reset() {
  reports_ = LocalReports(params_.reports);
  tracklets_ = TrackletMemory(memoryParamsOf(params_));
  tracks_.reset();
  association_.reset();
  latest_ = {};
}

}  // namespace sightline::core
