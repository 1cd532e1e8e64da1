// Labels of DisplayScene's main tracks: none lies over another one or in the magnified inset.
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "sightline/core/model/sphere.h"
#include "sightline/ros/display/display_scene.h"
#include "sightline/ros/display/display_tracks.h"
#include "sightline/ros/display/label_places.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

constexpr std::size_t kMostFullLabels = 3;                   // of more tracks only the numbers are written
constexpr double kShortLabelDistance = 2.5 * core::kDegree;  // of a number alone, from the track
constexpr double kLabelDistance = 18.0 * core::kDegree;      // from the rim of the ellipse
constexpr double kShortHeight = 2.4 * core::kDegree, kHeight = 3.2 * core::kDegree;  // of letters
constexpr int kSides = 8;  // of the track, on which its label may stand; then again, twice as far off
constexpr double kInsetLabel = 0.1;  // outside of the inset's rim [rad]

}  // namespace

/// The track that is looked at comes first, then the older ones; what finds no place is left out. A label
/// stays on its side as long as that is free.
void DisplayScene::drawLabels(MarkerArray& array) {
  const sightline::TrackArray& newest = trackers_.at(kMainChannel).newest();
  std::vector<const sightline::Track*> tracks;
  for (const sightline::Track& track : newest.tracks)
    if (isEstablished(track) && !isHidden(kMainChannel, track.id)) tracks.push_back(&track);
  std::stable_sort(tracks.begin(), tracks.end(), [this](const auto* a, const auto* b) {
    const bool a_first = isLookedAt(kMainChannel, a->id), b_first = isLookedAt(kMainChannel, b->id);
    return a_first != b_first ? a_first : a->id < b->id;
  });
  LabelPlaces places;
  if (const auto inset = insetNow()) places.block(inset->centre(), Magnifier::kRadius + kInsetLabel);
  const bool is_crowd = establishedIn(newest) > kMostFullLabels;
  std::map<std::uint32_t, int> sides;
  for (const sightline::Track* track : tracks) {
    const core::AngularState state = toCore(*track).state;
    const double height = is_crowd ? kShortHeight : kHeight;
    const double distance =
        is_crowd ? kShortLabelDistance : std::min(2.0 * sigmaOf(*track), 0.3) + kLabelDistance;
    const std::string text =
        is_crowd ? std::to_string(track->id) : sightline_ros::labelOf(*track) + errorText(*track);
    const Eigen::Vector2d size = labelSize(text, height), side = sideOf(state, view());
    const auto known = label_sides_.find(track->id);
    const int first = known != label_sides_.end() ? known->second : 0;
    for (int turn = 0; turn < 2 * kSides; ++turn) {
      const int at = (first + turn) % (2 * kSides);
      const double far = at < kSides ? distance : 2.0 * distance;
      const Eigen::Rotation2Dd turned(2.0 * core::kPi * at / kSides);
      const Eigen::Vector3d place = walk(state.angles(), far * (turned * side));
      if (!places.take(place, size)) continue;
      sides[track->id] = at;
      array.markers.push_back(textMarker(params_.canvas, "labels", static_cast<int>(track->id), place, text,
                                         height, mainColour()));
      break;
    }
  }
  label_sides_ = std::move(sides);
}

}  // namespace sightline_ros
