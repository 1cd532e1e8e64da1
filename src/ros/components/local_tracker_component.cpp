#include "sightline/ros/components/local_tracker_component.h"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <utility>

#include "sightline/ros/components/component_params.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/messages/tracklet_messages.h"
#include "sightline/ros/params/tracker_params.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

core::StampWatchParams stampWatchParams(double max_lag) {
  core::StampWatchParams params;
  params.max_lag = max_lag;
  return params;
}

/// One entry for each sighting of a scan that was not used at all.
std::vector<core::Association> allRejected(std::size_t count, const std::string& reason) {
  std::vector<core::Association> associations(count);
  for (std::size_t i = 0; i < count; ++i) {
    associations[i].sighting = static_cast<std::uint32_t>(i);
    associations[i].decision = core::Decision::rejected_input;
    associations[i].reason = reason;
  }
  return associations;
}

bool isRejected(const core::Association& association) {
  return association.decision == core::Decision::rejected_input;
}

sightline::AssociationArray::Ptr associationArray(const std::vector<core::Association>& associations,
                                                  const sightline::SightingArray& scan,
                                                  const std::string& frame) {
  auto message = boost::make_shared<sightline::AssociationArray>();
  message->header = scan.header;
  message->header.frame_id = frame;
  message->sensor = scan.sensor;
  message->associations.reserve(associations.size());
  for (const auto& association : associations) message->associations.push_back(toMessage(association));
  return message;
}

}  // namespace

LocalTrackerComponent::LocalTrackerComponent(const ParamReader& reader, const std::string& name,
                                             const tf2::BufferCore& transforms)
    : LocalTrackerComponent(loadLocalTrackerParams(reader), loadTrackletParams(reader.sub("tracklets")),
                            loadTrackerFrameParams(reader), trackerNameFrom(reader, name),
                            reader.number("smoothing_lag", 0.0, atLeast(0.0), "s"), transforms) {}

LocalTrackerComponent::LocalTrackerComponent(const core::LocalTrackerParams& tracker,
                                             const core::TrackletParams& tracklets,
                                             const FrameChangeParams& frames, std::string name,
                                             double smoothing_lag, const tf2::BufferCore& transforms)
    : name_(std::move(name)),
      estimator_(nameOf(tracker.estimator.kind)),
      estimator_params_(tracker.estimator),
      max_lag_(tracker.max_lag),
      smoothing_lag_(smoothing_lag),
      frames_(frames, transforms),
      stamps_(stampWatchParams(tracker.max_lag)),
      tracking_(
          Tracking{core::LocalTracker(tracker),
                   tracklets.enabled ? std::make_optional<core::TrackletBuilder>(tracklets) : std::nullopt,
                   false},
          handle, sizeOf) {}

std::vector<TrackerReport> LocalTrackerComponent::onScan(const sightline::SightingArray::ConstPtr& scan,
                                                         core::Time now) {
  frames_.add(scan, now);
  return onTransforms(now);
}

std::vector<TrackerReport> LocalTrackerComponent::onTransforms(core::Time now) {
  std::vector<TrackerReport> reports;
  for (FramedScan& framed : frames_.release(now)) {
    if (!framed.refusal)
      admit(std::move(framed), now, reports);
    else
      reports.push_back(refuse(framed, *framed.refusal, framed.refusal->detail));
  }
  return reports;
}

/// Tracks a scan, and those that it releases, unless its stamp jumps.
void LocalTrackerComponent::admit(FramedScan framed, core::Time now, std::vector<TrackerReport>& reports) {
  const core::Time stamp = framed.scan.time;
  const std::string sensor = framed.scan.sensor;
  const auto clock = now == core::Time{} ? std::nullopt : std::make_optional(now);
  auto admitted = stamps_.take(sensor, stamp, std::move(framed), clock);
  if (admitted.went_back) startTrackerAnew(stamp);
  std::string notice;
  for (const std::string& words : admitted.notices) notice += (notice.empty() ? "" : "; ") + words;
  for (auto& passed : admitted.passed) {
    reports.push_back(passed.refusal ? refuse(passed.item, *passed.refusal, textOf(*passed.refusal))
                                     : track(passed.item));
    reports.back().notice = std::exchange(notice, "");
    reports.back().went_back = std::exchange(admitted.went_back, std::nullopt).has_value();
  }
}

void LocalTrackerComponent::keepSightings() {
  tracking_.change([](Tracking& tracking) { tracking.keeps_sightings = true; });
}

void LocalTrackerComponent::startAnew(core::Time time) {
  stamps_ = core::StampGate<FramedScan>(stampWatchParams(max_lag_));
  startTrackerAnew(time);
}

