#include "sightline/ros/display/position_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include <Eigen/Eigenvalues>

#include "sightline/core/model/sphere.h"
#include "sightline/ros/display/markers.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/messages/position_messages.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

constexpr double kPictureClockStep = 1.0;  // [s] back that means a new start
constexpr std::size_t kMostSeen = 4000;    // sightings
constexpr std::size_t kMostTracks = 200;   // of one tracker, positions, or truth
constexpr std::size_t kMostDrawnTrackers = 200;
constexpr std::size_t kMostSamples = 400;           // of one trail
constexpr std::size_t kMostRefused = 100;           // crossings that are drawn
constexpr std::size_t kMostFullPositionLabels = 5;  // positions; of more, only the number is written
constexpr double kFreeRay = 1.6;  // length of a ray without a position, as a share of the size
constexpr double kEllipsoidSigmas = 2.0;

bool isFinite(const Eigen::Vector3d& place) {
  return place.allFinite() && place.cwiseAbs().maxCoeff() < 1e9;
}

double sigmaOf(const core::PositionTrack& track) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(track.covariance.topLeftCorner<3, 3>(),
                                                              Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(solver.eigenvalues().maxCoeff(), 0.0));
}

Colour colourOfRefusal(const std::string& kind) {
  if (kind == "ghost") return colourOf(GateOutcome::claimed_by_other);
  if (kind == "ambiguous") return colourOf(GateOutcome::tentative);
  return colourOf(GateOutcome::nothing_seen);
}

}  // namespace

PositionPicture::PositionPicture(const PositionPictureParams& params, const SensorColours& colours)
    : params_(params), colours_(colours) {}

void PositionPicture::addSightings(const std::string& sensor, const Eigen::Vector3d& origin,
                                   const std::vector<Eigen::Vector3d>& directions, double now) {
  restartWhenBack(now);
  const double length = kViewLength * size();
  for (const Eigen::Vector3d& direction : directions) {
    if (!isFinite(origin) || !direction.allFinite()) continue;
    seen_.push_back({origin + length * direction, sensor, now});
    if (seen_.size() > kMostSeen) seen_.pop_front();
  }
}

void PositionPicture::addTracks(const sightline::TrackArray& tracks, const core::StationPose& pose,
                                double now) {
  restartWhenBack(now);
  if (trackers_.count(tracks.tracker) == 0 && trackers_.size() >= kMostDrawnTrackers) return;
  if (!isFinite(pose.origin)) return;
  Station& station = trackers_[tracks.tracker];
  station.origin = pose.origin;
  if (places_.count(tracks.tracker) > 0 || places_.size() < kMostDrawnTrackers)
    places_[tracks.tracker] = pose.origin;
  station.arrival = now;
  station.rays.clear();
  for (const sightline::Track& track : tracks.tracks) {
    if (station.rays.size() >= kMostTracks) break;
    if (!std::isfinite(track.azimuth) || !std::isfinite(track.elevation)) continue;
    station.rays.push_back({track.id, track.status != sightline::Track::TENTATIVE,
                            pose.R_metric_station * core::directionOf({track.azimuth, track.elevation})});
  }
}

void PositionPicture::addPositions(const sightline::PositionTrackArray& positions, double now) {
  restartWhenBack(now);
  positions_.add(positions, params_.history, now);
}

void PositionPicture::addReport(const sightline::PositionReport& report, double now) {
  restartWhenBack(now);
  report_ = report;
  report_arrival_ = now;
}

void PositionPicture::addTruth(const sightline::PositionTrackArray& truth, double now) {
  restartWhenBack(now);
  truth_.add(truth, params_.history, now);
}

