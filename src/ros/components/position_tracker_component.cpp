#include "sightline/ros/components/position_tracker_component.h"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <sstream>

#include <tf2/exceptions.h>

#include "sightline/core/fusion/track_alignment.h"
#include "sightline/core/model/name.h"
#include "sightline/ros/components/component_params.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/messages/position_messages.h"
#include "sightline/ros/messages/station_pose.h"
#include "sightline/ros/messages/tracklet_messages.h"
#include "sightline/ros/params/position_tracker_params.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

constexpr int kMostLateInARow = 50;   // messages of tracks, before time counts as gone back
constexpr double kTopicMemory = 2.0;  // a tracker that was silent for so long may report on another topic [s]
const char* const kDefaultMetricFrame = "world";

FrameChangeParams loadFrames(const ParamReader& reader) {
  FrameChangeParams defaults;
  defaults.tracking_frame = kDefaultMetricFrame;
  return loadFrameChangeParams(reader, defaults);
}

core::Refusal aboutTrack(const core::Refusal& why, const std::string& tracker, std::uint32_t id) {
  return {why.kind, "track " + std::to_string(id) + " of \"" + tracker + "\": " + why.detail};
}

}  // namespace

PositionTrackerComponent::PositionTrackerComponent(const ParamReader& reader, const std::string& name,
                                                   const tf2::BufferCore& transforms)
    : name_(trackerNameFrom(reader, name)),
      frames_(loadFrames(reader)),
      views_(reader),
      max_trackers_(reader.integer("max_trackers", 128, 1, 1000000)),
      max_sensors_(reader.integer("max_sensors", 512, 1, 1000000)),
      params_(loadPositionTrackerParams(reader)),
      transforms_(transforms),
      tracker_(core::PositionTracker(params_), handle, sizeOf) {}

std::vector<PositionResult> PositionTrackerComponent::onTracks(const sightline::TrackArray::ConstPtr& local,
                                                               const std::string& topic, core::Time now) {
  return add(local, topic, now);
}

std::vector<PositionResult> PositionTrackerComponent::onTracklets(
    const sightline::TrackletArray::ConstPtr& local, const std::string& topic, core::Time now) {
  return add(local, topic, now);
}

std::vector<PositionResult> PositionTrackerComponent::add(Message message, const std::string& topic,
                                                          core::Time now) {
  if (auto refusal = refusalOf(message, topic, now)) {
    std::vector<PositionResult> results = onTransforms(now);
    results.push_back(resultOf(message, topic));
    results.back().refusals.push_back(std::move(*refusal));
    return results;
  }
  std::deque<Waiting>& of_frame = waiting_[headerOf(message).frame_id];
  of_frame.push_back({std::move(message), topic, now});
  ++waiting_count_;
  return onTransforms(now);
}

std::vector<PositionResult> PositionTrackerComponent::onTransforms(core::Time now) {
  std::vector<PositionResult> results;
  for (auto it = waiting_.begin(); it != waiting_.end();) {
    releaseFirst(it->second, now, results);
    it = it->second.empty() ? waiting_.erase(it) : std::next(it);
  }
  while (waiting_count_ > static_cast<std::size_t>(frames_.max_waiting)) results.push_back(dropOldest());
  return results;
}

/// The messages at the head of a frame's queue that have their transform, or have waited long enough.
void PositionTrackerComponent::releaseFirst(std::deque<Waiting>& messages, core::Time now,
                                            std::vector<PositionResult>& results) {
  while (!messages.empty()) {
    Waiting& first = messages.front();
    const std_msgs::Header& header = headerOf(first.message);
    // Simulated time starts late, or goes back: the wait then counts from now.
    if (first.since == core::Time{} || first.since > now) first.since = now;
    const double waited = core::seconds(now - first.since);
    const bool is_known = isPoseKnown(header.frame_id, header.stamp, trackingFrame(), transforms_);
    const bool is_overdue = waited >= frames_.tf_timeout;
    if (is_known &&
        (is_overdue || views_.areSettled(trackerOf(first.message), header, trackingFrame(), transforms_))) {
      results.push_back(track(first.message, first.topic));
    } else if (is_overdue) {
      results.push_back(resultOf(first.message, first.topic));
      results.back().refusals.push_back(withoutTransform(header, waited));
    } else {
      return;
    }
    messages.pop_front();
    --waiting_count_;
  }
}

