#include "sightline/ros/components/sensor_places.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <tf2/exceptions.h>

#include "sightline/report/value_text.h"

namespace sightline_ros {

namespace core = sightline::core;
using sightline::report::valueOf;

std::string SensorPlaces::frameOf(const std::string& sensor) const {
  const auto set = frames_.find(sensor);
  return set != frames_.end() ? set->second : sensor;
}

/// From the reference, at the newest time that both frames have.
std::optional<double> SensorPlaces::distance(const std::string& frame) const {
  const std::string reference = frameOf(reference_);
  if (frame == reference) return 0.0;
  if (!transforms_->canTransform(reference, frame, ros::Time(0))) return std::nullopt;
  const auto t = transforms_->lookupTransform(reference, frame, ros::Time(0)).transform.translation;
  return std::sqrt(t.x * t.x + t.y * t.y + t.z * t.z);
}

std::optional<core::Refusal> SensorPlaces::take(const std::string& tracker,
                                                const std::vector<std::string>& sensors, double sigma) {
  if (!(max_baseline_ > 0.0)) return std::nullopt;
  for (const std::string& sensor : sensors) {
    const std::string frame = frameOf(sensor);
    if (!transforms_->_frameExists(frame)) continue;
    if (reference_.empty()) {
      reference_ = sensor;
      continue;
    }
    const auto apart = distance(frame);
    if (!apart) continue;
    spread_ = std::max(spread_, *apart);
    if (*apart <= max_baseline_) continue;
    std::ostringstream why;
    why << "\"" << tracker << "\" is left out: its sensor " << sensor << " stands " << valueOf(*apart, "m")
        << " from " << reference_ << " (max_baseline " << max_baseline_ << " m)";
    if (sigma > 0.0)
      why << ", so that directions of a target nearer than " << valueOf(*apart / sigma, "m")
          << " differ by more than their sigma";
    why << "; use position_tracker for stations that stand apart";
    return core::Refusal{"apart", why.str()};
  }
  return std::nullopt;
}

}  // namespace sightline_ros
