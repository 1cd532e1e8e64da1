#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/evaluation/gospa.h"
#include "sightline/core/evaluation/metrics.h"
#include "sightline/core/model/time.h"

/// Positions against the truth, in metres.
namespace sightline::core {

/// A position as a tracker reports it, confirmed or coasting.
struct EstimatedPosition {
  std::uint32_t id = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();        ///< [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();        ///< [m/s]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of the position [m^2]
  bool is_alone = false;                                     ///< one station alone supports it
};

/// Where a target truly is at a time.
struct PositionTruth {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< [m/s]
};

/// Samples of one target's path; between two that are no more than `gap` [s] apart the path is the cubic
/// through them and their neighbours (Catmull and Rom), elsewhere the target is not there.
class TruePath {
 public:
  explicit TruePath(double gap) : gap_(gap) {}

  void add(Time time, const Eigen::Vector3d& position) { samples_[time] = position; }
  void forgetBefore(Time time) { samples_.erase(samples_.begin(), samples_.lower_bound(time)); }
  std::optional<PositionTruth> at(Time time) const;
  const std::map<Time, Eigen::Vector3d>& samples() const { return samples_; }

 private:
  using Sample = std::map<Time, Eigen::Vector3d>::const_iterator;
  Eigen::Vector3d velocityAt(Sample sample) const;

  double gap_;
  std::map<Time, Eigen::Vector3d> samples_;
};

struct PositionEvaluationParams {
  double gospa_cutoff = 10.0;  ///< c of GOSPA, whose order is 2 [m], > 0
  double match_sigmas = 4.0;   ///< a target's track lies within c, or within so many of its largest stated
                               ///< standard deviations [1], >= 0
  double settle = 0.0;         ///< first seconds of each target's presence that are not scored, >= 0
};

/// Errors of those pairs of track and target that are of one kind.
struct PositionErrors {
  std::uint64_t samples = 0;
  double rmse = 0.0, median = 0.0, p90 = 0.0,
         p95 = 0.0;              ///< of the distance [m]; NaN without samples; beyond a
                                 ///< million samples, quantiles are of a part
  double median_velocity = 0.0;  ///< of the velocity's error [m/s]
  double anees = 0.0;            ///< squared error over the stated covariance, over 3 [1]; 1 is honest
};

/// The figures of one topic.
struct PositionRow {
  std::uint64_t reports = 0;
  PositionErrors all, alone;     ///< of all tracks; of those that one station alone supports
  double coverage = 0.0;         ///< share of the reports, over the targets that are there, with a track [1]
  std::uint32_t breaks = 0;      ///< times that a target's track ended while the target went on
  std::uint32_t id_changes = 0;  ///< times that a target came to a track of another id
  std::uint64_t tracks = 0;      ///< ids
  std::uint64_t false_tracks = 0;  ///< ids that were never a target's, while the truth is known
  double false_share = 0.0;        ///< share of the reports of tracks that were no target's [1]
  double gospa = 0.0;              ///< mean [m]; NaN without reports
};

/// Scores the position tracks of one topic. The truth is known before the first report.
class PositionEvaluation {
 public:
  PositionEvaluation(const std::map<std::string, TruePath>& truth, const PositionEvaluationParams& params);

  /// One scored pair.
  struct Pair {
    std::string target;
    std::uint32_t id = 0;
    Eigen::Vector3d error = Eigen::Vector3d::Zero();  ///< [m]
    Eigen::Vector3d sigma = Eigen::Vector3d::Zero();  ///< stated [m]
    double nees = 0.0;                                ///< over 3 [1]; NaN: no positive definite covariance
    bool is_alone = false;
  };

  /// Returns the pairs. Reports outside the time of the truth are not scored.
  std::vector<Pair> add(Time time, const std::vector<EstimatedPosition>& tracks);

  /// Of the last report added [m]; nullopt when that was outside the time of the truth.
  const std::optional<Gospa>& lastGospa() const { return last_gospa_; }

  PositionRow row() const;

 private:
  struct Sums {
    std::uint64_t samples = 0;
    std::uint64_t stride = 1;                   // of so many samples one is kept, to bound the memory
    std::vector<double> distances, velocities;  // of those
    RunningMean squares, nees;

    void add(double distance, double velocity);
    PositionErrors errors() const;
  };
  struct Target {
    std::optional<Time> since;  // is there without a gap
    bool had_track = false;
    std::optional<std::uint32_t> last_id;
  };

  bool isKnown(Time time) const;

  const std::map<std::string, TruePath>* truth_;
  PositionEvaluationParams params_;
  Sums all_, alone_;
  std::map<std::string, Target> targets_;
  std::set<std::uint32_t> ids_, true_ids_;
  std::uint64_t reports_ = 0, present_ = 0, covered_ = 0, track_reports_ = 0, false_reports_ = 0;
  std::uint32_t breaks_ = 0, id_changes_ = 0;
  RunningMean gospa_;
  std::optional<Gospa> last_gospa_;
};

}  // namespace sightline::core