void LocalTrackerComponent::startTrackerAnew(core::Time time) {
  tracking_.change([time](Tracking& tracking) { tracking.tracker.startAnew(time); });
}

std::optional<core::Refusal> LocalTrackerComponent::reconfigure(const ParamReader& reader) {
  const core::LocalTrackerParams wanted = loadLocalTrackerParams(reader);
  std::optional<core::Refusal> refusal;
  tracking_.change([&](Tracking& tracking) { refusal = tracking.tracker.reconfigure(wanted); });
  return refusal;
}

sightline::TrackletArray::Ptr LocalTrackerComponent::overdueTracklets(core::Time now) {
  if (!tracking_.state().tracklets) return nullptr;
  core::TrackletBuilder tracklets = *tracking_.state().tracklets;  // as a question changes nothing
  if (!tracklets.onTime(now)) return nullptr;
  auto answer = tracking_.take(now);
  return answer ? trackletArray(std::move(answer->tracklets)) : nullptr;
}

LocalTrackerComponent::Answer LocalTrackerComponent::handle(Tracking& tracking, const Input& input) {
  if (const auto* now = std::get_if<core::Time>(&input)) return {{}, tracking.tracklets->onTime(*now), {}};
  const core::Scan& scan = std::get<core::Scan>(input);
  Answer answer{tracking.tracker.onScan(scan), std::nullopt, {}};
  if (tracking.keeps_sightings) answer.sightings = core::sightingsTaken(scan, answer.report);
  if (tracking.tracklets) answer.tracklets = tracking.tracklets->onScan(scan, answer.report);
  return answer;
}

std::size_t LocalTrackerComponent::sizeOf(const Input& input) {
  const auto* scan = std::get_if<core::Scan>(&input);
  return scan != nullptr ? scan->sightings.size() : 0;
}

TrackerReport LocalTrackerComponent::track(FramedScan& framed) {
  TrackerReport report;
  auto answer = tracking_.take(std::move(framed.scan));
  if (!answer) {
    const core::Refusal refusal = failed(*framed.message);
    return refuse(framed, refusal, core::textOf(refusal));
  }
  core::ScanReport& tracked = answer->report;
  report.refusal = tracked.refusal;
  report.changes = std::move(tracked.changes);
  report.sightings = std::move(answer->sightings);
  report.noise_scale = tracked.use.noise_scale;
  if (!tracked.refusal) report.tracks = trackArray(tracked);
  report.tracklets = trackletArray(std::move(answer->tracklets));
  return withAssociations(std::move(report), framed, std::move(tracked.associations));
}

/// The last scan failed. What fails at every scan for long will not mend itself.
core::Refusal LocalTrackerComponent::failed(const sightline::SightingArray& scan) {
  std::string detail = "the tracker could not take a scan of \"" + scan.sensor + "\" (" +
                       tracking_.failure() + ") and goes on from before it; please report this";
  if (tracking_.failuresInARow() % kMostFailuresInARow == 0) {
    detail += "; all tracks are given up after " + std::to_string(kMostFailuresInARow) + " failures in a row";
    startTrackerAnew(toCore(scan.header.stamp));
  }
  return {"failed", detail};
}

/// A scan that did not come to the tracker. `reason`: published for each of its sightings.
TrackerReport LocalTrackerComponent::refuse(FramedScan& framed, core::Refusal refusal,
                                            const std::string& reason) const {
  TrackerReport report;
  report.refusal = std::move(refusal);
  return withAssociations(std::move(report), framed, allRejected(framed.message->sightings.size(), reason));
}

TrackerReport LocalTrackerComponent::withAssociations(TrackerReport report, FramedScan& framed,
                                                      std::vector<core::Association> associations) const {
  for (auto& [index, reason] : framed.rejections) associations[index].reason = std::move(reason);
  report.scan = framed.message;
  report.rejected =
      static_cast<std::size_t>(std::count_if(associations.begin(), associations.end(), isRejected));
  report.associations = associationArray(associations, *framed.message, trackingFrame());
  return report;
}

sightline::TrackletArray::Ptr LocalTrackerComponent::trackletArray(
    std::optional<core::TrackletReport> report) const {
  if (!report) return nullptr;
  report->tracker = name_;
  return boost::make_shared<sightline::TrackletArray>(toMessage(*report, trackingFrame()));
}

sightline::TrackArray::Ptr LocalTrackerComponent::trackArray(const core::ScanReport& report) const {
  auto message = boost::make_shared<sightline::TrackArray>();
  message->header.stamp = toRos(report.time);
  message->header.frame_id = trackingFrame();
  message->tracker = name_;
  message->estimator = estimator_;
  message->tracks.reserve(report.tracks.size());
  for (const auto& track : report.tracks) message->tracks.push_back(toMessage(track));
  return message;
}

}  // namespace sightline_ros
