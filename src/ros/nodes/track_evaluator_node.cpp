#include "sightline/ros/nodes/track_evaluator_node.h"

#include <algorithm>
#include <iostream>
#include <sstream>
#include <unistd.h>

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <ros/ros.h>
#include <sightline/Evaluation.h>

#include "sightline/report/evaluation_text.h"
#include "sightline/report/output_file.h"
#include "sightline/report/position_text.h"
#include "sightline/ros/messages/clock.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/messages/evaluation_messages.h"
#include "sightline/ros/messages/position_messages.h"
#include "sightline/ros/messages/scenario_messages.h"
#include "sightline/ros/nodes/this_node.h"
#include "sightline/ros/params/evaluation_params.h"

namespace sightline_ros {

namespace core = sightline::core;
namespace report = sightline::report;

namespace {

constexpr double kSecondsBetweenReports = 1.0;   // of the wall's clock
constexpr double kSecondsBetweenReleases = 0.1;  // of the wall's clock
constexpr double kSecondsForTheLast =
    0.5;  // of the wall's clock, for what is on its way when the duration is over

std::vector<std::string> ofSixSensors(const std::string& last) {
  std::vector<std::string> topics;
  for (const char* group : {"acquisition_", "tracking_"}) {
    for (const char* number : {"1", "2", "3"})
      topics.push_back(std::string("/sensors/") + group + number + "/" + last);
  }
  return topics;
}

/// A table that cannot be written is refused before the run, whose result would be lost.
void checkWritable(const ParamReader& reader, const std::string& table_file) {
  if (table_file.empty()) return;
  try {
    const report::TextFile probe(table_file);
  } catch (const report::OutputError& problem) {
    throw reader.error("table_file", "expected a file that can be written, got \"" + table_file + "\" (" +
                                         problem.what() +
                                         "): name a folder that is there, with its full path");
  }
}

TrackEvaluatorParams loadAll(const ParamReader& reader) {
  TrackEvaluatorParams params = loadTrackEvaluatorParams(reader);
  reader.finish();
  checkWritable(reader, params.table_file);
  return params;
}

bool haveSeveralTargets(const std::vector<core::TargetRow>& rows) {
  return std::any_of(rows.begin(), rows.end(),
                     [&rows](const core::TargetRow& row) { return row.target != rows.front().target; });
}

}  // namespace

TrackEvaluatorParams::TrackEvaluatorParams()
    : sighting_topics(ofSixSensors("sightings")), track_topics(ofSixSensors("tracks")) {
  for (const char* group : {"/groups/acquisition", "/groups/tracking", "/sensor_fusion", "/fusion"}) {
    track_topics.push_back(std::string(group) + "/tracks");
  }
}

TrackEvaluatorParams loadTrackEvaluatorParams(const ParamReader& reader) {
  TrackEvaluatorParams params;
  params.evaluation = loadEvaluationParams(reader, params.evaluation);
  params.frames = loadFrameChangeParams(reader, params.frames);
  params.frames.attitude = loadAttitudeParams(reader, params.frames.attitude);
  params.sighting_topics = reader.texts("sighting_topics", params.sighting_topics);
  params.track_topics = reader.texts("track_topics", params.track_topics);
  params.position_topics = reader.texts("position_topics", params.position_topics);
  const ParamReader positions = reader.sub("positions");
  params.positions.gospa_cutoff =
      positions.number("gospa_cutoff", params.positions.gospa_cutoff, above(0.0), "m");
  params.positions.match_sigmas =
      positions.number("match_sigmas", params.positions.match_sigmas, atLeast(0.0));
  params.positions.settle = params.evaluation.settle_time;
  params.live = reader.flag("live", params.live);
  params.duration = reader.number("duration", params.duration, atLeast(0.0), "s");
  params.table_file = reader.text("table_file", params.table_file);
  return params;
}

TrackEvaluatorNode::TrackEvaluatorNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh)
    : nh_(nh),
      guard_(nameOfNode(pnh)),
      params_(loadAll(ParamReader(pnh))),
      evaluation_(params_.evaluation),
      position_scores_(params_.positions, params_.evaluation.truth_gap) {
  publisher_ = nh_.advertise<sightline::Evaluation>("/evaluation", 10, true);
  transform_subscriber_.emplace(nh_, transforms_, guard_("/tf", [this] { releaseScans(); }));
  subscribe();
  release_timer_ =
      nh_.createWallTimer(ros::WallDuration(kSecondsBetweenReleases),
                          guard_("a timer", [this](const ros::WallTimerEvent&) { releaseScans(); }));
  second_timer_ =
      nh_.createWallTimer(ros::WallDuration(kSecondsBetweenReports),
                          guard_("a timer", [this](const ros::WallTimerEvent&) { everySecond(); }));
  diagnostics_.emplace(nh, pnh, "evaluation", [this](auto& status, double) { diagnose(status); });
}

