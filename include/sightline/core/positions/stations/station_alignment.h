#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/model/time.h"
#include "sightline/core/positions/local_view.h"

namespace sightline::core {

struct StationAlignmentParams {
  double clock_sigma = 0.2;         ///< of a station's clock offset before anything is known [s], > 0
  double orientation_sigma = 5e-3;  ///< of each angle of its orientation before anything is known [rad], > 0
  double memory = 600.0;            ///< of what was seen [s], > 0
};

/// What is known of a station's clock and orientation against those of all.
struct StationAlignmentEstimate {
  double clock = 0.0;        ///< its stamps are so much later than the mean of all stations' would be [s]
  double clock_sigma = 0.0;  ///< [s]
  Eigen::Vector3d orientation =
      Eigen::Vector3d::Zero();  ///< rotation vector: what it sees is turned by this [rad]
  Eigen::Vector3d orientation_sigma = Eigen::Vector3d::Zero();  ///< [rad]
};

/// Clock offsets and misorientations of stations from pairs of rays of one target: in one plane with the
/// baseline they would lie (P-3), and how far they are out of it answers linearly to both (P-14). No model of
/// motion and no estimate of the position is needed, so that nothing is found that was put in. Errors of
/// tracks and the slow errors of stations stay for a while and make samples say the same: both are considered
/// (Schmidt 1966), with the times for which they stay, in the covariance of the estimate. Along one path what
/// a lens gets wrong looks like a clock or an orientation, and no residual tells. What angles cannot tell (a
/// common clock, a common rotation) stays at its prior, which its standard deviation shows.
class StationAlignment {
 public:
  static constexpr int kStates = 4;  ///< of a station: clock, orientation

  /// Throws std::invalid_argument for a parameter out of range.
  explicit StationAlignment(const StationAlignmentParams& params = {});

  /// What two stations (numbers from 0, the caller's) see of one target at a time, with motion; times do not
  /// go back. `share`: of a sample that this one counts for, in (0, 1]: pairs of n rays share errors.
  /// Estimates are those of up to a second before.
  void take(Time time, const LocalView& a, const LocalView& b, double share);

  /// Time passes: what was seen counts less.
  void forget(double h);

  /// Whether a pair has been taken of the station.
  bool knows(int station) const;

  /// nullopt for a station that no pair has been taken of.
  /// The clock is against the mean of all known stations, but those that count as wrong (by station; may be
  /// shorter).
  std::optional<StationAlignmentEstimate> of(int station, const std::vector<bool>& is_wrong = {}) const;

  /// Mean and covariance over (clock [s], orientation [rad]) of one station, priors included; the priors
  /// alone for one that is not known.
  struct Marginal {
    Eigen::Vector4d mean = Eigen::Vector4d::Zero();
    Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  };
  Marginal marginalOf(int station) const;

  /// Clock of station `b` less that of station `a`, and its standard deviation [s].
  struct ClockDifference {
    double difference = 0.0, sigma = 0.0;
  };
  std::optional<ClockDifference> clockDifference(int a, int b) const;

  int stations() const { return static_cast<int>(is_seen_.size()); }

  /// Normal equations over (clock, orientation) of each station, without the priors: the information that is
  /// left with all errors considered.
  struct Equations {
    Eigen::MatrixXd information;
    Eigen::VectorXd vector;
  };
  Equations equations() const;

 private:
  using PairVector = Eigen::Matrix<double, 2 * kStates, 1>;  // over the states of two stations
  struct Sample {
    double offset = 0.0, variance = 0.0;
    PairVector h = PairVector::Zero();  // how the offset answers to the states
  };
  struct Series {                                                             // of two tracks
    Time time{};                                                              // of its last sample
    PairVector by_tracks = PairVector::Zero(), by_slow = PairVector::Zero();  // what errors that are still
                                                                              // there have added to `vector_`
  };

  void makeRoomFor(int station);
  double credibility(const Sample& sample, int a, int b) const;
  bool tells(int station) const;
  void solve();
  Eigen::VectorXd priors() const;

  StationAlignmentParams params_;
  std::vector<bool> is_seen_;
  Eigen::MatrixXd information_;  // as if samples were independent
  Eigen::MatrixXd considered_;   // covariance of `vector_`
  Eigen::VectorXd vector_;
  double squares_ = 0.0, count_ = 0.0;  // of samples
  std::map<std::pair<ViewKey, ViewKey>, Series> series_;
  std::optional<Time> solved_;  // time of a sample
  double unsolved_for_ = 0.0;   // of forgetting since then [s]
  double scale_ = 1.0;          // of the variance of what is left, over what the rays state
  Eigen::VectorXd solution_;
  Eigen::MatrixXd covariance_;
};

}  // namespace sightline::core
