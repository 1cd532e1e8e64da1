#include "sightline/ros/display/display_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sightline/core/model/sphere.h"
#include "sightline/ros/display/display_tracks.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {
namespace {

namespace core = sightline::core;

constexpr double kTentativeOpacity = 0.25;
constexpr double kGateOpacity = 0.035;
constexpr double kViewTolerance = 1.0;  // from the view's axis before it is turned [rad]
constexpr double kClockStep = 1.0;      // backwards, from which a recording starts anew [s]
constexpr double kLookedAtRadius = 3.0 * core::kDegree;
constexpr double kMainShell = 0.99;  // in front of all else; share of the radius
constexpr double kOutlineStep = 4.0 * core::kDegree;
constexpr std::size_t kTrailPieces = 640;  // of all trails together: rviz takes time for each piece of a line
constexpr std::size_t kFewestTrailPieces = 32;  // of one of them
constexpr std::size_t kMaxSensors = 64;         // at once; of others nothing is kept
constexpr const char* kMagnifierChannel = "magnifier";

/// By the newest sample and those before it, evenly thinned out where there are many `trails`.
Directions trailOf(const std::deque<core::TruthSample>& path, std::size_t trails) {
  const std::size_t pieces = std::max(kFewestTrailPieces, kTrailPieces / std::max<std::size_t>(trails, 1));
  const std::size_t every = (path.size() + pieces - 1) / pieces;
  Directions line;
  for (std::size_t back = 0; back < path.size(); back += every)
    line.push_back(core::directionOf(path[path.size() - 1 - back].motion.head<2>()));
  std::reverse(line.begin(), line.end());
  return line;
}

bool isAnythingIn(const MarkerArray& array) {
  return std::any_of(array.markers.begin(), array.markers.end(),
                     [](const Marker& marker) { return marker.action == Marker::ADD; });
}

}  // namespace

DisplayScene::DisplayScene(const DisplayParams& params, const SensorColours& colours)
    : params_(params), colours_(colours), truth_(params.history) {}

void DisplayScene::addScan(const core::Scan& scan, double now) {
  restartWhenBack(now);
  if (sensors_.size() >= kMaxSensors && sensors_.count(scan.sensor) == 0) return;
  sensors_[scan.sensor].add(scan, now);
}

void DisplayScene::addTracks(const std::string& channel, const sightline::TrackArray& tracks, double now) {
  restartWhenBack(now);
  trackers_.try_emplace(channel, params_.history).first->second.add(tracks, now);
}

void DisplayScene::addAssociations(const std::string& channel, const sightline::AssociationArray& decisions) {
  trackers_.try_emplace(channel, params_.history).first->second.add(decisions);
}

void DisplayScene::addTruth(const sightline::TrackArray& truth, double now) {
  restartWhenBack(now);
  truth_.add(truth, now);
}

void DisplayScene::restartWhenBack(double now) {
  if (now < newest_ - kClockStep) {
    sensors_.clear();
    trackers_.clear();
    truth_.clear();
    label_sides_.clear();
    view_.reset();
  }
  newest_ = now;
}

bool DisplayScene::isLookedAt(const std::string& channel, std::uint32_t track) const {
  return looked_at_ && looked_at_->track == track && looked_at_->channel == channel;
}

bool DisplayScene::isHidden(const std::string& channel, std::uint32_t track) const {
  return looked_at_ && looked_at_->alone && !isLookedAt(channel, track);
}

bool DisplayScene::isHidden(const SightingMemory::Seen& sighting) const {
  if (!looked_at_ || !looked_at_->alone) return false;
  const sightline::Track* track = trackLookedAt();
  return track == nullptr || !isNearGate(track->gate, sighting.direction);
}

/// Gates of tentative tracks may be as wide as the sky, and there are many.
bool DisplayScene::hasGate(const std::string& channel, const sightline::Track& track) const {
  return isEstablished(track) || params_.tentative_gates || isLookedAt(channel, track.id);
}

