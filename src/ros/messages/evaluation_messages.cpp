#include "sightline/ros/messages/evaluation_messages.h"

#include "sightline/core/estimators/estimators.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

/// What the lines of the table and those of each target have in common.
template <typename Row, typename Message>
void copyCommon(const Row& row, Message& message) {
  message.topic = row.topic;
  message.name = row.name;
  message.samples = row.samples;
  message.rmse = row.rmse;
  message.rate_rmse = row.rate_rmse;
  message.anees_position = row.anees_position;
  message.anees_state = row.anees_state;
  message.coverage = row.coverage;
  message.breaks = row.breaks;
  message.id_switches = row.id_switches;
}

}  // namespace

std::map<std::uint32_t, Eigen::Vector4d> motionsOf(const sightline::TrackArray& truth) {
  std::map<std::uint32_t, Eigen::Vector4d> motions;
  for (const sightline::Track& target : truth.tracks) {
    motions[target.id] = {target.azimuth, target.elevation, target.azimuth_rate, target.elevation_rate};
  }
  return motions;
}

core::TrackReport reportOf(const sightline::TrackArray& tracks) {
  core::TrackReport report;
  report.time = toCore(tracks.header.stamp);
  report.tracker = tracks.tracker;
  report.fused = isFused(tracks);
  report.tracks.reserve(tracks.tracks.size());
  for (const sightline::Track& track : tracks.tracks) report.tracks.push_back(toCore(track));
  return report;
}

std::vector<core::EstimatedPosition> estimatesOf(const core::PositionTrackArray& positions) {
  std::vector<core::EstimatedPosition> estimates;
  for (const core::PositionTrack& track : positions.tracks) {
    if (track.status == core::TrackStatus::tentative) continue;
    estimates.push_back({track.id, track.position, track.velocity, track.covariance.topLeftCorner<3, 3>(),
                         track.parallax == 0.0});
  }
  return estimates;
}

bool isFused(const sightline::TrackArray& tracks) {
  return !core::isEstimatorName(tracks.estimator);
}

sightline::EvaluationRow toMessage(const core::EvaluationRow& row) {
  sightline::EvaluationRow message;
  copyCommon(row, message);
  message.relative_rmse = row.relative_rmse;
  message.unmatched = row.unmatched;
  message.gospa = row.gospa.distance();
  message.gospa_localisation = row.gospa.localisationCost();
  message.gospa_missed = row.gospa.missedCost();
  message.gospa_false = row.gospa.extraCost();
  message.ospa = row.ospa;
  message.tracks = row.tracks;
  message.false_tracks = row.false_tracks;
  message.false_tracks_per_hour = row.false_tracks_per_hour;
  message.purity = row.purity;
  message.completeness = row.completeness;
  message.appearances = row.appearances;
  message.never_confirmed = row.never_confirmed;
  message.confirm_median = row.confirm_median;
  message.confirm_worst = row.confirm_worst;
  return message;
}

sightline::EvaluationTarget toMessage(const core::TargetRow& row) {
  sightline::EvaluationTarget message;
  copyCommon(row, message);
  message.target = row.target;
  return message;
}

sightline::Evaluation toMessage(const core::Evaluation& evaluation) {
  sightline::Evaluation message;
  if (const auto newest = evaluation.lastScored()) message.header.stamp = toRos(*newest);
  for (const core::EvaluationRow& row : evaluation.rows()) message.rows.push_back(toMessage(row));
  for (const core::TargetRow& row : evaluation.targetRows()) message.targets.push_back(toMessage(row));
  return message;
}

}  // namespace sightline_ros
