#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "sightline/core/charted_estimator.h"
#include "sightline/core/estimators.h"
#include "sightline/core/local_reports.h"
#include "sightline/core/sphere.h"
#include "sightline/core/time.h"
#include "sightline/core/tracklet.h"

namespace sightline::core {

/// One target as an estimator sees it that is given the tracklets of all its sources, each in its place in
/// time: for a late one it goes back and runs again from there, so that the order of arrival changes nothing,
/// to the last bit.
class TrackletTrack {
 public:
  /// `max_lag`: tracklets up to so much older than the newest are put in their place [s], >= 0.
  TrackletTrack(const EstimatorParams& estimator, double max_lag);

  /// Takes a tracklet of a local track, the `number`-th that its tracker said. One that is here already is
  /// not taken again. False when it is too late.
  bool add(const LocalKey& source, std::uint64_t number, const Tracklet& tracklet);

  /// Forgets what a source said since then, as far back as `max_lag` allows. Returns the least number of
  /// those forgotten.
  std::optional<std::uint64_t> remove(const LocalKey& source, Time since);

  /// What the tracklets up to `time` say of the target then, in the tracking frame; nullopt before the first.
  /// Times do not go back.
  std::optional<AngularState> stateAt(Time time);

  /// How much information each source has given since `max_lag` ago [1/rad^2].
  std::map<LocalKey, double> informationBySource() const;

 private:
  /// The estimator at one instant; none before the first tracklet.
  using Snapshot = std::optional<ChartedEstimator>;

  struct Entry {
    LocalKey source;
    std::uint64_t number;
    Tracklet tracklet;
    std::unique_ptr<Snapshot> before;  // kept now and then
  };

  void goBackTo(std::size_t entry);
  void take(const Tracklet& tracklet);
  bool isSnapshotDue() const;
  void forgetOld();

  EstimatorParams params_;
  double max_lag_;              // [s]
  std::vector<Entry> entries_;   // in order of time; the first has its snapshot, if it was taken
  std::size_t taken_ = 0;       // that many of the entries are in ...
  Snapshot estimator_;          // ... this
  std::optional<Time> closed_;  // before this nothing can be put any more
};

}  // namespace sightline::core