/// The message that has waited longest makes room.
PositionResult PositionTrackerComponent::dropOldest() {
  const auto oldest = std::min_element(waiting_.begin(), waiting_.end(), [](const auto& a, const auto& b) {
    return a.second.front().since < b.second.front().since;
  });
  const Waiting& first = oldest->second.front();
  PositionResult result = resultOf(first.message, first.topic);
  result.refusals.push_back({"too many waiting", "more than max_waiting " +
                                                     std::to_string(frames_.max_waiting) +
                                                     " messages wait for their transforms"});
  oldest->second.pop_front();
  if (oldest->second.empty()) waiting_.erase(oldest);
  --waiting_count_;
  return result;
}

core::Refusal PositionTrackerComponent::withoutTransform(const std_msgs::Header& header,
                                                         double waited) const {
  std::string why;
  transforms_.canTransform(trackingFrame(), header.frame_id, header.stamp, &why);
  std::ostringstream detail;
  detail << "no transform from " << header.frame_id << " to " << trackingFrame() << " came within " << waited
         << " s (tf_timeout " << frames_.tf_timeout << " s)";
  if (!why.empty()) detail << ": " << why;
  detail << " (publish where the station stands, translation and rotation, on /tf or /tf_static, or correct "
            "the local tracker's tracking_frame or this tracking_frame)";
  return {"no transform", detail.str()};
}

std::optional<core::Refusal> PositionTrackerComponent::refusalOf(const Message& message,
                                                                 const std::string& topic,
                                                                 core::Time now) const {
  const std::string& tracker = trackerOf(message);
  const std_msgs::Header& header = headerOf(message);
  const core::Time stamp = sightline_ros::toCore(header.stamp);
  if (tracker.empty()) return core::invalid("the tracker is not named; set its tracker_name");
  if (auto refusal = core::whyTooLong("the tracker's name", tracker)) return refusal;
  if (auto refusal = core::whyTooLong("header.frame_id", header.frame_id)) return refusal;
  if (header.frame_id.empty()) {
    return core::invalid("what comes from \"" + tracker +
                         "\" names no frame; set its tracking_frame to the "
                         "frame of its station");
  }
  std::ostringstream why;
  const double ahead = core::seconds(stamp - now);
  if (now != core::Time{} && ahead > frames_.max_future) {
    why << "the stamp of \"" << tracker << "\" is " << ahead << " s ahead of the clock (max_future "
        << frames_.max_future << " s); are the computers' clocks synchronised?";
    return core::Refusal{"future", why.str()};
  }
  const Origins& origins = message.index() == 0 ? track_origins_ : tracklet_origins_;
  const auto origin = origins.find(tracker);
  if (origin == origins.end()) {
    if (origins.size() < static_cast<std::size_t>(max_trackers_)) return std::nullopt;
    why << "\"" << tracker << "\" is one more than max_trackers " << max_trackers_;
    return core::Refusal{"limit", why.str()};
  }
  if (origin->second.topic != topic && core::seconds(stamp - origin->second.newest) <= kTopicMemory) {
    why << "\"" << tracker << "\" on " << topic << " reports on " << origin->second.topic
        << " already; give each tracker a tracker_name of its own";
    return core::Refusal{"name", why.str()};
  }
  return std::nullopt;
}

PositionResult PositionTrackerComponent::track(const Message& message, const std::string& topic) {
  PositionResult result = resultOf(message, topic);
  try {
    if (const auto* tracks = std::get_if<sightline::TrackArray::ConstPtr>(&message))
      takeTracks(**tracks, result);
    else
      takeTracklets(*std::get<sightline::TrackletArray::ConstPtr>(message), result);
  } catch (const tf2::TransformException& problem) {
    result.refusals.push_back({"no transform", problem.what()});
    return result;
  }
  Origins& origins = result.is_tracks ? track_origins_ : tracklet_origins_;
  origins[result.tracker] = {topic, result.stamp};
  return result;
}

