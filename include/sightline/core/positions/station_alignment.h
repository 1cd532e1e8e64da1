#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/positions/rays.h"

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
/// motion and no estimate of the position is needed, so that nothing is found that was put in. What angles
/// cannot tell (a common clock, a common rotation) stays at its prior, which its standard deviation shows.
class StationAlignment {
 public:
  /// Throws std::invalid_argument for a parameter out of range.
  explicit StationAlignment(const StationAlignmentParams& params = {});

  /// Two rays with motion of one target, seen by stations `a` and `b` (numbers from 0, the caller's) at one
  /// time; slow errors are in the rays' covariances. `share`: of an independent sample that this one is, in
  /// (0, 1]; errors that vary slowly make samples say the same.
  void take(int a, const Ray& ray_a, int b, const Ray& ray_b, double share);

  /// Time passes: what was seen counts less.
  void forget(double h);

  /// nullopt for a station that no pair has been taken of.
  std::optional<StationAlignmentEstimate> of(int station) const;

  /// Clock of station `b` less that of station `a`, and its standard deviation [s].
  struct ClockDifference {
    double difference = 0.0, sigma = 0.0;
  };
  std::optional<ClockDifference> clockDifference(int a, int b) const;

  int stations() const { return static_cast<int>(is_seen_.size()); }

 private:
  static constexpr Eigen::Index kStates = 4;  // of a station: clock, orientation
  void makeRoomFor(int station);
  bool knows(int station) const;
  void solve() const;

  StationAlignmentParams params_;
  std::vector<bool> is_seen_;
  Eigen::MatrixXd information_;  // without the priors
  Eigen::VectorXd vector_;
  mutable bool is_solved_ = false;
  mutable Eigen::VectorXd solution_;
  mutable Eigen::MatrixXd covariance_;
};

}  // namespace sightline::core
