#include "sightline/core/fusion/association/supporter_assignment.h"

#include <algorithm>
#include <utility>

#include "sightline/core/association/assignment.h"
#include "sightline/core/association/clusters.h"
#include "sightline/core/fusion/contributors.h"
#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kLoyalty = 0.5;     // of the threshold: by how much another place must be better
constexpr double kReachSlack = 2.0;  // of distances, before they are computed exactly

/// A track of the tracker.
struct Row {
  LocalKey key;
  const LocalTrack* local = nullptr;
  std::optional<std::size_t> present;
  bool is_biased = false;  // does not count, by no fault of its target
  bool is_in_doubt = false;
  Eigen::Vector3d direction;  // at the global tracks' time
  double variance = 0.0;      // of both angles together [rad^2]
};

Row rowOf(const LocalKey& key, const LocalTrack& local, Time now) {
  Row row{key, &local, {}, false, false, {}, 0.0};
  const AngularState& state = local.track.state;
  const double age = seconds(now - local.time);
  row.direction = directionOf(state.angles() + age * state.mean.tail<2>());
  const double turned = local.acceleration.offsetAfter(age);
  row.variance = state.anglesCovariance().trace() + turned * turned;
  return row;
}

const Supporter* supporterOf(const GlobalTrack& track, const std::string& tracker) {
  for (const Supporter& supporter : track.supporters()) {
    if (supporter.key.tracker == tracker) return &supporter;
  }
  return nullptr;
}

std::vector<Row> rowsOf(const std::string& tracker, const std::vector<std::pair<LocalKey, LocalTrack>>& free,
                        const std::vector<const GlobalTrack*>& tracks,
                        const SupporterAssignmentParams& params) {
  std::vector<Row> rows;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const Supporter* supporter = supporterOf(*tracks[i], tracker);
    if (supporter == nullptr) continue;
    Row row = rowOf(supporter->key, supporter->local, tracks[i]->time());
    row.present = i;
    row.is_biased = supporter->unusable && !supporter->contradicts_since;
    row.is_in_doubt = supporter->unusable || supporter->distance_squared > kLoyalty * params.join_threshold;
    rows.push_back(std::move(row));
  }
  for (const auto& [key, local] : free)
    rows.push_back(rowOf(key, local, tracks.empty() ? local.time : tracks.front()->time()));
  return rows;
}

/// Rows and global tracks that are near one another, and each row with its present place; `log_ratio` is not
/// used.
std::vector<GatedPair> neighboursOf(const std::vector<Row>& rows,
                                    const std::vector<const GlobalTrack*>& tracks,
                                    const SupporterAssignmentParams& params) {
  std::vector<Eigen::Vector3d> directions;
  std::vector<double> variances;
  for (const GlobalTrack* track : tracks) {
    directions.push_back(track->chart().directionAt(track->state().angles()));
    variances.push_back(track->state().anglesCovariance().trace() +
                        2.0 * params.registration_sigma * params.registration_sigma);
  }
  std::vector<GatedPair> pairs;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t j = 0; j < tracks.size(); ++j) {
      const double reach = kReachSlack * params.join_threshold * (rows[i].variance + variances[j]);
      if (rows[i].present == j || (rows[i].direction - directions[j]).squaredNorm() <= reach)
        pairs.push_back({static_cast<int>(i), static_cast<int>(j), 0.0});
    }
  }
  return pairs;
}

/// How ill a track and a place go together.
struct Mismatch {
  double distance_squared = kForbidden;  // where it is not determined
  double log_determinant = 0.0;          // of its covariance S
  bool is_alone = false;                 // the place has nobody but this tracker
};

Mismatch mismatchOf(const Row& row, const GlobalTrack& track, const std::string& tracker,
                    const SupporterAssignmentParams& params) {
  Mismatch mismatch;
  const std::optional<Estimate<4>> others = track.opinionWithout(tracker);
  mismatch.is_alone = !others;
  const Eigen::Vector3d direction = directionOf(row.local->track.state.angles());
  if (!others || !track.chart().holds(track.chart().coordinatesOf(direction))) return mismatch;
  const Estimate<4> says = track.estimateOf(*row.local, track.time());
  mismatch.distance_squared = distanceSquared(says, *others, params.registration_sigma);
  mismatch.log_determinant = uncertainty({others->mean, says.covariance + others->covariance});
  return mismatch;
}

