#include "sightline/core/sensors/guard_settings.h"

#include <stdexcept>

namespace sightline::core {

std::optional<std::string> fixedGuardField(const GuardParams& now, const GuardParams& wanted) {
  if (wanted.enabled != now.enabled) return "enabled";
  if (wanted.roll_back != now.roll_back) return "roll_back";
  if (wanted.support != now.support) return "support";
  if (wanted.reach != now.reach) return "reach";
  if (!(wanted.clock == now.clock)) return "clock";
  SensorHealthParams health = wanted.health;  // with what may change as it is now
  health.noise_threshold = now.health.noise_threshold;
  health.bias_threshold = now.health.bias_threshold;
  health.noise_release = now.health.noise_release;
  health.bias_release = now.health.bias_release;
  health.least_exclusion = now.health.least_exclusion;
  if (!(health == now.health)) return "health (but its thresholds and releases)";
  return std::nullopt;
}

std::optional<Refusal> whyUnusable(const GuardParams& params) {
  try {
    [[maybe_unused]] const SensorGuard guard(params);
  } catch (const std::invalid_argument& problem) {
    return invalid(std::string("guard: ") + problem.what());
  }
  return std::nullopt;
}

}  // namespace sightline::core
