#include "sightline/core/fusion/fusion_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>

#include "sightline/core/fusion/global_tracks.h"
#include "sightline/core/fusion/track_alignment.h"
#include "sightline/core/model/name.h"
#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kGateSigmas = 3.0;  // half width of the reported gate

SourceTrack rowOf(const Supporter& supporter, Time now) {
  SourceTrack row;
  row.tracker = supporter.key.tracker;
  row.id = supporter.key.id;
  if (std::isfinite(supporter.distance_squared)) row.distance_squared = supporter.distance_squared;
  row.age = seconds(now - supporter.local.time);
  return row;
}

/// What a global track has of its contributors beside the state.
void summarize(const std::vector<const Track*>& contributors, Track& track) {
  track.status = TrackStatus::coasting;
  track.existence = std::numeric_limits<double>::quiet_NaN();
  track.misses = 0;
  for (const Track* local : contributors) {
    if (local->status == TrackStatus::confirmed) track.status = TrackStatus::confirmed;
    track.last_sighting = std::max(track.last_sighting, local->last_sighting);
    track.existence = std::fmax(track.existence, local->existence);
  }
}

void setState(const AngularState& state_tracking, FusedTrack& description) {
  Track& track = description.track;
  description.withheld = whyNoTrack(state_tracking);
  track.state = {state_tracking.mean, symmetric(state_tracking.covariance)};
  track.state.mean(0) = wrapAngle(track.state.mean(0));
  track.gate.centre = track.state.angles();
  track.gate.covariance = track.state.anglesCovariance();
  track.gate.half_width = kGateSigmas * track.gate.covariance.diagonal().cwiseSqrt();
}

SourceTrack leftOutRow(const std::string& tracker, std::uint32_t id, double age, const Refusal& why) {
  SourceTrack row;
  row.tracker = tracker;
  row.id = id;
  row.age = age;
  row.reason = why;
  return row;
}

/// Why a local track supports no global one.
Refusal whyFree(const LocalKey& key, const LocalTrack& local, const GlobalTracks& tracks,
                const LocalReports& reports, const std::map<LocalKey, std::uint32_t>& waiting) {
  if (auto why = reports.whyUnusable(key.tracker, local)) return *why;
  const auto waits = waiting.find(key);
  if (waits != waiting.end()) {
    return {"contested", "another track of its tracker still has its place in global track " +
                             std::to_string(waits->second)};
  }
  if (local.track.status == TrackStatus::coasting) return {"coasting", "it cannot start a global track"};
  return {"limit", "already " + std::to_string(tracks.entries().size()) + " global tracks (max_tracks)"};
}

}  // namespace

std::optional<Refusal> whyNoTrack(const AngularState& state_tracking) {
  if (!state_tracking.mean.allFinite() || !state_tracking.covariance.allFinite())
    return Refusal{"undetermined", "the fused state is not finite"};
  const double sigma = largestPositionSigma(state_tracking);
  if (!(sigma <= kLargestDirectionSigma)) {
    return Refusal{"too uncertain", "the fused position has a sigma of " + std::to_string(sigma) +
                                        " rad, which is more than the sphere"};
  }
  if (Eigen::LLT<Eigen::Matrix4d>(state_tracking.covariance).info() != Eigen::Success)
    return Refusal{"undetermined", "the fused covariance is not positive definite"};
  return std::nullopt;
}

std::vector<double> positionShares(const std::vector<Eigen::Matrix4d>& gains) {
  std::vector<double> shares;
  double sum = 0.0;
  for (const Eigen::Matrix4d& gain : gains) {
    shares.push_back(std::max(gain.topLeftCorner<2, 2>().trace(), 0.0));
    sum += shares.back();
  }
  for (double& share : shares) share /= sum;
  return shares;
}

void describeFusion(const GlobalTrack& track, const std::vector<std::size_t>& used,
                    const std::vector<double>& shares, const NewReports& new_reports,
                    FusedTrack& description) {
  std::vector<const Track*> contributors;
  description.sources.clear();
  description.track.sources.clear();
  for (std::size_t i = 0; i < used.size(); ++i) {
    const Supporter& supporter = track.supporters()[used[i]];
    description.sources.push_back(rowOf(supporter, track.time()));
    description.sources.back().weight = shares[i];
    description.track.sources.push_back(supporter.key.tracker);
    if (const auto reports = new_reports.find(supporter.key.tracker); reports != new_reports.end())
      description.track.hits += reports->second;
    contributors.push_back(&supporter.local.track);
  }
  summarize(contributors, description.track);
  // A single source passes through to the last bit.
  const Supporter& first = track.supporters()[used.front()];
  const bool as_it_came =
      used.size() == 1 && first.local.time == track.time() && description.rule != FusionRule::tracklets;
  setState(as_it_came ? first.local.track.state : track.chart().toTracking(track.state()), description);
}

void describeCoasting(const GlobalTrack& track, FusedTrack& description) {
  description.sources.clear();
  description.track.sources.clear();
  description.track.status = TrackStatus::coasting;
  ++description.track.misses;
  setState(track.chart().toTracking(track.state()), description);
}

void describeLeftOut(const GlobalTrack& track, const std::vector<std::pair<std::size_t, Refusal>>& left_out,
                     FusedTrack& description) {
  description.left_out.clear();
  for (const auto& [number, why] : left_out) {
    description.left_out.push_back(rowOf(track.supporters()[number], track.time()));
    description.left_out.back().reason = why;
  }
}

FusionReport describe(const GlobalTracks& tracks, const LocalReports& reports,
                      const std::map<LocalKey, std::uint32_t>& waiting) {
  FusionReport report;
  report.time = tracks.time();
  for (const GlobalTrackEntry& entry : tracks.entries()) {
    if (entry.track.supporters().empty()) continue;
    if (!entry.report.withheld) {
      report.tracks.push_back(entry.report);
      continue;
    }
    for (SourceTrack row : entry.report.sources) {
      row.weight = 0.0;
      row.reason = entry.report.withheld;
      report.left_out.push_back(std::move(row));
    }
  }
  for (const auto& [name, tracker] : reports.trackers()) {
    const double age = reports.age(tracker.time);
    const std::vector<std::uint32_t> supporters = tracks.supportersOf(name);
    for (const auto& [id, local] : tracker.tracks) {
      if (std::binary_search(supporters.begin(), supporters.end(), id)) continue;
      report.left_out.push_back(
          leftOutRow(name, id, age, whyFree({name, id}, local, tracks, reports, waiting)));
    }
    for (const auto& [id, why] : tracker.surplus) report.left_out.push_back(leftOutRow(name, id, age, why));
  }
  return report;
}

FusionReport describeRefused(const FusionReport& latest, const LocalReport& refused, const Refusal& why,
                             std::size_t max_tracks) {
  FusionReport report = latest;
  report.refusal = why;
  for (FusedTrack& track : report.tracks) track.sensor_changes.clear();
  for (const Track& track : refused.tracks) {
    if (report.left_out.size() >= max_tracks) break;
    report.left_out.push_back(
        leftOutRow(readableName(refused.tracker), track.id, seconds(latest.time - refused.time), why));
  }
  return report;
}

}  // namespace sightline::core
