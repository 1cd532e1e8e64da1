#include "sightline/core/fusion/association/association_costs.h"

#include <algorithm>
#include <cmath>

#include "sightline/core/association/assignment.h"
#include "sightline/core/fusion/contributors.h"
#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kGateSlack = 2.0;   // of the gate, before distances are computed exactly
constexpr double kMergeSlack = 8.0;  // the same for global tracks, whose states are not their estimates
constexpr double kShortAge = 0.2;    // for which that is enough [s]

/// What a row and a global track say of one instant.
struct Pair {
  Estimate<4> row, track;
};

/// Of the newest instant for which both have reported; nullopt where that is now.
std::optional<Pair> inThePast(const AssignedRow& row, const GlobalTrack& track, const CostContext& context) {
  const GlobalTrack* as_track = row.key ? nullptr : &context.tracks.entries()[row.entry].track;
  const std::optional<Time> of_row =
      as_track != nullptr ? as_track->newestReport() : std::optional<Time>(row.local.time);
  const std::optional<Time> of_track = track.newestReport();
  if (!of_row || !of_track) return std::nullopt;
  const Time past = std::min(*of_row, *of_track);
  if (past >= context.tracks.time()) return std::nullopt;
  LocalTrack local = row.local;
  if (as_track != nullptr) {
    const std::optional<Estimate<4>> said = as_track->opinionAt(past);
    if (!said) return std::nullopt;
    local.track.state = as_track->chart().toTracking({said->mean, said->covariance});
    local.time = past;
  }
  const std::optional<Estimate<4>> said = track.opinionAt(past);
  if (!said) return std::nullopt;
  return Pair{track.estimateOf(local, past), *said};
}

/// Whether a row at `place` in an estimate's chart is outside its gate for certain, however its covariance
/// grows on the way to the common time.
bool isFarAway(const AssignedRow& row, const Eigen::Vector2d& place, const Estimate<4>& estimate,
               const CostContext& context) {
  const double age = std::abs(seconds(context.tracks.time() - row.local.time));
  if (age > kShortAge) return false;
  const Eigen::Vector2d apart = angleDifference(place, estimate.mean.head<2>());
  const AngularState& state = row.local.track.state;
  const double turned = row.local.acceleration.offsetAfter(age);
  const double variance = state.covariance.trace() + turned * turned +  // of rates too: they grow in < 1 s
                          estimate.covariance.topLeftCorner<2, 2>().trace() +
                          2.0 * context.sigmaOf(row) * context.sigmaOf(row);
  const double reach =
      std::sqrt(kGateSlack * context.join_threshold * variance) + age * state.mean.tail<2>().norm();
  return apart.squaredNorm() > reach * reach;
}

/// Whether they may be one by what is known of them beside their states. A global track without supporters is
/// not shown: to become one with it would give one that is shown an id that nobody has seen for a while. And
/// it waits for the local track that it had, which does not take another one's place.
bool mayBeOne(const AssignedRow& row, std::size_t column, const std::vector<GlobalTrackEntry>& entries) {
  const GlobalTrack& track = entries[column].track;
  if (!row.key) return !track.supporters().empty() && !entries[row.entry].track.hasAnyTrackerOf(track);
  return !track.supporters().empty() || row.entry == entries.size() || row.entry == column;
}

}  // namespace

bool areNear(const GlobalTrack& a, const GlobalTrack& b, const CostContext& context) {
  const double variance = a.state().anglesCovariance().trace() + b.state().anglesCovariance().trace() +
                          2.0 * context.misalignment.largestSigma() * context.misalignment.largestSigma();
  const Eigen::Vector3d apart =
      a.chart().directionAt(a.state().angles()) - b.chart().directionAt(b.state().angles());
  return apart.squaredNorm() <= kMergeSlack * context.join_threshold * variance;
}

Costs costsOf(const std::vector<AssignedRow>& rows, const std::vector<std::size_t>& columns,
              const CostContext& context) {
  const std::vector<GlobalTrackEntry>& entries = context.tracks.entries();
  std::optional<double> largest_log_determinant;
  Eigen::MatrixXd costs = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(rows.size()),
                                                    static_cast<Eigen::Index>(columns.size()), kForbidden);
  std::vector<Eigen::Vector3d> directions;
  for (const AssignedRow& row : rows) directions.push_back(directionOf(row.local.track.state.angles()));
  for (Eigen::Index column = 0; column < costs.cols(); ++column) {
    const GlobalTrack& track = entries[columns[static_cast<std::size_t>(column)]].track;
    const Estimate<4> estimate = track.opinion();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const AssignedRow& row = rows[i];
      const Eigen::Vector2d place = track.chart().coordinatesOf(directions[i]);
      if (isFarAway(row, place, estimate, context) || !track.chart().holds(place)) continue;
      if (!mayBeOne(row, columns[static_cast<std::size_t>(column)], entries)) continue;
      Pair pair{track.estimateOf(row.local, track.time()), estimate};
      double distance_squared = distanceSquared(pair.row, pair.track, context.sigmaOf(row));
      if (distance_squared > context.join_threshold) {  // of what is predicted
        const std::optional<Pair> past = inThePast(row, track, context);
        if (!past) continue;
        pair = *past;
        distance_squared = distanceSquared(pair.row, pair.track, context.sigmaOf(row));
      }
      if (!(distance_squared <= context.join_threshold)) continue;
      const double log_determinant =
          uncertainty({pair.track.mean, pair.row.covariance + pair.track.covariance});
      costs(static_cast<Eigen::Index>(i), column) = distance_squared + log_determinant;
      largest_log_determinant = std::max(largest_log_determinant.value_or(log_determinant), log_determinant);
    }
  }
  const bool is_finite = largest_log_determinant && std::isfinite(*largest_log_determinant);
  return {costs, is_finite ? context.join_threshold + *largest_log_determinant : 0.0};
}

}  // namespace sightline::core
