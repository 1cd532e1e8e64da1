#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>

#include "sightline/core/evaluation/track_report.h"

namespace sightline::core {

/// Statistics of a tracker's reports without a truth: the number and the lengths of its established tracks,
/// and the breaks without any.
class TrackSpans {
 public:
  /// Reports further apart than `pause` [s] mean that the sensors were silent, which breaks nothing.
  explicit TrackSpans(double pause = 1.0) : pause_(pause) {}

  /// Reports of one tracker, in ascending order of time.
  void add(const TrackReport& report);

  std::size_t tracks() const { return spans_.size(); }
  double medianLength()
      const;  ///< from a track's first report as established to its last [s]; NaN without tracks
  double longestLength() const;  ///< [s]; NaN without tracks
  double coverage()
      const;  ///< share of the time of the reports, less the pauses, with a track; NaN without time
  std::uint32_t breaks() const {
    return breaks_;
  }  ///< times without a track, between two with one, without a pause
  double longestBreak() const { return longest_break_; }  ///< [s]; 0 without breaks

 private:
  struct Span {
    Time first{}, last{};
  };

  void noteGap(Time time);

  double pause_;
  std::map<std::uint32_t, Span> spans_;  // by track
  std::optional<Time> last_report_;
  std::optional<Time> last_with_track_;
  bool had_track_ = false;                 // in the last report
  bool pause_in_gap_ = false;              // since the last report with a track
  double covered_ = 0.0, reported_ = 0.0;  // [s]
  std::uint32_t breaks_ = 0;
  double longest_break_ = 0.0;
};

}  // namespace sightline::core
