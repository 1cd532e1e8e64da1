#include "sightline/ros/components/live_smoothing.h"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "sightline/core/smoothing/smoothing_bank.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

constexpr double kKept = 10.0;  // after a track's last sighting [s]

core::Time stampOf(const sightline::TrackArray::ConstPtr& message) {
  return toCore(message->header.stamp);
}

}  // namespace

sightline::Track withState(const sightline::Track& message, const core::AngularState& state) {
  core::Track track = toCore(message);
  track.state = state;
  return toMessage(track);
}

LiveSmoothing::LiveSmoothing(const core::EstimatorParams& estimator, double lag)
    : bank_(core::smoothingBankOf(estimator)), lag_(lag) {
  if (!(lag > 0.0))
    throw std::invalid_argument("LiveSmoothing: a lag > 0 s is required, got " + std::to_string(lag));
}

LiveSmoothing::Messages LiveSmoothing::onReport(const TrackerReport& report) {
  Messages due;
  if (report.went_back) {
    if (!messages_.empty()) due = answer(stampOf(messages_.back()));
    tracks_.clear();
  }
  for (const core::TrackTracklet& taken : report.sightings) {
    auto track = tracks_.find(taken.track);
    if (track == tracks_.end())
      track = tracks_.emplace(taken.track, Smoothed{core::FixedLagSmoother(bank_), {}}).first;
    track->second.last = std::max(track->second.last, taken.tracklet.time);
    ++(track->second.smoother.take({taken.tracklet, report.noise_scale}) ? sightings_ : late_);
  }
  if (!report.tracks) return due;
  messages_.push_back(report.tracks);
  const core::Time newest = stampOf(messages_.back());
  const bool is_full = messages_.size() > kMostMessages || sightings_ > kMostSightings;
  const bool is_due = core::seconds(newest - stampOf(messages_.front())) >= (1.0 + core::kLagBatch) * lag_;
  if (!is_full && !is_due) return due;
  Messages answered = answer(is_full ? newest : newest - core::durationOf(lag_));
  due.insert(due.end(), answered.begin(), answered.end());
  return due;
}

LiveSmoothing::Messages LiveSmoothing::overdue(core::Time now) {
  if (messages_.empty()) return {};
  const core::Time newest = stampOf(messages_.back());
  if (core::seconds(now - newest) < (1.0 + core::kLagBatch) * lag_) return {};
  return answer(newest);
}

/// The messages up to `end`.
LiveSmoothing::Messages LiveSmoothing::answer(core::Time end) {
  Messages due;
  std::map<std::uint32_t, std::vector<core::Time>> times;
  for (; !messages_.empty() && stampOf(messages_.front()) <= end; messages_.pop_front()) {
    due.push_back(boost::make_shared<sightline::TrackArray>(*messages_.front()));
    const core::Time stamp = stampOf(messages_.front());
    for (const sightline::Track& track : due.back()->tracks) {
      std::vector<core::Time>& asked = times[track.id];
      if (asked.empty() || asked.back() < stamp) asked.push_back(stamp);
    }
  }
  std::map<std::pair<std::uint32_t, core::Time>, core::AngularState> states;
  for (auto track = tracks_.begin(); track != tracks_.end();) {
    const std::vector<core::Time>& asked = times[track->first];
    const auto found = track->second.smoother.answer(asked, end);
    for (std::size_t i = 0; i < asked.size(); ++i)
      if (found[i]) states.emplace(std::make_pair(track->first, asked[i]), *found[i]);
    track = core::seconds(end - track->second.last) > kKept ? tracks_.erase(track) : std::next(track);
  }
  sightings_ = 0;
  for (const sightline::TrackArray::Ptr& message : due) {
    std::vector<sightline::Track> smoothed;
    for (const sightline::Track& track : message->tracks) {
      const auto state = states.find({track.id, toCore(message->header.stamp)});
      if (state != states.end()) smoothed.push_back(withState(track, state->second));
    }
    message->tracks = std::move(smoothed);
  }
  return due;
}

}  // namespace sightline_ros
