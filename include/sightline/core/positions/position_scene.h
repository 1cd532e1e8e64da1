#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/model/field_of_view.h"
#include "sightline/core/model/time.h"
#include "sightline/core/model/track.h"
#include "sightline/core/model/tracklet.h"
#include "sightline/core/positions/position_estimator.h"
#include "sightline/core/positions/position_hypotheses.h"
#include "sightline/core/positions/position_track.h"
#include "sightline/core/positions/stations/station_alignment.h"
#include "sightline/core/positions/stations/station_correction.h"
#include "sightline/core/positions/stations/station_noise.h"

namespace sightline::core {

constexpr double kMostLogOdds = 20.0;  ///< that tracks are of one target
constexpr double kFreshestView = 0.5;  ///< [s] beyond which a local track says nothing of now

/// Where a station is, and how it is turned.
struct StationPose {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< [m], in the metric frame
  Eigen::Matrix3d R_metric_station =
      Eigen::Matrix3d::Identity();                     ///< maps the station's frame to the metric one
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< of the origin [m/s]
};

/// The tracks of one station at a time, in its frame.
struct StationTracks {
  std::string tracker;
  Time time{};
  StationPose pose;
  std::vector<FieldOfView> views;  ///< of its sensors, in the metric frame; empty = not known
  std::vector<Track> tracks;
};

/// One tracklet of one station's track, in the station's frame.
struct StationTracklet {
  std::string tracker;
  std::uint32_t track = 0;
  Tracklet tracklet;
  StationPose pose;  ///< at the time of the tracklet
};

/// A measurement that a target's position was updated or started with.
struct TakenMeasurement {
  std::uint32_t target = 0;  ///< id
  Time taken{};              ///< when, in the order of items; one that starts a target is older
  StationMeasurement measurement;
};

struct PositionSceneParams {
  PositionEstimatorParams estimator;
  HypothesisParams hypotheses;
  StationNoiseParams noise;
  StationAlignmentParams alignment;
  StationCorrectionParams correction;
  double decision_interval = 0.1;  ///< between decisions on which local tracks are one target [s], > 0
  double claim_gate = 18.5;     ///< chi-square of 4 with which a further local track supports a target, > 0
  int claim_decisions = 3;      ///< in turn, before it does, >= 1
  double contradiction = 25.0;  ///< chi-square of 2 from which a supporter contradicts the target, > 0
  double contradiction_time = 0.5;  ///< for which it must, before it is taken out [s], > 0
  double merge_gate = 22.5;         ///< chi-square of 6 with which two targets are one, > 0
  double confirm_after = 0.3;       ///< age of a position from which it is confirmed [s], >= 0
  double confirm_pair_after = 0.5;  ///< ... that only two stations support: until then it is given up when
                                    ///< other crossings explain its tracks as well [s], >= 0
  double coast_after = 0.5;         ///< without a tracklet, a position coasts [s], > 0
  double delete_after = 2.0;        ///< without a tracklet, it is deleted [s], > 0
  double remember_for = 10.0;       ///< a target that has become a direction keeps its id so long [s], >= 0
  int max_local_tracks = 4000;      ///< of all stations; more are not used, >= 1
  int max_targets = 1000;           ///< >= 1
};

/// All that is known of targets and stations at one time; tracklets and tracks go in in order of time. A
/// value: a copy is a snapshot (estimators are shared until one of them goes on).
class PositionScene {
 public:
  /// Throws std::invalid_argument for a parameter out of range.
  explicit PositionScene(const PositionSceneParams& params);

  void take(const StationTracklet& tracklet);
  void take(const StationTracks& tracks);

  /// From now on keeps what targets are updated with, until it is handed out.
  void keepMeasurements() { keeps_measurements_ = true; }

  /// The measurements kept that were taken before `end`; those before `begin` have been handed out earlier.
  std::vector<TakenMeasurement> handOut(Time begin, Time end);

