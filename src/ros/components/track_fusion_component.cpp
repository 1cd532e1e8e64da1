#include "sightline/ros/components/track_fusion_component.h"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>
#include <utility>

#include "sightline/core/model/name.h"
#include "sightline/report/sensor_text.h"
#include "sightline/ros/components/component_params.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/messages/tracklet_messages.h"
#include "sightline/ros/params/track_fusion_params.h"

namespace sightline_ros {

namespace core = sightline::core;
using sightline::report::clockTextOf;
using sightline::report::textOf;

namespace {

constexpr double kDefaultMaxFuture = 0.1;     // [s]
constexpr double kDefaultMaxBaseline = 10.0;  // [m]
const char* const kDefaultTrackingFrame = "platform_enu";

sightline::SourceTrack toMessage(const core::SourceTrack& row) {
  sightline::SourceTrack message;
  message.tracker = row.tracker;
  message.id = row.id;
  message.weight = row.weight;
  message.distance_squared = row.distance_squared;
  message.age = row.age;
  if (row.reason) message.reason = core::textOf(*row.reason);
  return message;
}

std::vector<sightline::SourceTrack> toMessages(const std::vector<core::SourceTrack>& rows) {
  std::vector<sightline::SourceTrack> messages;
  messages.reserve(rows.size());
  for (const core::SourceTrack& row : rows) messages.push_back(toMessage(row));
  return messages;
}

std::string nameOf(core::SensorVerdict verdict) {
  switch (verdict) {
    case core::SensorVerdict::healthy:
      return "healthy";
    case core::SensorVerdict::noisy:
      return "noisy";
    case core::SensorVerdict::biased:
      return "biased";
  }
  return "";
}

sightline::SensorHealth toMessage(const core::HealthChange& change, bool undecided) {
  sightline::SensorHealth message;
  message.verdict = nameOf(change.verdict);
  message.undecided = undecided;
  message.since = toRos(change.began);
  message.clock_behind = std::numeric_limits<double>::quiet_NaN();
  message.noticed = toRos(change.time);
  for (Eigen::Index channel = 0; channel < std::min<Eigen::Index>(2, change.bias.size()); ++channel)
    message.bias[static_cast<std::size_t>(channel)] = change.bias(channel);
  return message;
}

sightline::SensorHealth toMessage(const core::WatchedSensor& watched) {
  sightline::SensorHealth message;
  if (watched.last) message = toMessage(*watched.last, watched.undecided);
  message.sensor = watched.sensor;
  message.verdict = nameOf(watched.verdict);
  message.noise_scale = watched.is_excluded ? std::numeric_limits<double>::infinity() : watched.noise_scale;
  message.reason = textOf(watched);
  message.clock_behind = std::numeric_limits<double>::quiet_NaN();
  if (!watched.clock) return message;
  message.clock_behind = watched.clock->behind;
  message.reason += "; " + clockTextOf(watched);
  return message;
}

sightline::SensorHealth toMessage(const core::SensorChange& said) {
  sightline::SensorHealth message = toMessage(said.change, said.undecided);
  message.sensor = said.sensor;
  message.noise_scale = said.change.verdict == core::SensorVerdict::noisy ? said.change.scale : 1.0;
  if (said.change.verdict == core::SensorVerdict::biased)
    message.noise_scale = std::numeric_limits<double>::infinity();
  if (said.undecided) message.noise_scale = 1.0;
  message.reason = textOf(said);
  return message;
}

std::vector<std::string> sensorsOf(const sightline::TrackArray& local) {
  std::set<std::string> sensors;
  for (const sightline::Track& track : local.tracks)
    sensors.insert(track.sources.begin(), track.sources.end());
  return {sensors.begin(), sensors.end()};
}

std::vector<std::string> sensorsOf(const sightline::TrackletArray& local) {
  std::set<std::string> sensors;
  for (const sightline::Tracklet& tracklet : local.tracklets) sensors.insert(tracklet.sensor);
  return {sensors.begin(), sensors.end()};
}

/// Of the elevations of a report's tracks [rad]; 0 without tracks.
double smallestSigma(const sightline::TrackArray& local) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const sightline::Track& track : local.tracks)
    if (track.covariance[5] > 0.0) smallest = std::min(smallest, std::sqrt(track.covariance[5]));
  return std::isfinite(smallest) ? smallest : 0.0;
}

core::LocalReport localReportOf(const sightline::TrackArray& message) {
  core::LocalReport report{message.tracker, toCore(message.header.stamp), {}};
  report.tracks.reserve(message.tracks.size());
  for (const sightline::Track& track : message.tracks) report.tracks.push_back(toCore(track));
  return report;
}

}  // namespace

