#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "sightline/core/fusion/reports/shown_acceleration.h"
#include "sightline/core/model/refusal.h"
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

/// Reports since the last fusion: how many, by tracker.
using NewReports = std::map<std::string, std::uint32_t>;

/// A local track as last reported.
struct LocalTrack {
  Track track;
  Time time{};                       ///< of the report
  std::optional<Refusal> invalid;    ///< why it cannot be used; nullopt when it can
  ShownAcceleration acceleration{};  ///< by this report and those before it
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
/// started again and its stamps with it. The common time is the newest stamp reported; it goes back when no
/// tracker is within `max_age` of it any more. A tracker that died ahead of the others' new time (a recording
/// played in a loop) does not hold them up for long: once another has reported for three times `max_age`
/// while nobody near the common time has, those ahead are forgotten. Where the clock of arrival is known it
/// must have gone on for so long, too: a backlog that comes at once, of a tracker that was held up, says
/// nothing of the others. Where it is not known, only a tracker whose own stamps went back counts.
class LocalReports {
 public:
  /// A report's stamp, and when it arrived.
  struct Instant {
    Time stamp{};
    std::optional<Time> arrival;  ///< nullopt = not known
  };
  struct Tracker {
    Time time{};
    double interval = 0.0;  ///< usual time between its reports [s]; 0 = not known yet
    std::map<std::uint32_t, LocalTrack> tracks;
    std::map<std::uint32_t, Refusal> surplus;  ///< tracks that were not taken over: why
    bool went_back = false;                    ///< its stamps, and it has not been near the common time since
    std::optional<Instant> behind_since;       ///< when it first lagged behind the common time
  };

  explicit LocalReports(const LocalReportsParams& params) : params_(params) {}

  /// Takes a report; `arrival`: when it came, by any clock that goes on by itself. Returns why it was
  /// refused, or nothing.
  std::optional<Refusal> take(const LocalReport& report, std::optional<Time> arrival = std::nullopt);

  /// The common time; the epoch before the first report. It can go back when trackers start again.
  Time newest() const { return newest_; }

  /// How much older than the newest [s].
  double age(Time time) const { return seconds(newest() - time); }

  /// How old a report of this tracker may be and still count [s].
  double maxAge(const std::string& tracker) const;

  /// Why a track of this tracker does not count: invalid, tentative or stale. nullopt when it does.
  std::optional<Refusal> whyUnusable(const std::string& tracker, const LocalTrack& local) const;

  /// By name.
  const std::map<std::string, Tracker>& trackers() const { return trackers_; }

  /// The track as last reported, null when its tracker does not report it any more.
  const LocalTrack* find(const LocalKey& key) const;

 private:
  std::optional<Refusal> refusalOf(const LocalReport& report) const;
  bool hasGoneBack(const LocalReport& report) const;
  void replace(Tracker& tracker, const LocalReport& report) const;
  void forgetSilent(const std::string& reporting);
  void forgetThoseAhead(const std::string& reporting, std::optional<Time> arrival);
  bool isAloneForLong(const Tracker& tracker, std::optional<Time> arrival) const;
  void updateNewest();

  LocalReportsParams params_;
  std::map<std::string, Tracker> trackers_;
  std::map<std::string, Time> forgotten_;  // last stamps of silent trackers; at most `max_trackers`
  Time newest_{};
};

}  // namespace sightline::core
