#include "sightline/ros/messages/frames.h"

#include <algorithm>
#include <optional>
#include <sstream>
#include <utility>

#include <tf2/exceptions.h>

#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/messages/sensor_turn.h"

namespace sightline_ros {

namespace core = sightline::core;

FrameChange::FrameChange(FrameChangeParams params, const tf2::BufferCore& transforms)
    : params_(std::move(params)), transforms_(transforms) {}

void FrameChange::add(const sightline::SightingArray::ConstPtr& message, core::Time now) {
  if (auto refusal = refusalOf(*message)) {
    finished_.push_back(refusedScan(message, std::move(*refusal)));
    return;
  }
  const double ahead = core::seconds(toCore(message->header.stamp) - now);
  if (now != core::Time{} && ahead > params_.max_future) {
    std::ostringstream detail;
    detail << "its stamp is " << ahead << " s ahead of the clock, more than max_future " << params_.max_future
           << " s: synchronise the sensor's clock";
    finished_.push_back(refusedScan(message, {"from the future", detail.str()}));
    return;
  }
  const std::string& frame = message->header.frame_id;
  if (waiting_.count(frame) == 0 && isTurnKnown(message->header, params_, transforms_)) {
    finished_.push_back(inTrackingFrame(message));
    return;
  }
  waiting_[frame].push_back({message, now});
  ++waiting_count_;
}

std::vector<FramedScan> FrameChange::release(core::Time now) {
  for (auto it = waiting_.begin(); it != waiting_.end();) {
    releaseFirst(it->second, now);
    it = it->second.empty() ? waiting_.erase(it) : std::next(it);
  }
  while (waiting_count_ > static_cast<std::size_t>(params_.max_waiting)) dropOldest();
  return std::exchange(finished_, {});
}

/// The scans at the head of a frame's queue that have their transform, or have waited long enough.
void FrameChange::releaseFirst(std::deque<Waiting>& scans, core::Time now) {
  while (!scans.empty()) {
    Waiting& first = scans.front();
    // Simulated time starts late, or goes back: the wait then counts from now.
    if (first.since == core::Time{} || first.since > now) first.since = now;
    if (isTurnKnown(first.message->header, params_, transforms_)) {
      finished_.push_back(inTrackingFrame(first.message));
    } else if (hasWaitedEnough(first, now)) {
      finished_.push_back(withoutTransform(first, now));
    } else {
      return;
    }
    scans.pop_front();
    --waiting_count_;
  }
}

bool FrameChange::hasWaitedEnough(const Waiting& scan, core::Time now) const {
  return core::seconds(now - scan.since) >= params_.tf_timeout;
}

FramedScan FrameChange::inTrackingFrame(const sightline::SightingArray::ConstPtr& message) const {
  try {
    const std::optional<Turn> turn = turnOf(message->header, params_, transforms_);
    return framedScan(message, turn, viewOf(message->sensor, params_, turn));
  } catch (const tf2::TransformException& problem) {
    return refusedScan(message, {"no transform", problem.what()});
  }
}

FramedScan FrameChange::withoutTransform(const Waiting& scan, core::Time now) const {
  const auto& header = scan.message->header;
  std::string why;
  transforms_.canTransform(params_.tracking_frame, header.frame_id, header.stamp, &why);
  std::ostringstream detail;
  detail << "no transform from " << header.frame_id << " to " << params_.tracking_frame << " came within "
         << core::seconds(now - scan.since) << " s (tf_timeout " << params_.tf_timeout << " s)";
  if (!why.empty()) detail << ": " << why;
  if (why.find("extrapolation") != std::string::npos) {
    detail << " (transforms are interpolated between two stamps and never extrapolated: publish them for the "
              "stamps of the scans)";
  } else {
    detail << " (publish it on /tf or /tf_static, or correct header.frame_id or tracking_frame)";
  }
  return refusedScan(scan.message, {"no transform", detail.str()});
}

/// The scan that has waited longest makes room.
void FrameChange::dropOldest() {
  const auto oldest = std::min_element(waiting_.begin(), waiting_.end(), [](const auto& a, const auto& b) {
    return a.second.front().since < b.second.front().since;
  });
  finished_.push_back(refusedScan(
      oldest->second.front().message,
      {"too many waiting",
       "more than max_waiting " + std::to_string(params_.max_waiting) + " scans wait for their transforms"}));
  oldest->second.pop_front();
  if (oldest->second.empty()) waiting_.erase(oldest);
  --waiting_count_;
}

}  // namespace sightline_ros
