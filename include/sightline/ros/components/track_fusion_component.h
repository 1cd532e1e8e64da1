#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include <sightline/FusionReport.h>
#include <sightline/TrackArray.h>
#include <sightline/TrackletArray.h>
#include <std_msgs/Header.h>

#include "sightline/core/fusion/track_fusion.h"
#include "sightline/core/model/refusal.h"
#include "sightline/core/ordering/recoverable.h"
#include "sightline/ros/components/sensor_places.h"
#include "sightline/ros/components/simulated_clock.h"
#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {

/// What a fusion says of one message. All is null when the message waits to be fused with others.
struct FusionResult {
  sightline::TrackArray::Ptr tracks;  ///< the global tracks; null when the message was refused
  sightline::FusionReport::Ptr
      report;  ///< who made them; when the message was refused, again with its tracks left out
  std::shared_ptr<const sightline::core::FusionReport> fused;  ///< what `report` says, of the core
  std::optional<sightline::core::Refusal> refusal;             ///< nullopt when the message was used
};

/// A track fusion from message to message, without a node round it. Node, nodelet and offline replay hold one
/// each.
///
/// Refused are tracks in another frame than `tracking_frame` (directions seen from another origin cannot be
/// fused), those of a tracker whose sensors stand further than `max_baseline` from the others' (likewise),
/// from the future, of this fusion itself, or under a name that another topic uses already. A message at
/// which the fusion fails is refused, and the fusion goes on from the state before it; one that fails at
/// every message for long forgets its tracks.
class TrackFusionComponent {
 public:
  /// Reads all parameters of the fusion at this level of `reader` but `track_topics` and those of the node;
  /// the caller calls `finish`. `name` is the fusion's name where `tracker_name` does not say another. Throws
  /// ParamError.
  /// `transforms`, which is filled by others and must outlive this, tells where sensors stand; null: nobody
  /// knows it.
  TrackFusionComponent(const ParamReader& reader, const std::string& name,
                       const tf2::BufferCore* transforms = nullptr);

  /// Takes the tracks of one local tracker that came on `topic`; `now` is the clock at its arrival, 0 = not
  /// known.
  FusionResult onTracks(const sightline::TrackArray& local, const std::string& topic,
                        sightline::core::Time now);

  /// Fuses what waits for others that did not come; nullopt when nothing waits. To be called `maxWait` after
  /// a message began to wait, and at the end of a recording.
  std::optional<FusionResult> fuseWaiting();

  bool isWaiting() const { return fusion_.state().hasNewReports(); }
  double maxWait() const { return params_.max_wait; }  ///< of a message for others [s]

  /// Takes the tracklets of one local tracker that came on `topic`, for the fusions that follow. Returns why
  /// they, or some of them, were refused; nullopt when they were not.
  std::optional<sightline::core::Refusal> onTracklets(const sightline::TrackletArray& local,
                                                      const std::string& topic, sightline::core::Time now);

  /// Loads the parameters of the fusion again and goes on with them: see core::TrackFusion::reconfigure.
  /// Returns why not; then nothing has changed. Throws ParamError; likewise. Afterwards `wantsTracklets` may
  /// be another.
  std::optional<sightline::core::Refusal> reconfigure(const ParamReader& reader);

  /// Where sensors stand; null without transforms.
  SensorPlaces* places() { return places_ ? &*places_ : nullptr; }

  /// Whether the rule can make use of tracklets.
  bool wantsTracklets() const;

  std::size_t lateTracklets() const { return fusion_.state().lateTracklets(); }  ///< too late to be used

  /// Tracklets that an estimator could not take.
  const sightline::core::TrackletFailures& failedTracklets() const {
    return fusion_.state().failedTracklets();
  }

  /// Simulated time is `now`. When it has gone back by more than tracklets may be late (a recording in a
  /// loop), forgets everything but the ids and returns by how much [s]; nullopt else, as such a step is none.
  std::optional<double> onSimulatedTime(sightline::core::Time now);

  double maxLag() const { return params_.tracklets.max_lag; }  ///< lateness of tracklets that are used [s]

  /// Forgets everything but the ids: time started again.
  void reset();

  const std::string& name() const { return name_; }
  const std::string& trackingFrame() const { return tracking_frame_; }
  std::string rule() const { return nameOf(params_.rule); }

 private:
  /// Where a tracker's reports come from.
  struct Origin {
    std::string topic;
    sightline::core::Time newest;
  };

  using Origins = std::map<std::string, Origin>;  // by tracker; at most as many as the fusion knows

  /// A report of tracks, and when it came.
  struct Arrival {
    sightline::core::LocalReport report;
    std::optional<sightline::core::Time> time;
  };
  struct EndOfWait {};
  using Input = std::variant<Arrival, sightline::core::TrackletReport, EndOfWait>;
  /// A refusal or nothing of a message that did not lead to a fusion.
  using Answer = std::variant<sightline::core::FusionReport, std::optional<sightline::core::Refusal>>;

  static Answer handle(sightline::core::TrackFusion& fusion, const Input& input);
  static std::size_t sizeOf(const Input& input);
  sightline::core::Refusal failed(const std::string& tracker);
  std::optional<sightline::core::Refusal> refusalOf(const std::string& tracker,
                                                    const std_msgs::Header& header, const std::string& topic,
                                                    const Origins& origins, sightline::core::Time now) const;
  void note(const std::string& tracker, const std_msgs::Header& header, const std::string& topic,
            Origins& origins) const;
  FusionResult fused(sightline::core::FusionReport&& report);
  FusionResult refused(const sightline::TrackArray& local, const sightline::core::Refusal& why) const;
  sightline::TrackArray::Ptr trackArray(const sightline::core::FusionReport& fused) const;
  sightline::FusionReport::Ptr fusionReport(const sightline::core::FusionReport& fused) const;

  std::string name_;
  std::string tracking_frame_;
  double max_future_;  // [s]
  std::optional<SensorPlaces> places_;
  sightline::core::TrackFusionParams params_;
  sightline::core::Recoverable<sightline::core::TrackFusion, Input, Answer> fusion_;
  std::shared_ptr<const sightline::core::FusionReport> latest_;  // never null
  Origins origins_, tracklet_origins_;
  SimulatedClock clock_;
};

}  // namespace sightline_ros
