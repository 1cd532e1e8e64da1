#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sightline/core/fusion/global_track.h"
#include "sightline/core/fusion/reports/local_reports.h"

/// Which global track each track of one local tracker belongs to, when the answer of yesterday is in doubt.
namespace sightline::core {

/// A track of the tracker that may be in the wrong place, or wants the place of one that is.
struct SupporterMove {
  LocalKey key;
  std::optional<std::size_t> present;  ///< the global track that it supports; none: it is free
  std::optional<std::size_t> best;     ///< the one that it should; none: a global track of its own
  std::size_t group = 0;               ///< moves of one group are one solution

  bool isRight() const { return present == best; }
};

struct SupporterAssignmentParams {
  double join_threshold = 18.5;     ///< of distances squared [1]
  double registration_sigma = 0.0;  ///< misalignment between trackers to allow for [rad]
};

/// Optimal assignment, with memory, of a tracker's tracks to global tracks, in those groups of neighbours in
/// which somebody is in doubt: a supporter that is farther from the others than half the threshold, or does
/// not count as it contradicts or is biased. Elsewhere nothing is said, and all are in the right place.
///
/// The cost of a pair is the distance squared between the local track and all that the other trackers say of
/// the global one, and ln det of its covariance over the least in the group: a vague track near to many
/// places does not push out a sharp one. That of the present place is smaller by half the threshold, so that
/// targets that pass one another do not exchange their tracks unless these fit clearly better; and it is at
/// most half the threshold for a biased one, which is welcome as long as no other fits. To be alone costs the
/// threshold.
///
/// `free`: usable tracks of the tracker that support nothing. `tracks`: the global tracks, at one time.
std::vector<SupporterMove> supporterMoves(const std::string& tracker,
                                          const std::vector<std::pair<LocalKey, LocalTrack>>& free,
                                          const std::vector<const GlobalTrack*>& tracks,
                                          const SupporterAssignmentParams& params);

}  // namespace sightline::core
