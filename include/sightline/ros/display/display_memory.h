#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>

#include <Eigen/Core>

#include <sightline/AssociationArray.h>
#include <sightline/TrackArray.h>

#include "sightline/core/evaluation/truth.h"
#include "sightline/core/model/sighting.h"
#include "sightline/core/model/time.h"

/// What the display keeps of a stream of messages: bounded in time and in number, whatever comes in.
/// `arrival` and `now` are times of receipt [s] on one clock, for fading and silence only.
namespace sightline_ros {

/// One tracker's (or the truth's) newest report, and where its tracks were.
class TrackMemory {
 public:
  /// `history` [s] of each track are kept.
  explicit TrackMemory(double history) : history_(history) {}

  /// Takes a report. Tracks that it does not hold are forgotten, tracks that are not finite left out; a
  /// report from before the last one starts anew (a recording that was played again).
  void add(const sightline::TrackArray& report, double arrival);

  /// Notes whose sightings went to another track.
  void add(const sightline::AssociationArray& decisions);

  void clear();

  const sightline::TrackArray& newest() const { return newest_; }
  double arrival() const { return arrival_; }
  bool wasClaimed(std::uint32_t track) const { return claimed_.count(track) > 0; }

  /// Positions of a track in ascending time, the newest last; empty for a track that is not there.
  const std::deque<sightline::core::TruthSample>& pathOf(std::uint32_t track) const;

  /// Angles (azimuth, elevation) [rad] of a track at a time within its path; nullopt outside of it.
  std::optional<Eigen::Vector2d> anglesAt(std::uint32_t track, sightline::core::Time time) const;

 private:
  void lengthen(std::deque<sightline::core::TruthSample>& path, const sightline::core::TruthSample& sample);

  double history_;
  double arrival_ = 0.0;
  sightline::TrackArray newest_;
  std::map<std::uint32_t, std::deque<sightline::core::TruthSample>> paths_;
  std::set<std::uint32_t> claimed_;
};

/// The latest sightings of one sensor.
class SightingMemory {
 public:
  struct Seen {
    sightline::core::Time time{};
    Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< tracking frame
    double arrival = 0.0;
  };

  /// Takes a scan in the tracking frame; sightings that a tracker would reject are left out.
  void add(const sightline::core::Scan& scan, double arrival);

  /// Forgets what arrived before `arrival`.
  void forgetBefore(double arrival);

  void clear() { seen_.clear(); }

  const std::deque<Seen>& seen() const { return seen_; }

 private:
  std::deque<Seen> seen_;  // in order of arrival
};

}  // namespace sightline_ros