TrackFusionComponent::TrackFusionComponent(const ParamReader& reader, const std::string& name,
                                           const tf2::BufferCore* transforms)
    : name_(trackerNameFrom(reader, name)),
      tracking_frame_(reader.text("tracking_frame", kDefaultTrackingFrame)),
      max_future_(reader.number("max_future", kDefaultMaxFuture, atLeast(0.0), "s")),
      params_(loadTrackFusionParams(reader)),
      fusion_(core::TrackFusion(params_), handle, sizeOf),
      latest_(std::make_shared<core::FusionReport>()) {
  const double max_baseline = reader.number("max_baseline", kDefaultMaxBaseline, atLeast(0.0), "m");
  const ParamReader frames = reader.sub("sensor_frames");
  if (transforms != nullptr) places_.emplace(max_baseline, *transforms);
  for (const std::string& sensor : frames.keys()) {
    const std::string frame = frames.requiredText(sensor);
    if (places_) places_->setFrame(sensor, frame);
  }
  if (tracking_frame_.empty()) throw reader.error("tracking_frame", "expected the name of a frame, got \"\"");
}

FusionResult TrackFusionComponent::onTracks(const sightline::TrackArray& local, const std::string& topic,
                                            core::Time now) {
  if (const auto refusal = refusalOf(local.tracker, local.header, topic, origins_, now))
    return refused(local, *refusal);
  if (places_) {
    if (const auto apart = places_->take(local.tracker, sensorsOf(local), smallestSigma(local)))
      return refused(local, *apart);
  }
  const auto arrival = now == core::Time{} ? std::nullopt : std::make_optional(now);
  auto answer = fusion_.take(Arrival{localReportOf(local), arrival});
  if (!answer) return refused(local, failed(local.tracker));

  const auto* refusal = std::get_if<std::optional<core::Refusal>>(&*answer);
  if (refusal != nullptr && *refusal) return refused(local, **refusal);
  note(local.tracker, local.header, topic, origins_);
  if (refusal != nullptr) return {};  // it waits
  return fused(std::move(std::get<core::FusionReport>(*answer)));
}

std::optional<FusionResult> TrackFusionComponent::fuseWaiting() {
  if (!isWaiting()) return std::nullopt;
  auto answer = fusion_.take(EndOfWait{});
  if (!answer) {
    FusionResult result;
    result.refusal = failed("those that waited");
    return result;
  }
  return fused(std::move(std::get<core::FusionReport>(*answer)));
}

FusionResult TrackFusionComponent::fused(core::FusionReport&& report) {
  FusionResult result;
  result.fused = std::make_shared<core::FusionReport>(std::move(report));
  result.report = fusionReport(*result.fused);
  result.tracks = trackArray(*result.fused);
  latest_ = result.fused;
  return result;
}

std::optional<core::Refusal> TrackFusionComponent::onTracklets(const sightline::TrackletArray& local,
                                                               const std::string& topic, core::Time now) {
  if (auto refusal = refusalOf(local.tracker, local.header, topic, tracklet_origins_, now)) return refusal;
  if (places_) {
    if (auto apart = places_->take(local.tracker, sensorsOf(local), 0.0)) return apart;
  }
  ReadTracklets read = readTracklets(local);
  const auto answer = fusion_.take(std::move(read.report));
  if (!answer) return failed(local.tracker);
  if (const auto& refusal = std::get<std::optional<core::Refusal>>(*answer)) return refusal;
  note(local.tracker, local.header, topic, tracklet_origins_);
  return read.refusal;
}

TrackFusionComponent::Answer TrackFusionComponent::handle(core::TrackFusion& fusion, const Input& input) {
  if (const auto* tracklets = std::get_if<core::TrackletReport>(&input))
    return fusion.onTracklets(*tracklets);
  if (const auto* tracks = std::get_if<Arrival>(&input)) {
    auto refusal = fusion.take(tracks->report, tracks->time);
    if (refusal || !fusion.isDue()) return refusal;
  }
  return fusion.fuse();
}

std::size_t TrackFusionComponent::sizeOf(const Input& input) {
  if (const auto* tracks = std::get_if<Arrival>(&input)) return tracks->report.tracks.size();
  const auto* tracklets = std::get_if<core::TrackletReport>(&input);
  return tracklets == nullptr ? 0 : tracklets->tracklets.size();
}

/// The last message failed, of that tracker. What fails at every message for long will not mend itself.
core::Refusal TrackFusionComponent::failed(const std::string& tracker) {
  std::string detail = "the fusion could not take what came from \"" + tracker + "\" (" + fusion_.failure() +
                       ") and goes on from before it; please report this";
  if (fusion_.failuresInARow() % kMostFailuresInARow == 0) {
    detail += "; all tracks are given up after " + std::to_string(kMostFailuresInARow) + " failures in a row";
    reset();
  }
  return {"failed", detail};
}

bool TrackFusionComponent::wantsTracklets() const {
  return core::usesTracklets(params_.rule);
}