/// `least_log_determinant`: of the group.
double costOf(const Row& row, std::size_t place, const Mismatch& mismatch, double least_log_determinant,
              const SupporterAssignmentParams& params) {
  const bool is_present = row.present == place;
  if (mismatch.is_alone) return is_present ? params.join_threshold : kForbidden;
  if (!is_present && !(mismatch.distance_squared <= params.join_threshold)) return kForbidden;
  const double cost =
      mismatch.distance_squared + std::max(mismatch.log_determinant - least_log_determinant, 0.0);
  if (!is_present) return cost;
  const double loyalty = kLoyalty * params.join_threshold;
  return row.is_biased ? std::clamp(cost - loyalty, 0.0, loyalty) : std::max(cost - loyalty, 0.0);
}

}  // namespace

std::vector<SupporterMove> supporterMoves(const std::string& tracker,
                                          const std::vector<std::pair<LocalKey, LocalTrack>>& free,
                                          const std::vector<const GlobalTrack*>& tracks,
                                          const SupporterAssignmentParams& params) {
  const std::vector<Row> rows = rowsOf(tracker, free, tracks, params);
  const auto in_doubt = [&rows](int row) { return rows[static_cast<std::size_t>(row)].is_in_doubt; };
  std::vector<SupporterMove> moves;
  if (std::none_of(rows.begin(), rows.end(), [](const Row& row) { return row.is_in_doubt; })) return moves;

  const std::vector<GatedPair> pairs = neighboursOf(rows, tracks, params);
  std::size_t group_number = 0;
  for (const std::vector<int>& group : clusters(pairs)) {
    std::vector<int> members, places;
    for (const int k : group) {
      members.push_back(pairs[static_cast<std::size_t>(k)].track);
      places.push_back(pairs[static_cast<std::size_t>(k)].sighting);
    }
    for (std::vector<int>* list : {&members, &places}) {
      std::sort(list->begin(), list->end());
      list->erase(std::unique(list->begin(), list->end()), list->end());
    }
    if (std::none_of(members.begin(), members.end(), in_doubt)) continue;

    Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(members.size()),
                                                     static_cast<Eigen::Index>(places.size()), kForbidden);
    const auto indexIn = [](const std::vector<int>& sorted, int value) {
      return std::lower_bound(sorted.begin(), sorted.end(), value) - sorted.begin();
    };
    std::vector<Mismatch> mismatches;
    double least_log_determinant = kForbidden;
    for (const int k : group) {
      const GatedPair& pair = pairs[static_cast<std::size_t>(k)];
      mismatches.push_back(mismatchOf(rows[static_cast<std::size_t>(pair.track)],
                                      *tracks[static_cast<std::size_t>(pair.sighting)], tracker, params));
      if (mismatches.back().distance_squared <= params.join_threshold)
        least_log_determinant = std::min(least_log_determinant, mismatches.back().log_determinant);
    }
    for (std::size_t n = 0; n < group.size(); ++n) {
      const GatedPair& pair = pairs[static_cast<std::size_t>(group[n])];
      cost(indexIn(members, pair.track), indexIn(places, pair.sighting)) =
          costOf(rows[static_cast<std::size_t>(pair.track)], static_cast<std::size_t>(pair.sighting),
                 mismatches[n], least_log_determinant, params);
    }
    const std::vector<int> found = assign(cost, params.join_threshold);
    for (std::size_t m = 0; m < members.size(); ++m) {
      const Row& row = rows[static_cast<std::size_t>(members[m])];
      SupporterMove move{row.key, row.present, {}, group_number};
      if (found[m] >= 0) move.best = static_cast<std::size_t>(places[static_cast<std::size_t>(found[m])]);
      moves.push_back(std::move(move));
    }
    ++group_number;
  }
  return moves;
}

}  // namespace sightline::core
