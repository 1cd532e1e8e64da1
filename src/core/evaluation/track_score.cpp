#include "sightline/core/evaluation/track_score.h"

#include <algorithm>
#include <cmath>

#include "sightline/core/association/assignment.h"
#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kKeepShare = 1.0 / 3.0;  // of the gate, by which a target keeps its track
constexpr double kLongestStep = 2.0;      // [s] between reports; after more the tracker was silent

/// The direction that distances are measured from; without elevations, on the horizon.
Eigen::Vector3d comparable(const Eigen::Vector2d& angles, Channels channels) {
  return directionOf({angles.x(), channels == Channels::azimuth_only ? 0.0 : angles.y()});
}

bool isEstablished(const Track& track) {
  return track.status != TrackStatus::tentative && track.state.mean.allFinite();
}

std::vector<const Track*> establishedOf(const TrackReport& report) {
  std::vector<const Track*> established;
  for (const Track& track : report.tracks) {
    if (isEstablished(track)) established.push_back(&track);
  }
  return established;
}

std::optional<std::uint32_t> idOf(const Track* track) {
  return track ? std::optional(track->id) : std::nullopt;
}

/// Squared angles [rad^2] between targets (rows) and tracks (columns) that are no further apart than `gate`
/// [rad].
Eigen::MatrixXd squaresWithin(double gate, const std::vector<TrueTarget>& targets,
                              const std::vector<const Track*>& tracks, Channels channels) {
  std::vector<Eigen::Vector3d> directions;
  for (const Track* track : tracks) directions.push_back(comparable(track->state.angles(), channels));
  Eigen::MatrixXd square = Eigen::MatrixXd::Constant(targets.size(), tracks.size(), kForbidden);
  for (Eigen::Index i = 0; i < square.rows(); ++i) {
    const Eigen::Vector3d truth = comparable(targets[i].state.angles(), channels);
    for (Eigen::Index j = 0; j < square.cols(); ++j) {
      if ((directions[j] - truth).squaredNorm() > gate * gate) continue;  // a chord is shorter than its arc
      const double angle = angleBetween(directions[j], truth);
      if (angle <= gate) square(i, j) = angle * angle;
    }
  }
  return square;
}

/// For each target its track, or nullptr.
std::vector<const Track*> matchTracks(const std::vector<TrueTarget>& targets,
                                      const std::vector<const Track*>& tracks, const Continuity& continuity,
                                      double gate, Channels channels) {
  Eigen::MatrixXd cost = squaresWithin(gate, targets, tracks, channels);
  for (Eigen::Index i = 0; i < cost.rows(); ++i) {
    const auto kept = continuity.trackOf(targets[i].id);
    for (Eigen::Index j = 0; kept && j < cost.cols(); ++j) {
      if (tracks[j]->id == *kept) cost(i, j) -= std::pow(kKeepShare * gate, 2);
    }
  }
  std::vector<const Track*> track_of;
  for (const int j : assign(cost, gate * gate)) track_of.push_back(j < 0 ? nullptr : tracks[j]);
  return track_of;
}

/// The metric of the targets that count and the tracks, less those of targets that do not count yet.
Gospa gospaOf(const std::vector<TrueTarget>& targets, const std::vector<const Track*>& tracks,
              const std::vector<const Track*>& track_of, Channels channels, const GospaParams& params) {
  std::vector<Eigen::Vector3d> truths, estimates;
  std::vector<const Track*> ignored;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (targets[i].is_scored) {
      truths.push_back(comparable(targets[i].state.angles(), channels));
    } else if (track_of[i]) {
      ignored.push_back(track_of[i]);
    }
  }
  for (const Track* track : tracks) {
    if (std::find(ignored.begin(), ignored.end(), track) != ignored.end()) continue;
    estimates.push_back(comparable(track->state.angles(), channels));
  }
  return gospa(estimates, truths, params);
}

}  // namespace

void TrackScore::note(const TrackReport& report) {
  tracker_ = report.tracker;
  fused_ = report.fused;
  const std::vector<const Track*> tracks = establishedOf(report);
  tracks_now_ = static_cast<int>(tracks.size());
  angles_now_ = tracks.empty() ? Eigen::Vector2d::Constant(kUnknown) : tracks.front()->state.angles();
}

void TrackScore::add(const TrackReport& report, const std::vector<TrueTarget>& targets, double gate,
                     const ScoreListener& listener) {
  forgetDepartedTargets(report.time, targets);
  advanceTo(report.time);
  const std::vector<const Track*> tracks = establishedOf(report);
  const std::vector<const Track*> track_of = matchTracks(targets, tracks, continuity_, gate, channels_);
  const auto matched = targets.size() - std::count(track_of.begin(), track_of.end(), nullptr);
  unmatched_ += tracks.size() - matched;
  noteLives(tracks, targets, track_of);

  RunningMean square;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (!targets[i].is_scored) continue;
    noteContinuity(targets[i], track_of[i]);
    if (track_of[i]) square.add(scorePair(report, targets[i], *track_of[i], listener));
  }
  if (square.count() > 0) last_error_ = std::sqrt(square.mean());

  const Gospa metric = gospaOf(targets, tracks, track_of, channels_, gospa_.params());
  const Ospa ospa_metric = ospa(metric, gospa_.params());
  gospa_.add(metric);
  ospa_.add(ospa_metric.distance);
  if (listener.report) listener.report({topic_, report.time, metric, ospa_metric});
}

void TrackScore::noteLives(const std::vector<const Track*>& tracks, const std::vector<TrueTarget>& targets,
                           const std::vector<const Track*>& track_of) {
  for (const Track* track : tracks) {
    const auto on = std::find(track_of.begin(), track_of.end(), track);
    lives_.observe(track->id,
                   on == track_of.end() ? std::nullopt : std::optional(targets[on - track_of.begin()].id));
  }
  for (std::size_t i = 0; i < targets.size(); ++i)
    appearances_.observe(targets[i].id, targets[i].age, idOf(track_of[i]));
}

void TrackScore::noteContinuity(const TrueTarget& target, const Track* track) {
  const Continuity::Change change = continuity_.observe(target.id, idOf(track));
  TargetScore& score = targets_.try_emplace(target.id, channels_).first->second;
  ++score.reports;
  score.covered += track ? 1 : 0;
  score.breaks += change.lost ? 1 : 0;
  score.id_switches += change.switched ? 1 : 0;
}

void TrackScore::forgetDepartedTargets(Time time, const std::vector<TrueTarget>& targets) {
  std::vector<std::uint32_t> stayed;
  for (const TrueTarget& target : targets) {
    if (last_scored_ && target.age >= seconds(time - *last_scored_)) stayed.push_back(target.id);
  }
  std::sort(stayed.begin(), stayed.end());
  continuity_.forgetAllBut(stayed);
  appearances_.endAllBut(stayed);
}

void TrackScore::advanceTo(Time time) {
  const double step = last_scored_ ? seconds(time - *last_scored_) : 0.0;
  if (step <= kLongestStep) scored_time_ += std::fmax(step, 0.0);
  last_scored_ = time;
}

double TrackScore::scorePair(const TrackReport& report, const TrueTarget& target, const Track& track,
                             const ScoreListener& listener) {
  const DirectionError error = errorOf(track.state, target.state, channels_);
  errors_.add(error);
  targets_.at(target.id).errors.add(error);
  if (listener.pair) {
    listener.pair({topic_, report.tracker, report.time, target.id, track.id, track.state.angles(),
                   target.state.angles(), error});
  }
  return error.position.squaredNorm() / errors_.dimensions();
}

}  // namespace sightline::core
