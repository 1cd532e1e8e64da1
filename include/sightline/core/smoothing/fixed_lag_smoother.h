#pragma once

#include <optional>
#include <vector>

#include "sightline/core/estimators/estimators.h"
#include "sightline/core/estimators/noga_consistent.h"
#include "sightline/core/model/sphere.h"
#include "sightline/core/model/time.h"
#include "sightline/core/smoothing/bank_smoother.h"
#include "sightline/core/smoothing/track_charts.h"
#include "sightline/core/smoothing/track_smoother.h"

namespace sightline::core {

/// Where a target was, as sightings come: TrackSmoother with a lag, one track at a time in bounded memory and
/// time. The caller answers in batches: of a lag, and of the times of half a lag at once, say, so that each
/// sighting is passed over three times, whatever their rate.
class FixedLagSmoother {
 public:
  /// `bank`: smoothingBankOf the tracks' estimator. Throws std::invalid_argument.
  explicit FixedLagSmoother(const NogaConsistentParams& bank);

  /// Late sightings are put in their place. Returns false for one that is not after the time up to which has
  /// been answered: it is not used.
  bool take(const TakenSighting& sighting);

  /// The states at `times`, ascending and after the time of the last call, none after `end`, by all sightings
  /// so far. nullopt before the first sighting. Those up to `end` are forgotten but for what the filter has
  /// of them.
  std::vector<std::optional<AngularState>> answer(const std::vector<Time>& times, Time end);

 private:
  std::vector<ResponseModel> models_;
  BankFilter filter_;                     // has taken the first of `charted_` where there is one
  ChartedSightings charted_;              // the last sighting up to `answered_`
  SlowErrors slow_errors_;                // by the sightings up to then
  std::vector<TakenSighting> sightings_;  // behind, in order of time
  std::optional<Time> answered_;
};

}  // namespace sightline::core