std::optional<core::Refusal> TrackFusionComponent::reconfigure(const ParamReader& reader) {
  const core::TrackFusionParams wanted = loadTrackFusionParams(reader);
  std::optional<core::Refusal> refusal;
  fusion_.change([&](core::TrackFusion& fusion) { refusal = fusion.reconfigure(wanted); });
  if (!refusal) params_ = wanted;
  return refusal;
}

std::optional<double> TrackFusionComponent::onSimulatedTime(core::Time now) {
  const std::optional<double> back = clock_.stepBack(now, maxLag());
  if (back) reset();
  return back;
}

void TrackFusionComponent::reset() {
  fusion_.change([](core::TrackFusion& fusion) { fusion.reset(); });
  origins_.clear();
  tracklet_origins_.clear();
  latest_ = std::make_shared<core::FusionReport>();
}

std::optional<core::Refusal> TrackFusionComponent::refusalOf(const std::string& tracker,
                                                             const std_msgs::Header& header,
                                                             const std::string& topic, const Origins& origins,
                                                             core::Time now) const {
  std::ostringstream why;
  const core::Time stamp = toCore(header.stamp);
  const double ahead = core::seconds(stamp - now);
  if (auto refusal = core::whyTooLong("the tracker's name", tracker)) return refusal;
  if (tracker == name_) {
    why << "\"" << name_ << "\" is this fusion itself; it must not be fed with its own";
    return core::Refusal{"feedback", why.str()};
  }
  if (header.frame_id != tracking_frame_) {
    why << "what comes from \"" << tracker << "\" are in \"" << core::readableName(header.frame_id)
        << "\", not in \"" << tracking_frame_
        << "\" (tracking_frame); directions from another origin cannot be fused: use position_tracker for "
           "stations "
           "that stand apart";
    return core::Refusal{"frame", why.str()};
  }
  if (now != core::Time{} && ahead > max_future_) {
    why << "the stamp of \"" << tracker << "\" is " << ahead << " s ahead of the clock (max_future "
        << max_future_ << " s); are the computers' clocks synchronised?";
    return core::Refusal{"future", why.str()};
  }
  const auto origin = origins.find(tracker);
  if (origin != origins.end() && origin->second.topic != topic &&
      core::seconds(stamp - origin->second.newest) <= params_.reports.max_age) {
    why << "\"" << tracker << "\" on " << topic << " reports on " << origin->second.topic
        << " already; give each tracker a tracker_name of its own";
    return core::Refusal{"name", why.str()};
  }
  return std::nullopt;
}

/// Remembers where a tracker reports.
void TrackFusionComponent::note(const std::string& tracker, const std_msgs::Header& header,
                                const std::string& topic, Origins& origins) const {
  origins[tracker] = {topic, toCore(header.stamp)};
  while (origins.size() > static_cast<std::size_t>(params_.reports.max_trackers))
    origins.erase(origins.begin()->first == tracker ? std::next(origins.begin()) : origins.begin());
}

FusionResult TrackFusionComponent::refused(const sightline::TrackArray& local,
                                           const core::Refusal& why) const {
  FusionResult result;
  result.fused = std::make_shared<core::FusionReport>(core::describeRefused(
      *latest_, localReportOf(local), why, static_cast<std::size_t>(params_.reports.max_tracks)));
  result.report = fusionReport(*result.fused);
  if (latest_->time == core::Time{}) result.report->header.stamp = local.header.stamp;  // nothing before it
  result.refusal = why;
  return result;
}

sightline::TrackArray::Ptr TrackFusionComponent::trackArray(const core::FusionReport& fused) const {
  auto message = boost::make_shared<sightline::TrackArray>();
  message->header.stamp = toRos(fused.time);
  message->header.frame_id = tracking_frame_;
  message->tracker = name_;
  message->estimator = nameOf(params_.rule);
  message->tracks.reserve(fused.tracks.size());
  for (const core::FusedTrack& track : fused.tracks)
    message->tracks.push_back(sightline_ros::toMessage(track.track));
  return message;
}

sightline::FusionReport::Ptr TrackFusionComponent::fusionReport(const core::FusionReport& fused) const {
  auto message = boost::make_shared<sightline::FusionReport>();
  message->header.stamp = toRos(fused.time);
  message->header.frame_id = tracking_frame_;
  message->tracks.reserve(fused.tracks.size());
  for (const core::FusedTrack& track : fused.tracks) {
    sightline::FusedTrack row;
    row.id = track.track.id;
    row.rule = nameOf(track.rule);
    if (track.why_not_tracklets) row.why_not_tracklets = track.why_not_tracklets->detail;
    row.sources = toMessages(track.sources);
    row.left_out = toMessages(track.left_out);
    for (const core::WatchedSensor& watched : track.sensors) row.sensors.push_back(toMessage(watched));
    for (const core::SensorChange& said : track.sensor_changes) row.sensor_changes.push_back(toMessage(said));
    message->tracks.push_back(row);
  }
  message->left_out = toMessages(fused.left_out);
  return message;
}

}  // namespace sightline_ros