TrackEvaluatorNode::~TrackEvaluatorNode() {
  printTable();
}

void TrackEvaluatorNode::subscribe() {
  const auto promptly = ros::TransportHints().tcpNoDelay();
  for (const std::string& name : params_.sighting_topics) {
    const std::string topic = nh_.resolveName(name);
    evaluation_.expectSightings(topic);
    frame_changes_.try_emplace(topic, params_.frames, transforms_);
    const boost::function<void(const sightline::SightingArray::ConstPtr&)> take =
        guard_(topic, [this, topic](const sightline::SightingArray::ConstPtr& scan) { onScan(topic, scan); });
    subscribers_.push_back(
        nh_.subscribe<sightline::SightingArray>(name, kQueue, take, ros::VoidConstPtr(), promptly));
  }
  for (const std::string& name : params_.track_topics) {
    const std::string topic = nh_.resolveName(name);
    evaluation_.expectTracks(topic);
    const boost::function<void(const sightline::TrackArray::ConstPtr&)> take = guard_(
        topic, [this, topic](const sightline::TrackArray::ConstPtr& tracks) { onTracks(topic, *tracks); });
    subscribers_.push_back(
        nh_.subscribe<sightline::TrackArray>(name, kQueue, take, ros::VoidConstPtr(), promptly));
  }
  for (const std::string& name : params_.position_topics) {
    const std::string topic = nh_.resolveName(name);
    const boost::function<void(const sightline::PositionTrackArray::ConstPtr&)> take =
        guard_(topic, [this, topic](const sightline::PositionTrackArray::ConstPtr& positions) {
          onPositions(topic, *positions);
        });
    subscribers_.push_back(
        nh_.subscribe<sightline::PositionTrackArray>(name, kQueue, take, ros::VoidConstPtr(), promptly));
  }
  const boost::function<void(const sightline::PositionTrackArray::ConstPtr&)> take_positions =
      guard_(kPositionTruthTopic,
             [this](const sightline::PositionTrackArray::ConstPtr& truth) { onPositionTruth(*truth); });
  subscribers_.push_back(nh_.subscribe<sightline::PositionTrackArray>(
      kPositionTruthTopic, kQueue, take_positions, ros::VoidConstPtr(), promptly));
  const boost::function<void(const sightline::TrackArray::ConstPtr&)> take =
      guard_("/truth", [this](const sightline::TrackArray::ConstPtr& truth) { onTruth(*truth); });
  subscribers_.push_back(
      nh_.subscribe<sightline::TrackArray>("/truth", kQueue, take, ros::VoidConstPtr(), promptly));
}

void TrackEvaluatorNode::onTruth(const sightline::TrackArray& truth) {
  if (!isInTrackingFrame("/truth", truth.header.frame_id)) return;
  evaluation_.addTruth(toCore(truth.header.stamp), motionsOf(truth));
  endAfterDuration(truth_span_, toCore(truth.header.stamp));
}

void TrackEvaluatorNode::onScan(const std::string& topic, const sightline::SightingArray::ConstPtr& scan) {
  frame_changes_.at(topic).add(scan, clockNow());
  releaseScans();
}

void TrackEvaluatorNode::onTracks(const std::string& topic, const sightline::TrackArray& tracks) {
  if (!isInTrackingFrame(topic, tracks.header.frame_id)) return;
  evaluation_.addTracks(topic, reportOf(tracks));
  if (!truth_span_) endAfterDuration(track_span_, toCore(tracks.header.stamp));
}

void TrackEvaluatorNode::onPositionTruth(const sightline::PositionTrackArray& truth) {
  position_frame_ = truth.header.frame_id;
  const core::PositionTrackArray positions = toCore(truth);
  for (const core::PositionTrack& track : positions.tracks)
    position_scores_.addTruth(positions.time, std::to_string(track.id), track.position);
}

void TrackEvaluatorNode::onPositions(const std::string& topic,
                                     const sightline::PositionTrackArray& positions) {
  if (!position_frame_.empty() && positions.header.frame_id != position_frame_) {
    drop(topic, {"another frame", "it is in frame \"" + positions.header.frame_id +
                                      "\" and the true positions in \"" + position_frame_ +
                                      "\": give the position tracker that one as tracking_frame"});
    return;
  }
  const core::PositionTrackArray tracks = toCore(positions);
  if (!position_scores_.addTracks(topic, tracks.time, estimatesOf(tracks)))
    drop(topic, {"late", "it is older than positions that are already scored"});
}

