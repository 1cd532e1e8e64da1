#pragma once

#include <cstdint>
#include <tuple>

#include "sightline/core/association/existence.h"
#include "sightline/core/model/time.h"
#include "sightline/core/model/track.h"

namespace sightline::core {

/// When a track is initiated, confirmed and deleted.
///
/// A scan without a sighting of the target is a miss only if its sensor has seen the target before and looks
/// where it is; silence is never a miss. Times are in units of the track's time (S-91): one second, or three
/// usual intervals of a slower sensor, so that one setting serves a camera and a telescope that looks every
/// ten minutes. A limit on silence counts as at least four of the track's usual intervals between sightings.
struct LifecycleParams {
  /// Whether the probability of existence decides; false: M sightings of N scans, and misses and silence.
  bool by_existence = true;
  int confirm_hits = 3;              ///< M: sightings that confirm a track, at least ...
  int confirm_scans = 6;             ///< N: ... and without existence within so many scans; 1 <= M <= N
  double confirm_existence = 0.999;  ///< probability of existence that confirms a track, in (0, 1)
  double show_existence = 0.5;  ///< below it an established track is not shown until it is seen again, [0, 1)
  PresenceParams presence;      ///< how targets come and go
  int coast_misses = 3;         ///< misses in a row after which a track counts as coasting, >= 1
  double coast_silence = 0.3;   ///< silence after which it does [units of time], > 0
  int delete_misses = 30;       ///< misses in a row after which a track is lost, without existence, >= 1
  double delete_silence = 2.0;  ///< silence after which it is lost in any case [units], > 0
  /// Silence up to which a lost target is remembered, and goes on as the same track when it is seen within
  /// its gate or a new track agrees with its motion [units of time], >= 0
  double remember = 5.0;
  /// An established track whose gate is so many times as wide as the sightings' own sigma would make it,
  /// times the unit of its time over one second, is updated with false sightings alone: it is deleted. One
  /// that is lost is not updated, and is remembered. > 1
  double max_spread = 30.0;
  /// Scans in a row in which two tracks at the same place with the same motion share the sightings of one
  /// target, after which the younger is deleted, >= 1
  int merge_scans = 10;

  friend bool operator==(const LifecycleParams& a, const LifecycleParams& b) {
    return std::tie(a.by_existence, a.confirm_hits, a.confirm_scans, a.confirm_existence, a.show_existence,
                    a.presence, a.coast_misses, a.coast_silence, a.delete_misses, a.delete_silence,
                    a.remember, a.max_spread, a.merge_scans) ==
           std::tie(b.by_existence, b.confirm_hits, b.confirm_scans, b.confirm_existence, b.show_existence,
                    b.presence, b.coast_misses, b.coast_silence, b.delete_misses, b.delete_silence,
                    b.remember, b.max_spread, b.merge_scans);
  }
};

constexpr std::uint32_t kMatureHits = 30;  // sightings of a track whose innovations tell of its sensors: a
                                           // false one does not live so long

/// Status of one track, and the record of sightings and misses that it rests on. Plain state.
class TrackLifecycle {
 public:
  /// Starts with a sighting. `odds`: of a new target against a false sighting.
  TrackLifecycle(Time first_sighting, double odds)
      : existence_(odds), last_sighting_(first_sighting), weighed_(first_sighting) {}

  TrackStatus status() const { return status_; }
  bool isTentative() const { return status_ == TrackStatus::tentative; }

  /// An established track (confirmed or coasting) whose target is not believed to be there any more; it is
  /// remembered, to be reacquired.
  bool isLost() const { return lost_; }
  bool isEstablished() const { return !isTentative() && !lost_; }
  bool isMature() const { return status_ == TrackStatus::confirmed && !lost_ && hits_ >= kMatureHits; }

  /// Whether its target may be the one that another track has just found: it is lost, or has been missed more
  /// than once.
  bool isMissing() const { return lost_ || (!isTentative() && misses_ >= 2); }

  Time lastSighting() const { return last_sighting_; }
  std::uint32_t hits() const { return hits_; }
  std::uint32_t hitsSinceFound() const {
    return hits_ - hits_before_;
  }                                                 ///< for the last time, if it was lost
  std::uint32_t misses() const { return misses_; }  ///< since the last hit
  double interval() const { return interval_; }     ///< usual time between sightings [s]; 0 = not known yet
  double existence() const { return existence_.probability(); }

  /// Silence that always may last [s]: some of the usual intervals.
  double leastSilence() const;

  double unit() const { return unit_; }

  /// The unit of the track's time is now so many seconds, > 0; infinite = not known yet, silence means
  /// nothing.
  void setUnit(double unit) { unit_ = unit; }

  /// Probability that a scan shows the target, by the track's own record and the sensor's probability.
  double detectionProbability(double of_sensor) const;

  /// A scan has shown the target. `likelihood_ratio`: of the scan, target against clutter. `is_expected`: its
  /// sensor has seen the target lately and looks there.
  void noteSighting(Time time, double likelihood_ratio, bool is_expected, const LifecycleParams& params);

  /// A scan has not shown the target.
  void noteMiss(Time time, double likelihood_ratio, bool is_expected, const LifecycleParams& params);

  /// Goes on as the track that a target had before it was lost.
  void resume(const TrackLifecycle& lost) { hits_ += hits_before_ = lost.hits_; }

  /// Brings the status of an established track up to date: confirmed, coasting, lost.
  void updateStatus(Time time, const LifecycleParams& params);

  /// Whether the track is to be deleted at `time`, as of its status then.
  bool isOver(Time time, const LifecycleParams& params) const;

 private:
  double limit(double silence) const;
  void weigh(Time time, double likelihood_ratio, const LifecycleParams& params);
  void noteLook(bool is_seen);
  bool isConfirmedBy(const LifecycleParams& params) const;
  bool isSilentTooLong(Time time, const LifecycleParams& params) const;
  bool isHopeless(const LifecycleParams& params) const;

  TrackStatus status_ = TrackStatus::tentative;
  bool lost_ = false;
  Existence existence_;
  Time last_sighting_;
  Time weighed_;           // when `existence_` was updated last
  double interval_ = 0.0;  // [s]
  double unit_ = 1.0;      // [s]
  std::uint32_t hits_ = 1, misses_ = 0;
  std::uint32_t hits_before_ = 0;     // of the track that it goes on as
  int scans_ = 1;                     // that could have shown the target, since the start
  double looked_ = 0.0, seen_ = 0.0;  // the last ones of these, fading, and how many of them did
};

}  // namespace sightline::core
