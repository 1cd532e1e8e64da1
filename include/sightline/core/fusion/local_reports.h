#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "sightline/core/model/time.h"
#include "sightline/core/model/track.h"

namespace sightline::core {

/// All tracks of one local tracker at one instant.
struct LocalReport {
  std::string tracker;  ///< unique name
  Time time{};          ///< at which the states are valid
  std::vector<Track> tracks;
};

/// A local track's name among all trackers.
struct LocalKey {
  std::string tracker;
  std::uint32_t id = 0;

  friend bool operator<(const LocalKey& a, const LocalKey& b) {
    return std::tie(a.tracker, a.id) < std::tie(b.tracker, b.id);
  }
  friend bool operator==(const LocalKey& a, const LocalKey& b) {
    return a.id == b.id && a.tracker == b.tracker;
  }
};

/// A local track as last reported.
struct LocalTrack {
  Track track;
  Time time{};          ///< of the report
  std::string invalid;  ///< "invalid: why it cannot be used"; empty when it can
};

struct LocalReportsParams {
  double max_age = 1.0;        ///< beyond, a report does not count any more [s], > 0; at least three of its
                               ///< tracker's usual intervals
  double forget_after = 10.0;  ///< silence after which a tracker is forgotten [s], >= max_age
  int max_trackers = 128;      ///< reports of further trackers are refused, >= 1
  int max_tracks = 1000;       ///< of one report; the rest is left out, >= 1
};

/// The newest report of every local tracker, kept straight through late messages and restarts.
///
/// A report older than its tracker's last one is refused, unless by more than `max_age`: then the tracker has
/// started again and its stamps with it. The common time is the newest stamp among the trackers' last
/// reports. A tracker that died ahead of the others' new time (a recording played in a loop) does not hold
/// them up for long: once another has reported for three times `max_age` without anybody near the common
/// time, those ahead are forgotten.
class LocalReports {
 public:
  struct Tracker {
    Time time{};
    double interval = 0.0;  ///< usual time between its reports [s]; 0 = not known yet
    std::map<std::uint32_t, LocalTrack> tracks;
    std::map<std::uint32_t, std::string> surplus;  ///< tracks that were not taken over: why
    std::optional<Time> behind_since;              ///< its stamp when it first lagged behind the common time
  };

  explicit LocalReports(const LocalReportsParams& params) : params_(params) {}

  /// Takes a report. Returns why it was refused ("kind: details"), or nothing.
  std::string take(const LocalReport& report);

  /// The newest stamp of all; the epoch before the first report. It can go back when trackers start again.
  Time newest() const;

  /// How much older than the newest [s].
  double age(Time time) const { return seconds(newest() - time); }

  /// How old a report of this tracker may be and still count [s].
  double maxAge(const std::string& tracker) const;

  /// Why a track of this tracker does not count ("kind: details"): invalid, tentative or stale. Empty when it
  /// does.
  std::string whyUnusable(const std::string& tracker, const LocalTrack& local) const;

  /// By name.
  const std::map<std::string, Tracker>& trackers() const { return trackers_; }

  /// The track as last reported, null when its tracker does not report it any more.
  const LocalTrack* find(const LocalKey& key) const;

 private:
  std::string refusal(const LocalReport& report) const;
  void replace(Tracker& tracker, const LocalReport& report) const;
  void forgetSilent(const std::string& reporting);
  void forgetThoseAhead(const std::string& reporting);

  LocalReportsParams params_;
  std::map<std::string, Tracker> trackers_;
};

}  // namespace sightline::core