void PositionPicture::Reported::add(const sightline::PositionTrackArray& report, double history, double now) {
  const double stamp = report.header.stamp.toSec();
  if (stamp < newest.header.stamp.toSec()) trails.clear();
  newest = report;
  arrival = now;
  auto& tracks = newest.tracks;
  tracks.erase(std::remove_if(tracks.begin(), tracks.end(),
                              [](const sightline::PositionTrack& track) {
                                const core::PositionTrack t = toCore(track);
                                return !isFinite(t.position) || !isFinite(t.velocity) ||
                                       !t.covariance.allFinite();
                              }),
               tracks.end());
  if (tracks.size() > kMostTracks) tracks.resize(kMostTracks);
  std::map<std::uint32_t, Trail> going_on;
  for (const sightline::PositionTrack& track : tracks) {
    Trail trail = std::move(trails[track.id]);
    // More reports than can be told apart are thinned out: the newest sample moves on.
    const bool is_near = trail.samples.size() > 1 && stamp - trail.samples[trail.samples.size() - 2].first <
                                                         history / static_cast<double>(kMostSamples);
    if (is_near) trail.samples.pop_back();
    trail.samples.emplace_back(stamp, toCore(track).position);
    while (stamp - trail.samples.front().first > history || trail.samples.size() > kMostSamples)
      trail.samples.pop_front();
    going_on[track.id] = std::move(trail);
  }
  trails = std::move(going_on);
}

void PositionPicture::Reported::clear() {
  newest.tracks.clear();
  trails.clear();
}

std::vector<Eigen::Vector3d> PositionPicture::Reported::pathOf(std::uint32_t id) const {
  std::vector<Eigen::Vector3d> path;
  const auto trail = trails.find(id);
  if (trail == trails.end()) return path;
  for (const auto& [stamp, place] : trail->second.samples) path.push_back(place);
  return path;
}

void PositionPicture::restartWhenBack(double now) {
  if (now < newest_ - kPictureClockStep) {
    seen_.clear();
    trackers_.clear();
    positions_.clear();
    truth_.clear();
    report_.reset();
    enlargement_ = 0.0;
  }
  newest_ = now;
}

void PositionPicture::forget(double now) {
  while (!seen_.empty() && now - seen_.front().arrival > params_.sighting_time) seen_.pop_front();
  for (auto tracker = trackers_.begin(); tracker != trackers_.end();)
    tracker = now - tracker->second.arrival > params_.silence ? trackers_.erase(tracker) : std::next(tracker);
  for (Reported* reported : {&positions_, &truth_})
    if (now - reported->arrival > params_.silence) reported->clear();
  if (now - report_arrival_ > params_.silence) report_.reset();
}

/// Those whose fields of view are known; in a recording, which tells none, those of the local trackers.
std::map<std::string, Eigen::Vector3d> PositionPicture::places() const {
  if (stations_.empty()) return places_;
  std::map<std::string, Eigen::Vector3d> places;
  for (const StationView& station : stations_) places[station.sensor] = station.origin;
  return places;
}

double PositionPicture::size() const {
  if (params_.size > 0.0) return params_.size;
  double size = 1.0;
  const auto all = places();
  for (const auto& [name, a] : all)
    for (const auto& [other, b] : all) size = std::max(size, (a - b).norm());
  return size;
}

Eigen::Vector3d PositionPicture::middle() const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const auto all = places();
  for (const auto& [name, place] : all) sum += place;
  if (!all.empty()) sum /= static_cast<double>(all.size());
  return sum;
}

MetricCanvas PositionPicture::canvas() const {
  return {params_.frame, size(), params_.lifetime};
}

std::map<std::string, MarkerArray> PositionPicture::draw(double now) {
  restartWhenBack(now);
  forget(now);
  std::map<std::string, MarkerArray> sheets;
  drawStations(sheets[kStations], now);
  drawRays(sheets[kRays]);
  drawPositions(sheets[kPositions]);
  drawRefused(sheets[kRefused]);
  drawTruth(sheets[kTruth]);
  return sheets;
}

