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
      rounds_(params.max_wait),
      tracklets_(memoryParamsOf(params)),
      tracks_(params),
      association_(params) {
  requireValid(params);
}

std::optional<Refusal> TrackFusion::take(const LocalReport& report, std::optional<Time> arrival) {
  auto refusal = reports_.take(report, arrival);
  if (!refusal) rounds_.note(report.tracker, reports_);
  return refusal;
}

FusionReport TrackFusion::fuse() {
  const NewReports new_reports = rounds_.end(reports_);
  tracks_.follow(reports_, new_reports);
  for (const auto& [tracker, _] : new_reports) association_.learnMisalignment(tracks_, tracker);
  association_.splitContradicting(tracks_, tracklets_, new_reports);
  for (const auto& [tracker, _] : new_reports) association_.reassign(tracks_, reports_, tracklets_, tracker);
  for (const auto& [tracker, _] : reports_.trackers())
    association_.associate(tracks_, reports_, tracklets_, tracker, new_reports.count(tracker) > 0);
  for (GlobalTrackEntry& entry : tracks_.entries())
    add(sightline::core::fuse(entry, new_reports, tracklets_, params_, thresholds_), losses_);
  tracks_.deleteSilent();
  return describe(tracks_, reports_, association_.waiting());
}

FusionReport TrackFusion::onReport(const LocalReport& report, std::optional<Time> arrival) {
  if (const auto refusal = take(report, arrival))
    return describeRefused(describe(tracks_, reports_, association_.waiting()), report, *refusal,
                           static_cast<std::size_t>(params_.reports.max_tracks));
  return fuse();
}

std::optional<Refusal> TrackFusion::onTracklets(const TrackletReport& report) {
  return tracklets_.take(report);
}

std::optional<Refusal> TrackFusion::reconfigure(const TrackFusionParams& wanted) {
  if (auto refusal = whyNotInFlight(params_, wanted)) return refusal;
  // What was not taken while no rule used it would count as lost.
  if (usesTracklets(wanted.rule) != usesTracklets(params_.rule))
    tracklets_ = TrackletMemory(memoryParamsOf(wanted));
  params_ = wanted;
  thresholds_ = thresholdsOf(wanted);
  tracks_.reconfigure(wanted);
  association_.reconfigure(wanted);
  return std::nullopt;
}

void TrackFusion::reset() {
  reports_ = LocalReports(params_.reports);
  rounds_ = ReportRounds(params_.max_wait);
  tracklets_ = TrackletMemory(memoryParamsOf(params_));
  tracks_.reset();
  association_.reset();
}

}  // namespace sightline::core
