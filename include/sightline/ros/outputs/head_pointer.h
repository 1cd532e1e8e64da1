#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "sightline/core/model/time.h"
#include "sightline/ros/outputs/output_tracks.h"
#include "sightline/ros/outputs/track_outputs_params.h"

namespace sightline_ros {

/// Where a pan-tilt head is to look.
struct HeadAim {
  std::uint32_t id = 0;          ///< of the track that it follows
  sightline::core::Time time{};  ///< for which it holds: now and the lead
  Eigen::Matrix3d
      R_head_target;   ///< x along the line of sight, y level in the head's frame: Rz(pan) Ry(-tilt)
  double sigma = 0.0;  ///< largest, of the line of sight [rad]
};

/// Follows one of the tracks of one source with a pan-tilt head. Between messages of tracks it predicts.
/// While there is no track to follow it gives no aim: the head stays where it was, and `words` says why.
class HeadPointer {
 public:
  explicit HeadPointer(const HeadParams& params) : params_(params) {}

  /// Follow this track from now on, and no other; 0: follow by the rule of the parameters again.
  void choose(std::uint32_t id);

  /// The newest tracks of the source.
  void onTracks(OutputTracks tracks) { tracks_ = std::move(tracks); }

  /// Forgets the tracks, not what was chosen.
  void reset();

  /// The aim at `now`. `head_tracks` maps points in the frame of the tracks to that of the head's foot;
  /// nullopt when tf does not say.
  std::optional<HeadAim> aim(sightline::core::Time now, const std::optional<Eigen::Isometry3d>& head_tracks);

  /// What it did at the last aim, for an operator: "follows track 3", "track 3 is lost: ...".
  const std::string& words() const { return words_; }
  std::optional<std::uint32_t> followed() const { return is_aimed_ ? followed_ : std::nullopt; }

 private:
  const OutputTrack* find(std::uint32_t id) const;
  const OutputTrack* best() const;
  const OutputTrack* toFollow() const;
  std::optional<HeadAim> stay(const std::string& why);

  HeadParams params_;
  std::uint32_t chosen_by_hand_ = 0;
  std::optional<OutputTracks> tracks_;
  std::optional<std::uint32_t> followed_;  // last
  bool is_aimed_ = false;
  std::string words_ = "has not been aimed yet";
};

}  // namespace sightline_ros
