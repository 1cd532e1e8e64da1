#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/estimators/mode_chain.h"
#include "sightline/core/model/time.h"
#include "sightline/core/positions/position_belief.h"
#include "sightline/core/positions/position_start.h"
#include "sightline/core/positions/stations/seen_stations.h"

namespace sightline::core {

/// Jerk and acceleration over many decades: fireballs at 100 km and drones at 50 m lie in the middle.
std::vector<PositionModel> defaultPositionModels();

struct PositionEstimatorParams {
  std::vector<PositionModel> models = defaultPositionModels();  ///< 1 to kMaxModes
  double dwell = 10.0;            ///< mean time between changes of the model [s], > 0
  double scale_memory = 1.0;      ///< of the scale of innovations in the models' evidence (P-8) [s], > 0
  double outlier_distance = 4.0;  ///< innovations beyond so many sigmas are down-weighted [1], >= 1
  double alone_after = 0.3;       ///< a station counts as gone when silent so long [s], > 0, or for
  double alone_intervals = 5.0;   ///< so many of its intervals, whichever is longer [1], > 0
  double start_window = 0.5;      ///< directions of so long before are used to start [s], > 0
  double max_relative_sigma =
      0.3;  ///< largest standard deviation over the range with which a position is one [1], in (0, 1)
  double lost_relative_sigma = 1.0;  ///< above it the target is started anew [1], > max_relative_sigma
  double fast_share = 0.4;  ///< part of the slow error's sigma that changes within `fast_time` [1], >= 0
  double fast_time = 0.05;  ///< its time constant [s], > 0
};

/// What became of a measurement.
enum class MeasurementUse {
  taken,      ///< the state was updated
  waiting,    ///< kept until a second station sees the target
  started,    ///< with it the target has a position
  restarted,  ///< the position contradicted it for long, and was started anew or given up
  refused,    ///< not finite, no positive definite covariance, or older than the state
};

/// Where the target is.
struct PositionState {
  Eigen::Matrix<double, 6, 1> mean = Eigen::Matrix<double, 6, 1>::Zero();  ///< position [m], velocity [m/s]
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  double relative_sigma = 0.0;  ///< largest standard deviation of the position over the range of the nearest
                                ///< station that supports it [1]
  double parallax = 0.0;        ///< largest angle between the lines to two stations that support it now [rad]
  int stations = 0;             ///< that support it now
};

/// What a station's slow error is at present, as far as this target tells.
struct SlowErrorEstimate {
  int station = 0;
  Time time{};
  double since = 0.0;                               ///< the station's measurement before its last one [s]
  Eigen::Vector2d error = Eigen::Vector2d::Zero();  ///< over `basis` [rad]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< [rad^2]
  Eigen::Matrix<double, 2, 3> basis = Eigen::Matrix<double, 2, 3>::Zero();
};

/// The way from one measurement to the next, as a smoother needs it.
struct PositionStep {
  std::vector<PositionBelief> from;           ///< of each model after the measurement before
  ModeChain chain;                            ///< likewise
  double h = 0.0;                             ///< [s], >= 0
  double unit_squared = 0.0;                  ///< (sigma rho)^2 of the models' densities (P-4) [m^2]
  std::array<SlowError, kMostStations> slow;  ///< of each slot
  std::vector<int> stations;                  ///< of each slot
};

/// One target's position and velocity from directions seen at several places, of known correspondence, in
/// order of time. NOGA's uncertainty reduction (20)-(23), iterated, in an interacting bank free of scale
/// (P-4), (P-5); the stations' slow errors are in the state. While one station at rest sees the target alone,
/// range and speed along the ray keep their variance and grow with the models (P-6). A value: a copy is a
/// snapshot. Nothing is allocated after the first measurements.
class PositionEstimator {
 public:
  /// Throws std::invalid_argument for a parameter out of range.
  explicit PositionEstimator(const PositionEstimatorParams& params = {});

  MeasurementUse update(const StationMeasurement& measurement) { return take(measurement, nullptr); }

  /// The same; `step` is the way to the measurement where there was a position before it and it is taken or
  /// gives the position up, else nullopt. Allocates.
  MeasurementUse updateWithStep(const StationMeasurement& measurement, std::optional<PositionStep>& step) {
    step.reset();
    return take(measurement, &step);
  }

  /// At a time not before the last measurement; nullopt without a position.
  std::optional<PositionState> stateAt(Time time) const;

  /// Whether the state is good enough to be called a position: its relative sigma is below the limit.
  bool isPosition(const PositionState& state) const {
    return state.relative_sigma < params_->max_relative_sigma;
  }

  bool hasState() const { return has_state_; }
  std::optional<Time> time() const { return time_; }  ///< of the last measurement taken
  const ModeArray& probabilities() const { return chain_.probabilities(); }

  /// What each model believes, with the stations whose slow errors are in the state; without a position,
  /// nothing that counts. As the beginning of a step of no length.
  PositionStep standingStep() const;

  /// Mean normalised innovation squared of the last second, 1 when all is well.
  double misfit() const { return misfit_; }

  /// The slow error of a station; nullopt when it is not in the state.
  std::optional<SlowErrorEstimate> slowErrorOf(int station) const;

 private:
  struct Slot {
    int station = -1;
    SlowError slow;
    Eigen::Matrix<double, 2, 3> basis = Eigen::Matrix<double, 2, 3>::Zero();
  };

  MeasurementUse take(const StationMeasurement& measurement, std::optional<PositionStep>* step);
  void start(const PositionBelief& belief, Time now);
  void giveUp(const StationMeasurement& last);
  double unitSquaredAt(Time time) const;
  void moveTo(Time time);
  int slotOf(const StationMeasurement& measurement);
  void dropSlot(int slot);
  Eigen::Matrix2d noiseOf(const StationMeasurement& measurement, const Eigen::Matrix<double, 2, 3>& basis,
                          double since, bool is_in_state) const;
  PositionBelief mixed(const ModeArray& weights, const std::array<PositionBelief, kMaxModes>& beliefs) const;
  void keepAlongRay(const Eigen::Vector3d& origin);

  std::shared_ptr<const PositionEstimatorParams> params_;  // shared by copies
  ModeChain chain_;
  bool has_state_ = false;
  std::optional<Time> time_;
  std::array<PositionBelief, kMaxModes> beliefs_;
  double scale_shape_ = 1.0, scale_sum_ = 1.0;  // a and b of (S-11), of all models together
  std::array<Slot, kMostStations> slots_;
  int slot_count_ = 0;
  SeenStations seen_;
  PositionStart waiting_;
  double misfit_ = 1.0;
  std::optional<double> along_floor_;  // variance along the ray of the station alone [m^2]
};

}  // namespace sightline::core