void TrackEvaluatorNode::releaseScans() {
  for (auto& [topic, frame_change] : frame_changes_) {
    for (FramedScan& framed : frame_change.release(clockNow())) {
      if (!framed.refusal) {
        evaluation_.addScan(topic, std::move(framed.scan));
      } else {
        drop(topic, *framed.refusal);
      }
    }
  }
}

bool TrackEvaluatorNode::isInTrackingFrame(const std::string& topic, const std::string& frame) {
  if (frame == params_.frames.tracking_frame) return true;
  drop(topic,
       {"another frame", "it is in frame \"" + frame + "\" and not in tracking_frame \"" +
                             params_.frames.tracking_frame + "\": give trackers and evaluator the same one"});
  return false;
}

void TrackEvaluatorNode::drop(const std::string& topic, const core::Refusal& refusal) {
  ++dropped_[topic + ": " + refusal.kind];
  ROS_WARN_STREAM_THROTTLE(kSecondsBetweenNotes,
                           "a message on " << topic << " is not evaluated: " << refusal.detail);
}

void TrackEvaluatorNode::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  status.summary(diagnostic_msgs::DiagnosticStatus::OK, report::readable(elapsed()) + " s evaluated");
  for (const auto& [reason, count] : dropped_) status.add("messages dropped, " + reason, count);
  guard_.diagnose(status);
}

void TrackEvaluatorNode::endAfterDuration(std::optional<Span>& span, core::Time stamp) {
  if (!span) span = Span{stamp, stamp};
  span->last = std::max(span->last, stamp);
  const bool is_over = params_.duration > 0.0 && core::seconds(span->last - span->first) >= params_.duration;
  if (!is_over || end_timer_) return;
  end_timer_ = nh_.createWallTimer(
      ros::WallDuration(kSecondsForTheLast), [](const ros::WallTimerEvent&) { ros::requestShutdown(); },
      true);
}

bool TrackEvaluatorNode::hasDirections() const {
  return !params_.sighting_topics.empty() || !params_.track_topics.empty();
}

double TrackEvaluatorNode::elapsed() const {
  const std::optional<Span>& span = truth_span_ ? truth_span_ : track_span_;
  return span ? core::seconds(span->last - span->first) : 0.0;
}

void TrackEvaluatorNode::everySecond() {
  sightline::Evaluation message = toMessage(evaluation_);
  message.header.frame_id = params_.frames.tracking_frame;
  publisher_.publish(message);
  if (params_.live) printLive();
}

void TrackEvaluatorNode::printLive() {
  const std::string summary =
      (hasDirections() ? report::liveSummary(evaluation_.rows(), evaluation_.bestSigma(), elapsed())
                       : report::readable(elapsed()) + " s\n") +
      report::positionSummary(position_scores_.rows());
  if (isatty(STDOUT_FILENO) != 0) {
    if (live_lines_ > 0) std::cout << "\033[" << live_lines_ << "A\033[J";  // over the last one
    live_lines_ = static_cast<int>(std::count(summary.begin(), summary.end(), '\n'));
  }
  std::cout << summary << std::flush;
}

std::string TrackEvaluatorNode::table() {
  const std::vector<core::EvaluationRow> rows = evaluation_.rows();
  const std::vector<core::TargetRow> targets = evaluation_.targetRows();
  report::EvaluationTableStyle style;
  style.gospa = haveSeveralTargets(targets);
  std::ostringstream table;
  table << "\nEvaluation of " << report::readable(elapsed()) << " s\n";
  if (hasDirections())
    table << report::evaluationTable(rows, evaluation_.bestSigma(), style) << report::livesTable(rows)
          << (style.gospa ? report::targetTable(targets) : "");
  table << report::positionTable(position_scores_.rows());
  for (const auto& [reason, count] : dropped_)
    table << "dropped " << count << " messages on " << reason << "\n";
  return table.str();
}

void TrackEvaluatorNode::printTable() {
  const std::string text = table();
  if (!params_.table_file.empty()) {
    try {
      report::TextFile file(params_.table_file);
      file.stream() << text;
      return file.finish();
    } catch (const report::OutputError& problem) {
      std::cerr << problem.what() << ": the table comes here instead\n";
    }
  }
  std::cout << text << std::flush;
}

}  // namespace sightline_ros