void PositionTrackerComponent::takeTracks(const sightline::TrackArray& local, PositionResult& result) {
  core::StationTracks tracks;
  tracks.tracker = local.tracker;
  tracks.time = result.stamp;
  tracks.pose = poseOf(local.header.frame_id, local.header.stamp, trackingFrame(), transforms_);
  for (const sightline::Track& row : local.tracks) {
    core::Track track = sightline_ros::toCore(row);
    track.sources.clear();  // not used, and however long they are
    if (const auto why = core::rejectionOf(track.state)) {
      if (track.status == core::TrackStatus::tentative) continue;  // it says nothing yet
      result.refusals.push_back(aboutTrack(*why, local.tracker, row.id));
      continue;
    }
    tracks.tracks.push_back(std::move(track));
  }
  StationViews::Found seen = views_.at(local.tracker, local.header, trackingFrame(), transforms_);
  tracks.views = std::move(seen.views);
  for (core::Refusal& why : seen.refusals) result.refusals.push_back(std::move(why));
  stations_[local.tracker] = tracks.pose.origin;
  result.used = tracks.tracks.size();
  auto answer = take(tracks, result);
  const bool is_late = answer && !answer->refusals.empty() && answer->refusals.front().kind == "late";
  late_in_a_row_ = is_late ? late_in_a_row_ + 1 : 0;
  if (late_in_a_row_ >= kMostLateInARow) {
    std::ostringstream notice;
    notice << "the tracks of all stations have come more than max_lag " << maxLag() << " s late, "
           << late_in_a_row_ << " messages in a row: their time went back; forgets all positions";
    result.notice = notice.str();
    reset();
    answer = take(std::move(tracks), result);
  }
  if (!answer) return;
  result.refusals.insert(result.refusals.end(), answer->refusals.begin(), answer->refusals.end());
  if (!answer->refusals.empty()) {
    result.used = 0;
  } else if (answer->output) {
    publish(*answer->output, result);
    result.taken = numbered(std::move(answer->taken));
  }
}

void PositionTrackerComponent::takeTracklets(const sightline::TrackletArray& local, PositionResult& result) {
  ReadTracklets read = readTracklets(local);
  if (read.refusal) result.refusals.push_back(*read.refusal);
  std::vector<core::StationTracklet> tracklets;
  for (core::TrackTracklet& row : read.report.tracklets) {
    const std::pair<std::string, std::string> sensor(local.tracker, row.tracklet.sensor);
    if (sensors_.size() >= static_cast<std::size_t>(max_sensors_) && sensors_.count(sensor) == 0) {
      result.refusals.push_back({"limit", "sensor \"" + sensor.second + "\" of \"" + sensor.first +
                                              "\" is one more than max_sensors " +
                                              std::to_string(max_sensors_)});
      continue;
    }
    core::StationTracklet tracklet;
    try {
      tracklet.pose = poseOf(local.header.frame_id, toRos(row.tracklet.time), trackingFrame(), transforms_);
    } catch (const tf2::TransformException& problem) {
      result.refusals.push_back({"no transform", problem.what()});
      continue;
    }
    sensors_.insert(sensor);
    tracklet.tracker = local.tracker;
    tracklet.track = row.track;
    tracklet.tracklet = std::move(row.tracklet);
    tracklets.push_back(std::move(tracklet));
  }
  const std::size_t offered = tracklets.size();
  const auto answer = take(std::move(tracklets), result);
  if (!answer) return;
  result.used = offered - answer->refusals.size();
  result.refusals.insert(result.refusals.end(), answer->refusals.begin(), answer->refusals.end());
}