void PositionPicture::drawStations(MarkerArray& array, double now) const {
  const MetricCanvas c = canvas();
  Marker places = metricDots(c, "places", 0.025);
  Marker views = metricLines(c, "fields of view", 0.0025);
  Marker faces = metricFaces(c, "fields of view");
  faces.id = 1;
  Marker sightings = metricDots(c, "sightings", 0.008);
  int id = 0;
  for (const StationView& station : stations_)
    drawFieldOfView(views, faces, c, station, colours_.of(station.sensor));
  for (const auto& [name, place] : this->places()) {
    drawPoint(places, place, colours_.of(name));
    const Eigen::Vector3d below = place - 0.04 * c.size * Eigen::Vector3d::UnitZ();
    array.markers.push_back(metricText(c, "names", id++, below, name, 0.032, colours_.of(name)));
  }
  for (const Seen& seen : seen_) {
    const double freshness = std::clamp(1.0 - (now - seen.arrival) / params_.sighting_time, 0.0, 1.0);
    drawPoint(sightings, seen.place, withAlpha(colours_.of(seen.sensor), 0.2 + 0.8 * freshness));
  }
  id = 0;
  for (const core::Obstacle& obstacle : obstacles_)
    array.markers.push_back(
        boxMarker(c, "obstacles", id++, obstacle.low, obstacle.high, withAlpha(gridColour(), 0.6)));
  for (Marker* sheet : {&places, &views, &faces, &sightings})
    array.markers.push_back(finished(std::move(*sheet)));
}

/// The rays of tracks that support a position end there, the others go on.
void PositionPicture::drawRays(MarkerArray& array) const {
  const MetricCanvas c = canvas();
  std::map<std::string, Eigen::Vector3d> supported;  // where the local track's position is
  for (const sightline::PositionTrack& track : positions_.newest.tracks)
    for (const std::string& source : track.sources) supported[source] = toCore(track).position;
  Marker used = metricLines(c, "of positions", 0.0018);
  Marker free = metricLines(c, "without a position", 0.0012);
  for (const auto& [tracker, station] : trackers_) {
    const Colour colour = colours_.of(tracker);
    for (const Ray& ray : station.rays) {
      if (!ray.is_established) continue;
      const auto position = supported.find(tracker + "/" + std::to_string(ray.id));
      const bool is_used = position != supported.end();
      const double length = is_used ? (position->second - station.origin).norm() : kFreeRay * c.size;
      drawSegment(is_used ? used : free, station.origin, station.origin + length * ray.direction,
                  dimmed(colour, is_used ? 0.75 : 0.35));
    }
  }
  for (Marker* sheet : {&used, &free}) array.markers.push_back(finished(std::move(*sheet)));
}

