#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>
#include <ros/wall_timer.h>
#include <sightline/PositionTrackArray.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>
#include <tf2/buffer_core.h>

#include "sightline/core/evaluation/evaluation.h"
#include "sightline/core/evaluation/position_scores.h"
#include "sightline/ros/diagnosis/callback_guard.h"
#include "sightline/ros/diagnosis/periodic_diagnostics.h"
#include "sightline/ros/diagnosis/transform_subscriber.h"
#include "sightline/ros/messages/frames.h"
#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {

/// Parameters of the node; `config/track_evaluator.yaml` repeats the defaults.
struct TrackEvaluatorParams {
  TrackEvaluatorParams();

  sightline::core::EvaluationParams evaluation;
  FrameChangeParams frames;
  std::vector<std::string> sighting_topics;                       ///< SightingArray
  std::vector<std::string> track_topics;                          ///< TrackArray
  std::vector<std::string> position_topics{"/positions/tracks"};  ///< PositionTrackArray
  sightline::core::PositionEvaluationParams positions;  ///< without `settle`, which is `settle_time`
  bool live = false;                                    ///< prints a summary once a second
  double duration = 0.0;   ///< ends by itself after so much of the data's time [s]; 0 = never
  std::string table_file;  ///< gets the table; empty = standard output
};

/// Reads all parameters of the node. Throws ParamError.
TrackEvaluatorParams loadTrackEvaluatorParams(const ParamReader& reader);

/// Listens to /truth, sightings and tracks, to /truth/positions and positions, publishes /evaluation once a
/// second, and prints the table when it ends. Ends the process after `duration` (of a nodelet: its manager).
class TrackEvaluatorNode {
 public:
  /// Throws ParamError, also when the table's file cannot be written.
  TrackEvaluatorNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh);
  ~TrackEvaluatorNode();

  TrackEvaluatorNode(const TrackEvaluatorNode&) = delete;
  TrackEvaluatorNode& operator=(const TrackEvaluatorNode&) = delete;

 private:
  /// First and last stamp of one kind of message so far.
  struct Span {
    sightline::core::Time first{}, last{};
  };

  void subscribe();
  void onTruth(const sightline::TrackArray& truth);
  void onScan(const std::string& topic, const sightline::SightingArray::ConstPtr& scan);
  void onTracks(const std::string& topic, const sightline::TrackArray& tracks);
  void onPositionTruth(const sightline::PositionTrackArray& truth);
  void onPositions(const std::string& topic, const sightline::PositionTrackArray& positions);
  void releaseScans();
  void everySecond();

  bool isInTrackingFrame(const std::string& topic, const std::string& frame);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);
  void drop(const std::string& topic, const sightline::core::Refusal& refusal);
  void endAfterDuration(std::optional<Span>& span, sightline::core::Time stamp);
  bool hasDirections() const;
  double elapsed() const;
  void printLive();
  std::string table();
  void printTable();

  ros::NodeHandle nh_;
  CallbackGuard guard_;
  TrackEvaluatorParams params_;
  sightline::core::Evaluation evaluation_;
  sightline::core::PositionScores position_scores_;
  std::string position_frame_;  // of the truth; empty = it has not come
  tf2::BufferCore transforms_;
  std::map<std::string, FrameChange> frame_changes_;  // by topic
  std::map<std::string, std::uint64_t> dropped_;      // messages, by topic and reason
  std::optional<Span> truth_span_, track_span_;
  int live_lines_ = 0;  // of the last summary, on a terminal
  ros::Publisher publisher_;
  std::vector<ros::Subscriber> subscribers_;
  std::optional<TransformSubscriber> transform_subscriber_;
  ros::WallTimer second_timer_, release_timer_, end_timer_;
  std::optional<PeriodicDiagnostics> diagnostics_;
};

}  // namespace sightline_ros