/// nullopt when the tracker failed. What fails at every message for long will not mend itself.
std::optional<PositionTrackerComponent::Answer> PositionTrackerComponent::take(Input input,
                                                                               PositionResult& result) {
  auto answer = tracker_.take(std::move(input));
  if (answer) return answer;
  std::string detail = "the position tracker could not take what came from \"" + result.tracker + "\" (" +
                       tracker_.failure() + ") and goes on from before it; please report this";
  if (tracker_.failuresInARow() % kMostFailuresInARow == 0) {
    detail +=
        "; all positions are given up after " + std::to_string(kMostFailuresInARow) + " failures in a row";
    reset();
  }
  result.used = 0;
  result.refusals.push_back({"failed", detail});
  return std::nullopt;
}

void PositionTrackerComponent::publish(const core::PositionOutput& output, PositionResult& result) {
  core::PositionOutput numbered = output;
  for (core::PositionTrack& track : numbered.tracks.tracks) {
    track.id += id_offset_;
    highest_id_ = std::max(highest_id_, track.id);
  }
  result.tracks =
      boost::make_shared<sightline::PositionTrackArray>(toMessage(numbered.tracks, name_, trackingFrame()));
  result.report = boost::make_shared<sightline::PositionReport>(toMessage(numbered, trackingFrame()));
  result.poses = boost::make_shared<geometry_msgs::PoseArray>(posesOf(*result.tracks));
}

PositionTrackerComponent::Answer PositionTrackerComponent::handle(core::PositionTracker& tracker,
                                                                  const Input& input) {
  if (const auto* tracklets = std::get_if<std::vector<core::StationTracklet>>(&input))
    return {tracker.onTracklets(*tracklets), std::nullopt, {}};
  if (auto refusal = tracker.onTracks(std::get<core::StationTracks>(input)))
    return {{std::move(*refusal)}, std::nullopt, {}};
  Answer answer{{}, tracker.report(), {}};
  answer.taken = tracker.handOut();
  return answer;
}

void PositionTrackerComponent::keepMeasurements() {
  keeps_measurements_ = true;
  tracker_.change([](core::PositionTracker& tracker) { tracker.keepMeasurements(); });
}

std::vector<core::TakenMeasurement> PositionTrackerComponent::openMeasurements() {
  std::vector<core::TakenMeasurement> taken;
  tracker_.change([&taken](core::PositionTracker& tracker) { taken = tracker.handOut(true); });
  return numbered(std::move(taken));
}

/// With the ids that are published.
std::vector<core::TakenMeasurement> PositionTrackerComponent::numbered(
    std::vector<core::TakenMeasurement> taken) const {
  for (core::TakenMeasurement& one : taken) one.target += id_offset_;
  return taken;
}

std::size_t PositionTrackerComponent::sizeOf(const Input& input) {
  if (const auto* tracks = std::get_if<core::StationTracks>(&input)) return tracks->tracks.size();
  return std::get<std::vector<core::StationTracklet>>(input).size();
}

const std_msgs::Header& PositionTrackerComponent::headerOf(const Message& message) {
  return std::visit([](const auto& it) -> const std_msgs::Header& { return it->header; }, message);
}

const std::string& PositionTrackerComponent::trackerOf(const Message& message) {
  return std::visit([](const auto& it) -> const std::string& { return it->tracker; }, message);
}

PositionResult PositionTrackerComponent::resultOf(const Message& message, const std::string& topic) {
  PositionResult result;
  result.topic = topic;
  result.tracker = trackerOf(message);
  result.is_tracks = message.index() == 0;
  result.stamp = sightline_ros::toCore(headerOf(message).stamp);
  return result;
}

std::optional<double> PositionTrackerComponent::onSimulatedTime(core::Time now) {
  const std::optional<double> back = clock_.stepBack(now, maxLag());
  if (!back) return std::nullopt;
  reset();
  waiting_.clear();
  waiting_count_ = 0;
  return back;
}

void PositionTrackerComponent::reset() {
  tracker_.change([this](core::PositionTracker& tracker) {
    tracker = core::PositionTracker(params_);
    if (keeps_measurements_) tracker.keepMeasurements();
  });
  id_offset_ = highest_id_;
  track_origins_.clear();
  tracklet_origins_.clear();
  sensors_.clear();
  stations_.clear();
  late_in_a_row_ = 0;
}

}  // namespace sightline_ros
