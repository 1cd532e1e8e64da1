#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>

#include <Eigen/Core>

#include <sightline/AssociationArray.h>
#include <sightline/TrackArray.h>

#include "sightline/ros/display/display_colours.h"
#include "sightline/ros/display/display_memory.h"
#include "sightline/ros/display/magnifier.h"
#include "sightline/ros/display/markers.h"

namespace sightline_ros {

/// How much is drawn. Times are of receipt, except for `history`, which is of stamps.
struct DisplayParams {
  Canvas canvas;
  double sighting_time = 0.6;    ///< a sighting is shown for so long, fading [s]
  double history = 4.0;          ///< of tracks and truth that is drawn as a trail [s]
  double prediction = 1.0;       ///< of the main track's motion that is drawn ahead [s]
  bool tentative_gates = false;  ///< of all tentative tracks; otherwise only of one that is looked at
  double silence = 1.5;          ///< after which the things of a silent topic vanish [s]
};

/// The track that a person looks at.
struct LookedAt {
  std::string channel;  ///< name of its tracker, or DisplayScene::kMainChannel
  std::uint32_t track = 0;
  bool alone = false;  ///< nothing is drawn but this track, and the sightings near its gate
};

/// Messages in, markers out. Things are drawn in channels, one for each sensor or tracker by name, so that
/// each can be switched off; the main track and the truth have theirs. `now` is the time of receipt [s],
/// never going back by more than 1 s but when a recording starts anew: then all is forgotten.
class DisplayScene {
 public:
  static constexpr const char* kMainChannel = "fusion";
  static constexpr const char* kTruthChannel = "truth";

  DisplayScene(const DisplayParams& params, const SensorColours& colours);

  /// A scan in the tracking frame, drawn in the channel of its sensor.
  void addScan(const sightline::core::Scan& scan, double now);

  /// Reports of one tracker, and what it did with the sightings; `channel` is its name.
  void addTracks(const std::string& channel, const sightline::TrackArray& tracks, double now);
  void addAssociations(const std::string& channel, const sightline::AssociationArray& decisions);

  void addTruth(const sightline::TrackArray& truth, double now);

  void lookAt(const std::optional<LookedAt>& track) { looked_at_ = track; }

  /// Markers by channel. A channel that got empty since the last call is there once more, to delete its
  /// markers.
  std::map<std::string, MarkerArray> draw(double now);

  /// Where a camera should look (azimuth, elevation) [rad]: to the horizon below the first thing seen. It
  /// keeps still while an established main track, or the latest sighting when there is none, is within 1 rad
  /// of it, and is taken along beyond. Along the frame's x axis before there is anything.
  Eigen::Vector2d view() const { return view_.value_or(Eigen::Vector2d::Zero()); }

 private:
  using Sheets = std::map<std::string, MarkerArray>;

  bool isLookedAt(const std::string& channel, std::uint32_t track) const;
  bool isHidden(const std::string& channel, std::uint32_t track) const;
  bool hasGate(const std::string& channel, const sightline::Track& track) const;
  bool isHidden(const SightingMemory::Seen& sighting) const;
  const sightline::Track* trackLookedAt() const;
  bool isPresent(const TrackMemory& memory, double now) const;
  void restartWhenBack(double now);
  void aimView();
  void forgetSilentSensors();
  void dropWhatStaysEmpty(Sheets& sheets);

  void drawSightings(MarkerArray& array, const std::string& sensor, double now) const;
  void drawLocalTracks(MarkerArray& array, const std::string& channel, double now) const;
  void drawGates(MarkerArray& array, const std::string& channel) const;
  void drawLookedAt(MarkerArray& array, const std::string& channel) const;
  void drawMainTracks(MarkerArray& array, double now) const;
  void drawSources(Marker& lines, const sightline::Track& track, double now) const;
  void drawTruth(MarkerArray& array) const;
  void drawLabels(MarkerArray& array);

  std::optional<Magnifier> insetNow() const;
  void drawMagnified(MarkerArray& array, double now);
  void magnifySightings(Marker& dots, const Magnifier& magnifier, std::uint32_t track, double now) const;
  void magnifyTracks(Marker& lines, const Magnifier& magnifier, const sightline::Track& main) const;

  /// Where in the inset a track is shown, by its offset from the main track at the latest time that both
  /// know; nullopt outside of it.
  std::optional<Eigen::Vector2d> placeBeside(std::uint32_t main_track, const TrackMemory& tracker,
                                             std::uint32_t track, const Magnifier& magnifier) const;

  Colour colourOf(const std::string& sensor, const SightingMemory::Seen& seen, double now) const;
  std::optional<Eigen::Vector3d> attention() const;
  const sightline::Track* leadingTrack() const;
  std::optional<Eigen::Vector3d> directionOfSource(const std::string& source, const sightline::Track& of,
                                                   double now) const;
  std::string errorText(const sightline::Track& track) const;

  DisplayParams params_;
  SensorColours colours_;
  std::map<std::string, SightingMemory> sensors_;
  std::map<std::string, TrackMemory> trackers_;
  TrackMemory truth_;
  std::optional<LookedAt> looked_at_;
  double newest_ = 0.0;                       // the latest `now` [s]
  std::optional<Eigen::Vector2d> view_;       // (azimuth, elevation) [rad]
  std::map<std::uint32_t, int> label_sides_;  // on which side of its track a label stands
  double magnification_ = 0.0;                // 0 = none at present
  std::set<std::string> full_;                // channels that had markers at the last call
};

}  // namespace sightline_ros