  /// The positions at a time not before what was taken last, and what the last decision found.
  PositionOutput output(Time time) const;

 private:
  struct Tracker {
    std::string name;
    std::vector<FieldOfView> views;
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();
    Time time{};
  };
  struct Sensor {
    int tracker = 0;
    std::string name;
    StationNoise noise;
  };
  struct Local {
    LocalView view;                // at `time`, without slow errors, as the station says it
    Time time{}, since{};          // `since`: reported
    bool is_reported = false;      // by the tracker, and confirmed
    double existence = 0.5;        // as its tracker says; 0.5 where it says none
    double stated_variance = 0.0;  // of its directions, slow errors included [rad^2]; 0 = not known
    double reference = 0.0;        // slowReference of its directions [rad^2]
    std::vector<int> sensors;
    std::vector<StationMeasurement> recent;  // the last seconds, in order, as the station says it
    std::uint32_t target = 0;                // that it supports, 0 = none
  };
  struct Target {
    std::shared_ptr<PositionEstimator> estimator;
    std::set<ViewKey> supporters;
    std::map<ViewKey, double> contradicted;  // [s]
    double doubted = 0.0;  // for which a crossing of three stations has explained its tracks better [s]
    Time since{}, last_sighting{};  // `since`: has a position
    std::optional<Time> lost;       // when it became a direction
    bool is_confirmed = false;
    double log_odds = 0.0;  // that its tracks are of one target and not of several, but for stations that
                            // look there without a track of it
  };

  int trackerNumber(const std::string& name);
  int sensorNumber(int tracker, const std::string& name);
  std::string nameOf(const ViewKey& key) const;
  void feed(Target& target, const StationMeasurement& measurement, double reference);
  static bool speaksAt(const Local& local, Time now);
  static std::set<int> stationsOf(const Target& target);
  void note(std::uint32_t target, Time taken, const StationMeasurement& measurement);
  double existenceOf(const Target& target, const Eigen::Vector3d& position,
                     const std::vector<LookingStation>& stations) const;
  void decide(Time now);
  LocalView viewAt(const Local& local, Time now) const;
  LocalView statedViewAt(const Local& local, Time now) const;
  StationMeasurement corrected(const ViewKey& key, const StationMeasurement& measurement) const;
  void release(std::uint32_t id, const ViewKey& key);
  void dissolve(std::uint32_t id);
  void forget(Time now);
  void checkSupporters(Time now);
  void claim(Time now);
  static bool isOnProbation(const Target& target);
  void reviewProbation();
  void reviewPairs(Time now, const std::vector<LookingStation>& stations);
  std::vector<LookingStation> lookingStations(Time now) const;
  void startTargets(Time now);
  void merge(Time now);
  void learnAlignment(Time now);
  std::vector<std::vector<ViewKey>> alignedViews(Time now) const;
  void correctStations(Time now);
  std::vector<StationReport> stationReports() const;
  std::shared_ptr<PositionEstimator> estimatorFrom(const std::set<ViewKey>& members) const;

  std::shared_ptr<const PositionSceneParams> params_;
  std::vector<Tracker> trackers_;
  std::vector<Sensor> sensors_;
  std::map<ViewKey, Local> locals_;
  std::map<std::uint32_t, Target> targets_;
  PositionHypotheses hypotheses_;
  PositionHypotheses review_;          // of confirmed positions that two stations support
  StationAlignment alignment_;         // by number of the tracker
  StationAlignment common_alignment_;  // from times at which two targets or more tell something
  StationCorrections corrections_;
  std::optional<Time> corrected_;                            // when they were decided last
  std::map<std::pair<std::uint32_t, ViewKey>, int> claims_;  // decisions in turn
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> meetings_;
  bool keeps_measurements_ = false;
  std::vector<TakenMeasurement> taken_;
  std::uint32_t next_id_ = 1;
  std::optional<Time> decided_;
  HypothesisDecision decision_;
};

}  // namespace sightline::core