/// nullptr when it is not there at present.
const sightline::Track* DisplayScene::trackLookedAt() const {
  const auto tracker = looked_at_ ? trackers_.find(looked_at_->channel) : trackers_.end();
  if (tracker == trackers_.end()) return nullptr;
  const auto& tracks = tracker->second.newest().tracks;
  const auto track = std::find_if(tracks.begin(), tracks.end(),
                                  [this](const auto& one) { return one.id == looked_at_->track; });
  return track != tracks.end() ? &*track : nullptr;
}

bool DisplayScene::isPresent(const TrackMemory& memory, double now) const {
  return !memory.newest().tracks.empty() && now - memory.arrival() <= params_.silence;
}

std::map<std::string, MarkerArray> DisplayScene::draw(double now) {
  restartWhenBack(now);
  aimView();
  Sheets sheets;
  for (auto& [sensor, sightings] : sensors_) {
    sightings.forgetBefore(now - params_.sighting_time);
    drawSightings(sheets[sensor], sensor, now);
  }
  forgetSilentSensors();
  for (auto& [channel, tracker] : trackers_) {
    if (!isPresent(tracker, now)) tracker.clear();
    if (channel == kMainChannel) {
      drawMainTracks(sheets[channel], now);
      drawLabels(sheets[channel]);
    } else {
      drawLocalTracks(sheets[channel], channel, now);
    }
  }
  if (!isPresent(truth_, now)) truth_.clear();
  drawTruth(sheets[kTruthChannel]);
  drawMagnified(sheets[kMagnifierChannel], now);
  dropWhatStaysEmpty(sheets);
  return sheets;
}

void DisplayScene::forgetSilentSensors() {
  for (auto sensor = sensors_.begin(); sensor != sensors_.end();) {
    sensor = sensor->second.seen().empty() ? sensors_.erase(sensor) : std::next(sensor);
  }
}

void DisplayScene::dropWhatStaysEmpty(Sheets& sheets) {
  std::set<std::string> full;
  for (auto sheet = sheets.begin(); sheet != sheets.end();) {
    const bool is_full = isAnythingIn(sheet->second);
    if (is_full) full.insert(sheet->first);
    sheet = is_full || full_.count(sheet->first) > 0 ? std::next(sheet) : sheets.erase(sheet);
  }
  full_ = std::move(full);
}

Colour DisplayScene::colourOf(const std::string& sensor, const SightingMemory::Seen& seen, double now) const {
  const double freshness = std::clamp(1.0 - (now - seen.arrival) / params_.sighting_time, 0.0, 1.0);
  return withAlpha(colours_.of(sensor), 0.1 + 0.8 * freshness);
}

void DisplayScene::drawSightings(MarkerArray& array, const std::string& sensor, double now) const {
  Marker dots = dotSheet(params_.canvas, "sightings", 0.8 * core::kDegree);
  for (const SightingMemory::Seen& seen : sensors_.at(sensor).seen()) {
    if (isHidden(seen)) continue;
    drawDot(dots, params_.canvas, seen.direction, colourOf(sensor, seen, now));
  }
  array.markers.push_back(finished(std::move(dots)));
}

void DisplayScene::drawLocalTracks(MarkerArray& array, const std::string& channel, double now) const {
  const TrackMemory& tracker = trackers_.at(channel);
  const Colour colour = colours_.of(channel);
  Marker dots = dotSheet(params_.canvas, "tracks", 0.9 * core::kDegree);
  Marker ellipses = lineSheet(params_.canvas, "2-sigma ellipses", 0.2 * core::kDegree);
  Marker sources = lineSheet(params_.canvas, "sources", 0.1 * core::kDegree);
  for (const sightline::Track& track : tracker.newest().tracks) {
    if (isHidden(channel, track.id)) continue;
    const core::AngularState state = toCore(track).state;
    drawDot(dots, params_.canvas, core::directionOf(state.angles()),
            withAlpha(colour, isEstablished(track) ? 1.0 : kTentativeOpacity));
    if (!isEstablished(track)) continue;
    drawUncertainty(ellipses, params_.canvas, state, dimmed(colour, 0.65));
    if (track.sources.size() > 1) drawSources(sources, track, now);
  }
  for (Marker* sheet : {&dots, &ellipses, &sources}) array.markers.push_back(finished(std::move(*sheet)));
  drawGates(array, channel);
  drawLookedAt(array, channel);
}

