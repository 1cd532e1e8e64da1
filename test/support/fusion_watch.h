#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <ros/ros.h>
#include <sightline/TrackArray.h>

#include "sightline/core/model/sphere.h"

/// What a fusion of the trackers "west" and "east" says of one target whose true path is known, message by
/// message.
class FusionWatch {
 public:
  /// Where the target is at that stamp: (azimuth, elevation) [rad].
  using Truth = std::function<Eigen::Vector2d(ros::Time)>;

  /// One message of the fusion.
  struct Seen {
    ros::WallTime came;
    ros::Time stamp;
    std::uint32_t id = 0;  ///< of the confirmed track at the target; 0 = none within kNear. Of several that
                           ///< which it had at `begin`, else the nearest
    int tracks = 0;        ///< confirmed, within kNear of the target
    double sigmas = 0.0;   ///< Mahalanobis distance of that track from the target [1]
    bool both = false;     ///< both trackers have a part in it
  };

  /// What became of the target in the messages since `begin`.
  struct Outcome {
    double back = 0.0;  ///< from the event to when the target was lost for the last time [s]; 0 = never lost
    double both = 0.0;  ///< the same of "by both trackers" [s]
    int lost = 0;       ///< messages without a track within kNear of the target
    std::set<std::uint32_t> ids;  ///< under which the target was held
    double sigmas = 0.0;          ///< largest Mahalanobis distance of the last kInARow messages [1]
  };

  static constexpr double kNear = 8e-3;   // of the true target, for its track [rad]: 8 sigma of a sighting
  static constexpr double kSilent = 0.3;  // a fusion that says nothing for so long has lost the target [s]
  static constexpr std::size_t kInARow = 10;  // messages that hold the target, for it to be held for good

  FusionWatch(ros::NodeHandle& nh, std::string form, Truth truth)
      : form_(std::move(form)),
        truth_(std::move(truth)),
        subscriber_(nh.subscribe("/" + form_ + "/fusion/tracks", 10000, &FusionWatch::take, this,
                                 ros::TransportHints().tcpNoDelay())) {}

  /// Forgets all messages; those that follow are of the event.
  void begin() {
    if (!seen_.empty()) id_ = seen_.back().id;
    begin_ = from_ = ros::WallTime::now();
    seen_.clear();
  }

  /// Settled is counted from here: messages that come from now on and are stamped in [after, ...).
  void settleFrom(ros::Time after) {
    from_ = ros::WallTime::now();
    after_ = after;
  }

  /// Whether each of the newest kInARow messages came since `settleFrom`, and has exactly one track at the
  /// target, made by both trackers.
  bool isSettled() const {
    if (seen_.size() < kInARow) return false;
    return std::all_of(seen_.end() - kInARow, seen_.end(), [this](const Seen& seen) {
      return seen.came >= from_ && seen.stamp >= after_ && seen.tracks == 1 && seen.both;
    });
  }

  /// Stamp of the newest message; zero before the first.
  ros::Time newest() const { return seen_.empty() ? ros::Time() : seen_.back().stamp; }

  /// Whether the newest message holds the target, is stamped since then, and came just now.
  bool holdsSince(ros::Time stamp) const {
    return !seen_.empty() && seen_.back().id != 0 && seen_.back().stamp >= stamp &&
           (ros::WallTime::now() - seen_.back().came).toSec() < kSilent;
  }

  /// Times are counted from `event`.
  Outcome outcome(ros::WallTime event) const {
    Outcome outcome;
    const auto lastReturn = [&](const std::function<bool(const Seen&)>& good) {
      double last = 0.0;
      bool lost = false;
      ros::WallTime before = begin_;
      for (const Seen& seen : seen_) {
        lost = lost || (seen.came - before).toSec() > kSilent;
        before = seen.came;
        if (!good(seen)) {
          lost = true;
        } else if (lost) {
          last = std::max(last, (seen.came - event).toSec());
          lost = false;
        }
      }
      return last;
    };
    outcome.back = lastReturn([](const Seen& seen) { return seen.id != 0; });
    outcome.both = lastReturn([](const Seen& seen) { return seen.id != 0 && seen.both; });
    for (const Seen& seen : seen_) {
      if (seen.id == 0) {
        ++outcome.lost;
      } else {
        outcome.ids.insert(seen.id);
      }
    }
    for (std::size_t i = seen_.size() - std::min(seen_.size(), kInARow); i < seen_.size(); ++i)
      outcome.sigmas = std::max(outcome.sigmas, seen_[i].sigmas);
    return outcome;
  }

  const std::vector<Seen>& seen() const { return seen_; }
  const std::string& form() const { return form_; }
  std::uint32_t id() const { return id_; }  ///< under which the target was held at `begin`

  /// What the newest message says, for the message of a test that fails.
  std::string describe() const {
    if (seen_.empty()) return form_ + ": says nothing";
    const Seen& last = seen_.back();
    return form_ + ": " + std::to_string(seen_.size()) + " messages, the last " +
           std::to_string((ros::WallTime::now() - last.came).toSec()) + " s ago with " +
           std::to_string(last.tracks) + " tracks at the target" + (last.both ? ", by both trackers" : "");
  }

 private:
  void take(const sightline::TrackArray::ConstPtr& message) {
    Seen seen;
    seen.came = ros::WallTime::now();
    seen.stamp = message->header.stamp;
    const Eigen::Vector2d truth = truth_(seen.stamp);
    double nearest = kNear;
    for (const sightline::Track& track : message->tracks) {
      if (track.status != sightline::Track::CONFIRMED) continue;
      const Eigen::Vector2d off = sightline::core::angleDifference({track.azimuth, track.elevation}, truth);
      if (!(off.norm() <= kNear)) continue;
      ++seen.tracks;
      if (seen.id != 0 && (seen.id == id_ || (track.id != id_ && off.norm() > nearest))) continue;
      nearest = off.norm();
      Eigen::Matrix2d covariance;
      covariance << track.covariance[0], track.covariance[1], track.covariance[4], track.covariance[5];
      seen.id = track.id;
      seen.sigmas = std::sqrt(off.dot(covariance.ldlt().solve(off)));
      const std::set<std::string> sources(track.sources.begin(), track.sources.end());
      seen.both = sources == std::set<std::string>{"east", "west"};
    }
    seen_.push_back(seen);
  }

  std::string form_;
  Truth truth_;
  ros::WallTime begin_, from_;
  ros::Time after_;
  std::uint32_t id_ = 0;
  std::vector<Seen> seen_;
  ros::Subscriber subscriber_;
};
