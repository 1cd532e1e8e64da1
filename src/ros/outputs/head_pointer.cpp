#include "sightline/ros/outputs/head_pointer.h"

#include <algorithm>

#include "sightline/report/value_text.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {

namespace core = sightline::core;
using sightline::report::valueOf;

namespace {

constexpr double kBetter = 0.5;  // share of the followed track's sigma with which another one is better

std::string numberOf(std::uint32_t id) {
  return "track " + std::to_string(id);
}

}  // namespace

void HeadPointer::choose(std::uint32_t id) {
  chosen_by_hand_ = id;
  if (id != 0 && followed_ != id) followed_.reset();
}

void HeadPointer::reset() {
  tracks_.reset();
  followed_.reset();
}

const OutputTrack* HeadPointer::find(std::uint32_t id) const {
  const auto found = std::find_if(tracks_->tracks.begin(), tracks_->tracks.end(),
                                  [id](const OutputTrack& track) { return track.id == id; });
  return found != tracks_->tracks.end() ? &*found : nullptr;
}

const OutputTrack* HeadPointer::best() const {
  const auto surest =
      std::min_element(tracks_->tracks.begin(), tracks_->tracks.end(),
                       [](const auto& a, const auto& b) { return largestSigma(a) < largestSigma(b); });
  if (surest == tracks_->tracks.end()) return nullptr;
  const OutputTrack* followed = followed_ ? find(*followed_) : nullptr;
  if (followed != nullptr && largestSigma(*surest) > kBetter * largestSigma(*followed)) return followed;
  return &*surest;
}

const OutputTrack* HeadPointer::toFollow() const {
  if (chosen_by_hand_ != 0) return find(chosen_by_hand_);
  switch (params_.follow) {
    case FollowRule::best:
      return best();
    case FollowRule::oldest:
      return tracks_->tracks.empty() ? nullptr : &tracks_->tracks.front();
    case FollowRule::chosen:
      return find(params_.chosen);
  }
  return nullptr;
}

std::optional<HeadAim> HeadPointer::stay(const std::string& why) {
  is_aimed_ = false;
  words_ = why + ": the head stays where it was";
  return std::nullopt;
}

std::optional<HeadAim> HeadPointer::aim(core::Time now, const std::optional<Eigen::Isometry3d>& head_tracks) {
  if (!tracks_) return stay("there is no track yet");
  const OutputTrack* track = toFollow();
  if (track == nullptr) {
    const bool is_by_id = chosen_by_hand_ != 0 || params_.follow == FollowRule::chosen;
    const std::uint32_t chosen = chosen_by_hand_ != 0 ? chosen_by_hand_ : params_.chosen;
    if (is_by_id && chosen == 0) return stay("no track is chosen (publish its id on ~choose)");
    if (is_by_id)
      return stay(numberOf(chosen) + (followed_ ? " is lost" : ", which is chosen, is not there"));
    return stay(followed_ ? numberOf(*followed_) + " is lost, and there is no other" : "there is no track");
  }
  followed_ = track->id;
  const core::Time time = now + core::durationOf(params_.lead);
  const double h = core::seconds(time - toCore(tracks_->header.stamp));
  if (h < -params_.max_prediction)
    return stay("the tracks' stamp is " + valueOf(-h, "s") + " ahead of the clock");
  if (h > params_.max_prediction) {
    return stay(numberOf(track->id) + " was told " + valueOf(h - params_.lead, "s") +
                " ago (max_prediction " + valueOf(params_.max_prediction, "s") + ")");
  }
  if (!head_tracks) return stay("tf does not lead from the head to the frame of the tracks");
  const SeenDirection seen = seenFrom(*head_tracks, predicted(*track, h));
  if (!(seen.sigma <= params_.max_sigma)) {
    return stay(numberOf(track->id) + " is known to " + valueOf(seen.sigma, "rad") + " only (max_sigma " +
                valueOf(params_.max_sigma, "rad") + ")");
  }
  is_aimed_ = true;
  words_ = "follows " + numberOf(track->id);
  return HeadAim{track->id, time, attitudeAlong(seen.direction), seen.sigma};
}

}  // namespace sightline_ros