/// A circle round the track that a person looks at.
void DisplayScene::drawLookedAt(MarkerArray& array, const std::string& channel) const {
  Marker circle = lineSheet(params_.canvas, "selected", 0.25 * core::kDegree);
  const sightline::Track* track = looked_at_ && looked_at_->channel == channel ? trackLookedAt() : nullptr;
  if (track != nullptr) {
    drawLine(circle, params_.canvas, circleOutline({track->azimuth, track->elevation}, kLookedAtRadius),
             mainColour());
  }
  array.markers.push_back(finished(std::move(circle)));
}

void DisplayScene::drawGates(MarkerArray& array, const std::string& channel) const {
  const TrackMemory& tracker = trackers_.at(channel);
  static const std::array<std::pair<GateOutcome, const char*>, 4> kOutcomes = {
      {{GateOutcome::accepted, "gates: accepted (green)"},
       {GateOutcome::nothing_seen, "gates: nothing seen (grey)"},
       {GateOutcome::claimed_by_other, "gates: claimed by other (red)"},
       {GateOutcome::tentative, "gates: tentative (yellow)"}}};
  for (const auto& [outcome, name] : kOutcomes) {
    Marker patches = patchSheet(params_.canvas, name);
    Marker rims = lineSheet(params_.canvas, name, 0.1 * core::kDegree);
    rims.id = 1;
    for (const sightline::Track& track : tracker.newest().tracks) {
      if (isHidden(channel, track.id) || !hasGate(channel, track)) continue;
      if (outcomeOf(track, tracker.wasClaimed(track.id)) != outcome) continue;
      const auto rectangle = rectangleOf(track.gate);
      if (!rectangle) continue;
      const Colour colour = sightline_ros::colourOf(outcome);
      drawPatch(patches, params_.canvas, *rectangle, withAlpha(colour, kGateOpacity));
      drawLine(rims, params_.canvas, rectangleOutline(*rectangle, kOutlineStep), dimmed(colour, 0.5));
    }
    array.markers.push_back(finished(std::move(patches)));
    array.markers.push_back(finished(std::move(rims)));
  }
}

void DisplayScene::drawMainTracks(MarkerArray& array, double now) const {
  Canvas canvas = params_.canvas;
  canvas.radius *= kMainShell;
  const TrackMemory& tracker = trackers_.at(kMainChannel);
  Marker dots = dotSheet(canvas, "tracks", 1.2 * core::kDegree);
  Marker ellipses = lineSheet(canvas, "2-sigma ellipses", 0.45 * core::kDegree);
  Marker trails = lineSheet(canvas, "histories", 0.4 * core::kDegree);
  Marker predictions = lineSheet(canvas, "predictions", 0.15 * core::kDegree);
  Marker sources = lineSheet(canvas, "sources", 0.2 * core::kDegree);
  const std::size_t trails_drawn = establishedIn(tracker.newest());
  for (const sightline::Track& track : tracker.newest().tracks) {
    if (isHidden(kMainChannel, track.id)) continue;
    const core::AngularState state = toCore(track).state;
    const Colour colour = dimmed(mainColour(), track.status == sightline::Track::CONFIRMED ? 1.0 : 0.5);
    drawDot(dots, canvas, core::directionOf(state.angles()), colour);
    if (!isEstablished(track)) continue;
    drawUncertainty(ellipses, canvas, state, colour);
    drawFadingLine(trails, canvas, trailOf(tracker.pathOf(track.id), trails_drawn), dimmed(colour, 0.8));
    drawPrediction(predictions, canvas, state, params_.prediction, dimmed(colour, 0.8));
    drawSources(sources, track, now);
  }
  for (Marker* sheet : {&dots, &ellipses, &trails, &predictions, &sources}) {
    array.markers.push_back(finished(std::move(*sheet)));
  }
  drawGates(array, kMainChannel);
  drawLookedAt(array, kMainChannel);
}

void DisplayScene::drawSources(Marker& lines, const sightline::Track& track, double now) const {
  const Eigen::Vector3d place = core::directionOf({track.azimuth, track.elevation});
  for (const std::string& source : track.sources) {
    const auto direction = directionOfSource(source, track, now);
    if (!direction) continue;
    drawLine(lines, params_.canvas, {place, *direction}, colours_.of(source));
  }
}

