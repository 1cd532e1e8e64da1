#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "sightline/core/fusion/global_track.h"
#include "sightline/core/model/refusal.h"

namespace sightline::core {

/// Which supporters of a global track make its state at this instant, and why the others do not.
struct Contributors {
  std::vector<std::size_t> used;                          ///< by key
  std::vector<std::pair<std::size_t, Refusal>> left_out;  ///< by key
};

/// Chooses among the usable supporters. Coasting ones whose last sighting is longer ago than `coasting_age`
/// [s] go, unless nobody else is left. Unless `allow_shared_sensors`, of supporters that share a sensor the
/// one with the smallest covariance determinant stays; one that contributed before is preferred as long as no
/// other is clearly surer.
Contributors chooseContributors(const GlobalTrack& track, double coasting_age, bool allow_shared_sensors);

/// Whether each of these supporters names the sensors that it has its state from.
bool nameTheirSensors(const GlobalTrack& track, const std::vector<std::size_t>& numbers);

/// Log of the covariance's determinant, infinite where it is not finite and positive definite: how unsure a
/// state is.
double uncertainty(const AngularState& state);

}  // namespace sightline::core