void PositionPicture::drawPositions(MarkerArray& array) {
  const MetricCanvas c = canvas();
  Marker dots = metricDots(c, "positions", 0.012);
  Marker trails = metricLines(c, "histories", 0.004);
  Marker feet = metricLines(c, "height", 0.0008);
  std::vector<double> sigmas;
  for (const sightline::PositionTrack& message : positions_.newest.tracks)
    if (message.status == sightline::PositionTrack::CONFIRMED) sigmas.push_back(sigmaOf(toCore(message)));
  if (!sigmas.empty()) {
    std::nth_element(sigmas.begin(), sigmas.begin() + static_cast<long>(sigmas.size() / 2), sigmas.end());
    enlargement_ = enlargementFor(kEllipsoidSigmas * sigmas[sigmas.size() / 2], c.size, enlargement_);
  }
  const double ground = middle().z();
  const bool is_crowd = positions_.newest.tracks.size() > kMostFullPositionLabels;
  for (const sightline::PositionTrack& message : positions_.newest.tracks) {
    const core::PositionTrack track = toCore(message);
    const bool is_confirmed = track.status == core::TrackStatus::confirmed;
    const Colour colour = dimmed(mainColour(), is_confirmed ? 1.0 : 0.5);
    const int id = static_cast<int>(track.id);
    drawPoint(dots, track.position, colour);
    if (track.status == core::TrackStatus::tentative) continue;
    array.markers.push_back(ellipsoidMarker(
        c, "ellipsoids", id, track.position, track.covariance.topLeftCorner<3, 3>(),
        kEllipsoidSigmas * std::max(enlargement_, 1.0), withAlpha(colourOf(GateOutcome::accepted), 0.45)));
    array.markers.push_back(
        arrowMarker(c, "velocities", id, track.position, params_.prediction * track.velocity, colour));
    drawFadingPath(trails, positions_.pathOf(track.id), colour);
    Eigen::Vector3d foot = track.position;
    foot.z() = ground;
    drawSegment(feet, track.position, foot, dimmed(colour, 0.35));
    const Eigen::Vector3d above = track.position + 0.045 * c.size * Eigen::Vector3d::UnitZ();
    array.markers.push_back(metricText(
        c, "labels", id, above, is_crowd ? std::to_string(track.id) : labelOf(message), 0.026, mainColour()));
  }
  if (enlargement_ > 1.0 && !positions_.newest.tracks.empty()) {
    char text[64];
    std::snprintf(text, sizeof(text), "ellipsoids: 2 sigma x %.0f", enlargement_);
    const Eigen::Vector3d below = middle() - 0.62 * c.size * Eigen::Vector3d::UnitY();
    array.markers.push_back(metricText(c, "scale", 0, below, text, 0.028, colourOf(GateOutcome::accepted)));
  }
  for (Marker* sheet : {&dots, &trails, &feet}) array.markers.push_back(finished(std::move(*sheet)));
}

std::string PositionPicture::labelOf(const sightline::PositionTrack& message) const {
  const core::PositionTrack track = toCore(message);
  char speed[32];
  std::snprintf(speed, sizeof(speed), "%.1f m/s", track.velocity.norm());
  std::string text =
      std::to_string(track.id) + (track.status == core::TrackStatus::coasting ? "  coasting" : "") + "  " +
      speed + "\nsigma " + readableLength(sigmaOf(track)) + "\n" + std::to_string(track.sources.size()) +
      (track.sources.size() == 1 ? " station" : " stations");
  return text;
}

/// One marker for the crosses of all kinds; the kind is written where there are few.
void PositionPicture::drawRefused(MarkerArray& array) const {
  const MetricCanvas c = canvas();
  Marker crosses = metricLines(c, "crosses: ghost (red), ambiguous (yellow), unlikely (grey)", 0.003);
  std::size_t count = 0;
  if (report_) {
    for (const sightline::RefusedCrossing& crossing : report_->refused) {
      const Eigen::Vector3d place(crossing.position.x, crossing.position.y, crossing.position.z);
      if (!isFinite(place) || (place - middle()).norm() > 3.0 * c.size) continue;
      if (++count > kMostRefused) break;
      const Colour colour = colourOfRefusal(crossing.kind);
      drawCrossOut(crosses, place, 0.016 * c.size, colour);
      if (count <= 2 * kMostFullPositionLabels)
        array.markers.push_back(metricText(c, "kinds", static_cast<int>(count),
                                           place - 0.03 * c.size * Eigen::Vector3d::UnitZ(), crossing.kind,
                                           0.02, colour));
    }
  }
  array.markers.push_back(finished(std::move(crosses)));
}

void PositionPicture::drawTruth(MarkerArray& array) const {
  const MetricCanvas c = canvas();
  Marker paths = metricLines(c, "paths", 0.0015);
  Marker targets = metricLines(c, "targets", 0.0025);
  for (const sightline::PositionTrack& target : truth_.newest.tracks) {
    drawFadingPath(paths, truth_.pathOf(target.id), truthColour());
    drawStar(targets, toCore(target).position, 0.03 * c.size, truthColour());
  }
  for (Marker* sheet : {&paths, &targets}) array.markers.push_back(finished(std::move(*sheet)));
}

}  // namespace sightline_ros
