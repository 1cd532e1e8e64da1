#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <sightline/AssociationArray.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>
#include <sightline/TrackletArray.h>
#include <tf2/buffer_core.h>

#include "sightline/core/model/refusal.h"
#include "sightline/core/model/time.h"
#include "sightline/core/ordering/recoverable.h"
#include "sightline/core/ordering/stamp_watch.h"
#include "sightline/core/tracking/local_tracker.h"
#include "sightline/core/tracking/tracklet_builder.h"
#include "sightline/ros/messages/frames.h"
#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {

/// What a local tracker reports of one scan.
struct TrackerReport {
  sightline::SightingArray::ConstPtr scan;
  sightline::TrackArray::Ptr tracks;              ///< null when the scan was dropped
  sightline::TrackletArray::Ptr tracklets;        ///< null when none are due; to be sent before the tracks
  sightline::AssociationArray::Ptr associations;  ///< every sighting of the scan, whether it was used or not
  /// With which tracks were updated, in the tracking frame; only where the tracker is told to keep them.
  std::vector<sightline::core::TrackTracklet> sightings;
  double noise_scale = 1.0;  ///< factor on the stated variances that they have in them already
  std::size_t rejected = 0;  ///< sightings with REJECTED_INPUT
  std::optional<sightline::core::Refusal> refusal;     ///< why the scan was not used
  std::vector<sightline::core::SensorChange> changes;  ///< of sensors' verdicts; mostly none
  std::string notice;      ///< what else an operator must know (stamps that jump); mostly empty
  bool went_back = false;  ///< time went back: everything was started anew before this scan
};

/// A local tracker from message to message, without a node round it: frame change, then the tracker of the
/// core. Node, nodelet and offline replay hold one each. A scan at which the tracker fails is refused, and
/// the tracker goes on from the state before it; one that fails at every scan for long starts anew.
class LocalTrackerComponent {
 public:
  /// Reads all parameters of the tracker at this level of `reader` but `sighting_topics`; the caller calls
  /// `finish`. `name` is the tracker's name where `tracker_name` does not say another. Throws ParamError.
  LocalTrackerComponent(const ParamReader& reader, const std::string& name,
                        const tf2::BufferCore& transforms);

  /// Takes a scan; `now` is the clock, 0 = not known. Returns what became of it, and of scans that had
  /// waited; nothing as long as it has to wait for its transform, or is held as its stamp leaps ahead of the
  /// other sensors'.
  std::vector<TrackerReport> onScan(const sightline::SightingArray::ConstPtr& scan,
                                    sightline::core::Time now);

  /// Transforms have come, or time has gone by: what became of the scans that were waiting.
  std::vector<TrackerReport> onTransforms(sightline::core::Time now);

  /// Tracklets that wait for a scan that does not come; null when nothing has to be sent by now.
  sightline::TrackletArray::Ptr overdueTracklets(sightline::core::Time now);

  /// From now on reports hold the sightings with which tracks are updated.
  void keepSightings();

  /// Time went back to `time`: deletes everything and tracks on from there.
  void startAnew(sightline::core::Time time);

  /// Loads the parameters of the tracker again and goes on with them: see core::LocalTracker::reconfigure.
  /// Returns why not; then nothing has changed. Throws ParamError; likewise.
  std::optional<sightline::core::Refusal> reconfigure(const ParamReader& reader);

  /// How the stamps of each sensor stand to the others'.
  std::vector<sightline::core::WatchedStamps> stamps() const { return stamps_.sensors(); }

  /// Verdicts on the sensors that have been compared with others.
  std::vector<sightline::core::WatchedSensor> sensors() const { return tracking_.state().tracker.sensors(); }

  /// What has been learnt of each sensor's noise.
  const std::vector<sightline::core::CalibratedSensor>& calibratedSensors() const {
    return tracking_.state().tracker.calibratedSensors();
  }

  /// What has been learnt of how each sensor sees targets, and what is none.
  const std::vector<sightline::core::CalibratedDetection>& detection() const {
    return tracking_.state().tracker.detection().sensors();
  }

  std::size_t waiting() const { return frames_.waiting(); }
  const std::string& name() const { return name_; }
  const std::string& estimator() const { return estimator_; }
  const sightline::core::EstimatorParams& estimatorParams() const { return estimator_params_; }
  const std::string& trackingFrame() const { return frames_.params().tracking_frame; }
  double maxLag() const { return max_lag_; }  ///< lateness up to which a scan is put in its place [s]
  double maxFuture() const { return frames_.params().max_future; }  ///< [s]
  double smoothingLag() const { return smoothing_lag_; }            ///< of live smoothing [s]; 0 = none
  double tfTimeout() const { return frames_.params().tf_timeout; }  ///< [s]

 private:
  /// What a scan changes.
  struct Tracking {
    sightline::core::LocalTracker tracker;
    std::optional<sightline::core::TrackletBuilder> tracklets;  // none: not enabled
    bool keeps_sightings = false;
  };
  /// A scan, or the clock where no scan comes.
  using Input = std::variant<sightline::core::Scan, sightline::core::Time>;
  struct Answer {
    sightline::core::ScanReport report;  // of a scan
    std::optional<sightline::core::TrackletReport> tracklets;
    std::vector<sightline::core::TrackTracklet> sightings;
  };

  static Answer handle(Tracking& tracking, const Input& input);
  static std::size_t sizeOf(const Input& input);

  LocalTrackerComponent(const sightline::core::LocalTrackerParams& tracker,
                        const sightline::core::TrackletParams& tracklets, const FrameChangeParams& frames,
                        std::string name, double smoothing_lag, const tf2::BufferCore& transforms);

  void admit(FramedScan framed, sightline::core::Time now, std::vector<TrackerReport>& reports);
  void startTrackerAnew(sightline::core::Time time);
  sightline::core::Refusal failed(const sightline::SightingArray& scan);
  TrackerReport track(FramedScan& framed);
  TrackerReport refuse(FramedScan& framed, sightline::core::Refusal refusal, const std::string& reason) const;
  TrackerReport withAssociations(TrackerReport report, FramedScan& framed,
                                 std::vector<sightline::core::Association> associations) const;
  sightline::TrackArray::Ptr trackArray(const sightline::core::ScanReport& report) const;
  sightline::TrackletArray::Ptr trackletArray(std::optional<sightline::core::TrackletReport> report) const;

  std::string name_;
  std::string estimator_;
  sightline::core::EstimatorParams estimator_params_;
  double max_lag_, smoothing_lag_;
  FrameChange frames_;
  sightline::core::StampGate<FramedScan> stamps_;
  sightline::core::Recoverable<Tracking, Input, Answer> tracking_;
};

}  // namespace sightline_ros
