#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include <geometry_msgs/PoseArray.h>
#include <sightline/PositionReport.h>
#include <sightline/PositionTrackArray.h>
#include <sightline/TrackArray.h>
#include <sightline/TrackletArray.h>
#include <tf2/buffer_core.h>

#include "sightline/core/model/refusal.h"
#include "sightline/core/ordering/recoverable.h"
#include "sightline/core/positions/position_tracker.h"
#include "sightline/ros/components/simulated_clock.h"
#include "sightline/ros/components/station_views.h"
#include "sightline/ros/messages/frame_params.h"
#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {

/// What became of one message of tracks or tracklets.
struct PositionResult {
  std::string topic, tracker;
  bool is_tracks = false;  ///< else tracklets
  sightline::core::Time stamp{};
  std::size_t used = 0;                            ///< tracks or tracklets of it
  std::vector<sightline::core::Refusal> refusals;  ///< of the message, or of single tracks or tracklets of it
  std::string notice;                              ///< what else an operator must know; mostly empty
  sightline::PositionTrackArray::Ptr tracks;       ///< the positions; null unless tracks were used
  sightline::PositionReport::Ptr report;           ///< with `tracks`
  geometry_msgs::PoseArray::Ptr poses;             ///< likewise
  /// After `keepMeasurements`: what targets were updated with that nothing late can change any more, with
  /// the ids of `tracks`.
  std::vector<sightline::core::TakenMeasurement> taken;
};

/// A position tracker from message to message, without a node round it. Node, nodelet and offline replay hold
/// one each.
///
/// Messages wait for the transform of their station at their stamp, behind earlier ones of its frame; each
/// tracklet is seen from where its station was at its own stamp. A message at which the tracker fails is
/// refused, and the tracker goes on from the state before it; one that fails at every message for long
/// forgets its positions, and so does one to which all tracks come late for long: their time went back.
class PositionTrackerComponent {
 public:
  /// Reads all parameters of the position tracker at this level of `reader` but the topics and those of the
  /// node; the caller calls `finish`. `name` is used where `tracker_name` does not say another. `transforms`
  /// is filled by others and must outlive this. Throws ParamError.
  PositionTrackerComponent(const ParamReader& reader, const std::string& name,
                           const tf2::BufferCore& transforms);

  /// Takes the tracks or tracklets of one local tracker that came on `topic`; `now` is the clock, 0 = not
  /// known. Returns what became of it and of messages that had waited; nothing as long as it has to wait.
  std::vector<PositionResult> onTracks(const sightline::TrackArray::ConstPtr& local, const std::string& topic,
                                       sightline::core::Time now);
  std::vector<PositionResult> onTracklets(const sightline::TrackletArray::ConstPtr& local,
                                          const std::string& topic, sightline::core::Time now);

  /// Transforms have come, or time has gone by: what became of the messages that were waiting.
  std::vector<PositionResult> onTransforms(sightline::core::Time now);

  /// Simulated time is `now`. When it has gone back by more than messages may be late (a recording in a
  /// loop), forgets everything but the ids and returns by how much [s]; nullopt else.
  std::optional<double> onSimulatedTime(sightline::core::Time now);

  /// Forgets everything but the ids: time started again.
  void reset();

  /// From now on results have what targets are updated with, for a smoother.
  void keepMeasurements();

  /// What has not been in a result because something late could have changed it: when nothing comes any more,
  /// or before a reset.
  std::vector<sightline::core::TakenMeasurement> openMeasurements();

  /// Of the positions of targets.
  const sightline::core::PositionEstimatorParams& estimatorParams() const { return params_.scene.estimator; }

  std::size_t waiting() const { return waiting_count_; }
  const std::string& name() const { return name_; }
  const std::string& trackingFrame() const { return frames_.tracking_frame; }
  double maxLag() const { return params_.max_lag; }        ///< [s]
  double tfTimeout() const { return frames_.tf_timeout; }  ///< [s]

  /// Where the station of each local tracker was last [m].
  const std::map<std::string, Eigen::Vector3d>& stations() const { return stations_; }

 private:
  using Message = std::variant<sightline::TrackArray::ConstPtr, sightline::TrackletArray::ConstPtr>;
  struct Waiting {
    Message message;
    std::string topic;
    sightline::core::Time since;
  };
  /// Where a tracker reports its tracks, or its tracklets.
  struct Origin {
    std::string topic;
    sightline::core::Time newest{};
  };
  using Origins = std::map<std::string, Origin>;  // by tracker

  using Input = std::variant<sightline::core::StationTracks, std::vector<sightline::core::StationTracklet>>;
  struct Answer {
    std::vector<sightline::core::Refusal> refusals;
    std::optional<sightline::core::PositionOutput> output;
    std::vector<sightline::core::TakenMeasurement> taken;
  };

  static Answer handle(sightline::core::PositionTracker& tracker, const Input& input);
  static std::size_t sizeOf(const Input& input);
  static const std_msgs::Header& headerOf(const Message& message);
  static const std::string& trackerOf(const Message& message);
  static PositionResult resultOf(const Message& message, const std::string& topic);

  std::vector<PositionResult> add(Message message, const std::string& topic, sightline::core::Time now);
  std::optional<sightline::core::Refusal> refusalOf(const Message& message, const std::string& topic,
                                                    sightline::core::Time now) const;
  void releaseFirst(std::deque<Waiting>& messages, sightline::core::Time now,
                    std::vector<PositionResult>& results);
  PositionResult dropOldest();
  sightline::core::Refusal withoutTransform(const std_msgs::Header& header, double waited) const;
  PositionResult track(const Message& message, const std::string& topic);
  void takeTracks(const sightline::TrackArray& local, PositionResult& result);
  void takeTracklets(const sightline::TrackletArray& local, PositionResult& result);
  std::optional<Answer> take(Input input, PositionResult& result);
  void publish(const sightline::core::PositionOutput& output, PositionResult& result);
  std::vector<sightline::core::TakenMeasurement> numbered(
      std::vector<sightline::core::TakenMeasurement> taken) const;

  std::string name_;
  FrameChangeParams frames_;
  StationViews views_;
  int max_trackers_, max_sensors_;
  sightline::core::PositionTrackerParams params_;
  const tf2::BufferCore& transforms_;
  sightline::core::Recoverable<sightline::core::PositionTracker, Input, Answer> tracker_;
  std::map<std::string, std::deque<Waiting>> waiting_;  // by frame, oldest first, none empty
  std::size_t waiting_count_ = 0;
  Origins track_origins_, tracklet_origins_;
  std::set<std::pair<std::string, std::string>> sensors_;  // tracker and sensor
  std::map<std::string, Eigen::Vector3d> stations_;
  bool keeps_measurements_ = false;
  std::uint32_t highest_id_ = 0;  // published
  std::uint32_t id_offset_ = 0;   // of the ids of this tracker, as those before a reset are not used again
  int late_in_a_row_ = 0;         // messages of tracks
  SimulatedClock clock_;
};

}  // namespace sightline_ros