std::optional<Eigen::Vector3d> DisplayScene::directionOfSource(const std::string& source,
                                                               const sightline::Track& of, double now) const {
  const auto tracker = trackers_.find(source);
  if (tracker != trackers_.end() && isPresent(tracker->second, now)) {
    const sightline::Track* track = nearestTo({of.azimuth, of.elevation}, tracker->second.newest());
    return core::directionOf({track->azimuth, track->elevation});
  }
  const auto sensor = sensors_.find(source);
  if (sensor == sensors_.end()) return std::nullopt;
  const auto& seen = sensor->second.seen();
  const auto own = std::find_if(seen.rbegin(), seen.rend(), [&of](const SightingMemory::Seen& sighting) {
    return isNearGate(of.gate, sighting.direction);
  });
  return own == seen.rend() ? std::nullopt : std::optional<Eigen::Vector3d>(own->direction);
}

std::string DisplayScene::errorText(const sightline::Track& track) const {
  const TrackMemory& tracker = trackers_.at(kMainChannel);
  const core::Time common = toCore(std::min(tracker.newest().header.stamp, truth_.newest().header.stamp));
  const auto estimated = tracker.anglesAt(track.id, common);
  if (!estimated) return "";
  double error = std::numeric_limits<double>::infinity();
  for (const sightline::Track& target : truth_.newest().tracks) {
    const auto truth = truth_.anglesAt(target.id, common);
    if (!truth) continue;
    error = std::min(error, core::angleBetween(core::directionOf(*estimated), core::directionOf(*truth)));
  }
  return std::isfinite(error) ? "\nerror " + readableAngle(error, sigmaOf(track)) : "";
}

void DisplayScene::drawTruth(MarkerArray& array) const {
  Marker paths = lineSheet(params_.canvas, "paths", 0.12 * core::kDegree);
  Marker targets = lineSheet(params_.canvas, "targets", 0.3 * core::kDegree);
  const std::size_t trails = truth_.newest().tracks.size();
  for (const sightline::Track& target : truth_.newest().tracks) {
    drawFadingLine(paths, params_.canvas, trailOf(truth_.pathOf(target.id), trails), truthColour());
    drawCross(targets, params_.canvas, {target.azimuth, target.elevation}, 4.0 * core::kDegree,
              truthColour());
  }
  for (Marker* sheet : {&paths, &targets}) array.markers.push_back(finished(std::move(*sheet)));
}

void DisplayScene::aimView() {
  const auto direction = attention();
  if (!direction) return;
  const Eigen::Vector2d target = core::anglesOf(*direction);
  if (!view_) view_ = {target.x(), 0.0};
  const Eigen::Vector2d from_target = tangentTo(target, core::directionOf(*view_));
  const double distance = from_target.norm();
  if (distance > kViewTolerance) {
    view_ = core::anglesOf(walk(target, kViewTolerance / distance * from_target));
  }
}

std::optional<Eigen::Vector3d> DisplayScene::attention() const {
  if (const sightline::Track* track = leadingTrack()) {
    return core::directionOf({track->azimuth, track->elevation});
  }
  const SightingMemory::Seen* latest = nullptr;
  for (const auto& [sensor, memory] : sensors_) {
    if (memory.seen().empty()) continue;
    const SightingMemory::Seen& seen = memory.seen().back();
    if (latest == nullptr || seen.arrival > latest->arrival) latest = &seen;
  }
  if (latest == nullptr) return std::nullopt;
  return latest->direction;
}

const sightline::Track* DisplayScene::leadingTrack() const {
  const auto main = trackers_.find(kMainChannel);
  if (main == trackers_.end()) return nullptr;
  if (looked_at_ && looked_at_->channel == kMainChannel && trackLookedAt() != nullptr) return trackLookedAt();
  const auto& tracks = main->second.newest().tracks;
  const auto track = std::find_if(tracks.begin(), tracks.end(), isEstablished);
  return track != tracks.end() ? &*track : nullptr;
}

}  // namespace sightline_ros
