#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sightline/core/fusion/reports/local_reports.h"
#include "sightline/core/model/refusal.h"
#include "sightline/core/model/time.h"
#include "sightline/core/model/tracklet.h"

namespace sightline::core {

struct TrackletMemoryParams {
  double age = 2.0;        ///< tracklets are remembered for so long [s], > 0
  int max_trackers = 128;  ///< reports of further trackers are refused, >= 1
};

/// The tracklets that the local trackers have reported lately, and what of them was lost on the way.
class TrackletMemory {
 public:
  /// A tracklet with its number among all that its tracker has reported: rising, never reused.
  struct Remembered {
    std::uint64_t number = 0;
    Tracklet tracklet;
  };

  explicit TrackletMemory(const TrackletMemoryParams& params) : params_(params) {}

  /// Takes a report. Returns why it was refused; nullopt when it was taken. One that is its
  /// tracker's first, and was not overtaken by later ones, wipes out what was known of the tracker.
  std::optional<Refusal> take(const TrackletReport& report);

  /// What is remembered of a local track, in the order in which it came; null when nothing is. Of one of
  /// which nothing new comes it may be older than `age` by an eighth.
  const std::deque<Remembered>* find(const LocalKey& key) const;

  /// Up to when the tracker has reported everything; nullopt when it sends no tracklets.
  std::optional<Time> newest(const std::string& tracker) const;

  /// How much of the time from `from` to the tracker's newest report nothing is known of, as reports were
  /// lost or came before this memory began [s].
  double missing(const std::string& tracker, Time from) const;

 private:
  struct Gap {
    Time from, to;
  };
  struct Tracker {
    Time newest{};
    Time swept{};           // when all tracks were looked through
    std::vector<Gap> gaps;  // in order of time; no report of what was sighted in them has come
    std::map<std::uint32_t, std::deque<Remembered>> tracks;
  };

  void noteSpan(Tracker& tracker, bool is_known, const TrackletReport& report) const;
  void forgetOld(std::deque<Remembered>& tracklets, Time newest) const;
  void forgetSilent(Tracker& tracker) const;

  TrackletMemoryParams params_;
  std::map<std::string, Tracker> trackers_;
  std::uint64_t next_number_ = 1;
};

}  // namespace sightline::core
