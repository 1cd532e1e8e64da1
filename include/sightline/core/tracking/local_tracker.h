#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "sightline/core/association/association.h"
#include "sightline/core/model/refusal.h"
#include "sightline/core/model/sighting.h"
#include "sightline/core/model/track.h"
#include "sightline/core/ordering/scan_order.h"
#include "sightline/core/ordering/settings_history.h"
#include "sightline/core/ordering/timeline.h"
#include "sightline/core/sensors/detection_calibration.h"
#include "sightline/core/sensors/noise_calibration.h"
#include "sightline/core/sensors/sensor_changes.h"
#include "sightline/core/sensors/sensor_guard.h"
#include "sightline/core/tracking/duplicate_tracks.h"
#include "sightline/core/tracking/live_track.h"
#include "sightline/core/tracking/local_tracker_params.h"

namespace sightline::core {

/// What a tracker reports after a scan.
struct ScanReport {
  Time time{};                            ///< of `tracks`: the newest scan's
  std::vector<Track> tracks;              ///< ascending id, in the tracking frame, valid at `time`
  std::vector<Association> associations;  ///< one for each sighting of this scan, in its order
  SensorUse use;                          ///< of the sightings, with what has been learnt of their noise
  std::vector<SensorChange> changes;      ///< of sensors' verdicts, not reported before
  std::optional<Refusal> refusal;         ///< why the scan was not used: late, duplicate
};

/// Tracks targets with the sightings of one sensor or of several. Scans come in the tracking frame, in any
/// order within `max_lag`: for a late one the tracker rolls back and processes the scans from there again, so
/// that the state after it is the same as in order, to the last bit. Ids of tracks that had been started
/// after the late scan may be given anew by this.
///
/// Where several sensors see a target, each is watched against the others (SensorGuard): one whose noise
/// grows is used with that noise, one that is biased is not used until it has recovered, and the tracker
/// rolls back to when the change began. With one sensor nothing can be compared, and nothing is done.
///
/// What the sensors' noise really is, is learnt (NoiseCalibration, and NoiseLearning in each track). Where it
/// is less than stated, the rest of the stated variance is taken for an error that varies too slowly to be
/// averaged out, and is in the covariance of the reported positions.
class LocalTracker {
 public:
  explicit LocalTracker(const LocalTrackerParams& params);

  /// Takes a scan. Never throws for what is in it: unusable sightings are rejected one by one, with their
  /// reason. Stamps that jump are the business of a StampWatch before it.
  ScanReport onScan(const Scan& scan);

  /// Time went back to `time`: deletes the tracks and everything learnt, and tracks on from there. Ids go on.
  void startAnew(Time time);

  /// Goes on with other parameters: they hold for scans later than the newest one; scans that come late, and
  /// those processed again because of them, are processed with the parameters that held at their time.
  /// Tracks, their ids and what has been learnt stay. Where noise calibration is switched, what was learnt of
  /// the noise is forgotten. Returns why not (`whyNotInFlight` says what may change); then nothing has
  /// changed.
  std::optional<Refusal> reconfigure(const LocalTrackerParams& wanted);

  /// The parameters that hold for the next scan.
  const LocalTrackerParams& params() const { return *settings_.newest(); }

  /// Verdicts on the sensors that have been compared with others, by name.
  std::vector<WatchedSensor> sensors() const { return state_.guard.sensors(); }

  /// What has been learnt of each sensor's noise, by name.
  const std::vector<CalibratedSensor>& calibratedSensors() const { return state_.calibration.sensors(); }

  /// What is known of how each sensor sees targets, and what is none.
  const DetectionCalibration& detection() const { return state_.detection; }

 private:
  /// Everything that a scan changes.
  struct State {
    Time time{};
    SettingsHistory<LocalTrackerParams>::Pointer settings;  // with which the tracks and all below go on
    TrackIds ids;
    std::vector<LiveTrack> tracks;  // ascending id
    NoiseCalibration calibration;
    DetectionCalibration detection;
    DuplicateTracks duplicates;
    SensorGuard guard;
    std::vector<SensorChange> changes;  // the last ones
  };

  /// A scan beside what the tracks expected of it.
  struct AssociatedScan {
    Scan scan;  // with its sensor's noise as it has been learnt
    Scan used;  // with the noise of the sensor's verdict as well
    bool is_excluded = false;
    std::vector<TrackPrediction> predictions;
    AssociationResult result;
    std::vector<Corroboration> corroboration;  // for each prediction; empty while the guard is off
  };

  State firstState(Time time, const TrackIds& ids) const;
  const LocalTrackerParams& settings() const { return *state_.settings; }
  void followSettings(Time time);
  std::optional<Refusal> refusalOf(const Scan& scan) const;

  std::vector<Association> putInPlace(const Scan& scan, ScanReport& result);
  std::vector<Association> processNext();
  std::vector<Association> processAgain(const SensorChange& change);

  AssociatedScan predictAndAssociate(std::size_t k);
  std::vector<TrackPrediction> predict(const Scan& scan);
  Scan calibrated(const Scan& scan) const;
  void watch(const AssociatedScan& associated);

  std::vector<Association> updateTracks(AssociatedScan& associated);
  void leaveOut(AssociatedScan& associated) const;
  std::vector<std::uint32_t> updateOrMiss(const AssociatedScan& associated);
  void calibrate(const Scan& scan, const Sighting& sighting, const LiveTrack& track,
                 const TrackPrediction& prediction);
  void learnDetection(const AssociatedScan& associated);
  void reacquire(std::uint32_t id, AssociatedScan& associated);
  void startTracks(AssociatedScan& associated);
  void beginAnew(AssociatedScan& associated);
  void startBranches(const AssociatedScan& associated);
  void deleteDuplicates(const AssociatedScan& associated);
  void deleteTracks();
  std::vector<Track> report() const;

  SettingsHistory<LocalTrackerParams> settings_;
  State state_;
  Timeline<Scan, SensorUse, State> scans_;
  SensorChangeReporter reporter_;
  std::uint32_t highest_id_ = 0;  // reported so far
};

}  // namespace sightline::core
