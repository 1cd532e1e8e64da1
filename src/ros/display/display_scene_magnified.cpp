// What DisplayScene draws magnified beside the main track.
#include "sightline/core/model/sphere.h"
#include "sightline/ros/display/display_scene.h"
#include "sightline/ros/display/display_tracks.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {

namespace core = sightline::core;

/// The inset round the leading track, when that needs one.
std::optional<Magnifier> DisplayScene::insetNow() const {
  const sightline::Track* track = leadingTrack();
  if (track == nullptr || isHidden(kMainChannel, track->id)) return std::nullopt;
  const double two_sigma = 2.0 * sigmaOf(*track);
  if (!Magnifier::isNeededFor(two_sigma)) return std::nullopt;
  const core::AngularState state = toCore(*track).state;
  return Magnifier(state.angles(), sideOf(state, view()), Magnifier::factorFor(two_sigma, magnification_));
}

void DisplayScene::drawMagnified(MarkerArray& array, double now) {
  Marker rim = lineSheet(params_.canvas, "rim", 0.15 * core::kDegree);
  Marker dots = dotSheet(params_.canvas, "sightings and tracks", 0.7 * core::kDegree);
  Marker lines = lineSheet(params_.canvas, "2-sigma ellipses and truth", 0.2 * core::kDegree);
  const auto magnifier = insetNow();
  magnification_ = magnifier ? magnifier->factor() : 0.0;
  if (magnifier) {
    const sightline::Track& track = *leadingTrack();
    magnifier->drawRim(rim, params_.canvas, dimmed(mainColour(), 0.7));
    array.markers.push_back(magnifier->label(params_.canvas, mainColour()));
    magnifySightings(dots, *magnifier, track.id, now);
    magnifyTracks(lines, *magnifier, track);
  }
  for (Marker* sheet : {&rim, &dots, &lines}) array.markers.push_back(finished(std::move(*sheet)));
}

void DisplayScene::magnifySightings(Marker& dots, const Magnifier& magnifier, std::uint32_t track,
                                    double now) const {
  const TrackMemory& main = trackers_.at(kMainChannel);
  for (const auto& [sensor, memory] : sensors_) {
    for (const SightingMemory::Seen& seen : memory.seen()) {
      const auto then = main.anglesAt(track, seen.time);
      if (!then) continue;
      const Eigen::Vector2d place = magnifier.place(seen.direction, *then);
      if (!magnifier.shows(place)) continue;
      drawDot(dots, params_.canvas, core::directionOf(place), colourOf(sensor, seen, now));
    }
  }
}

void DisplayScene::magnifyTracks(Marker& lines, const Magnifier& magnifier,
                                 const sightline::Track& main) const {
  const auto drawEllipse = [&](const sightline::Track& track, const Eigen::Vector2d& place,
                               const Colour& colour) {
    const core::AngularState state = toCore(track).state;
    magnifier.drawEllipse(lines, params_.canvas, place,
                          magnifier.magnified(state.angles(), state.anglesCovariance()), colour);
  };
  drawEllipse(main, magnifier.centre(), mainColour());
  for (const auto& [channel, tracker] : trackers_) {
    if (channel == kMainChannel) continue;
    for (const sightline::Track& local : tracker.newest().tracks) {
      const auto place = placeBeside(main.id, tracker, local.id, magnifier);
      if (place && isEstablished(local)) drawEllipse(local, *place, dimmed(colours_.of(channel), 0.8));
    }
  }
  for (const sightline::Track& target : truth_.newest().tracks) {
    const auto place = placeBeside(main.id, truth_, target.id, magnifier);
    if (place) drawCross(lines, params_.canvas, *place, 1.5 * core::kDegree, truthColour());
  }
}

std::optional<Eigen::Vector2d> DisplayScene::placeBeside(std::uint32_t main_track, const TrackMemory& tracker,
                                                         std::uint32_t track,
                                                         const Magnifier& magnifier) const {
  const TrackMemory& main = trackers_.at(kMainChannel);
  const core::Time common = toCore(std::min(main.newest().header.stamp, tracker.newest().header.stamp));
  const auto main_angles = main.anglesAt(main_track, common);
  const auto angles = tracker.anglesAt(track, common);
  if (!main_angles || !angles) return std::nullopt;
  const Eigen::Vector2d place = magnifier.place(core::directionOf(*angles), *main_angles);
  if (!magnifier.shows(place)) return std::nullopt;
  return place;
}

}  // namespace sightline_ros
