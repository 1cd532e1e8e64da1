#pragma once

#include <optional>
#include <string>

#include "sightline/core/model/refusal.h"
#include "sightline/core/sensors/sensor_guard.h"

/// Which settings of a guard may change while it watches.
namespace sightline::core {

/// The field in which the two differ and that holds from the start; nullopt when they differ only in the
/// thresholds at which a verdict is given and taken back: `noise_threshold`, `bias_threshold`,
/// `noise_release`, `bias_release` and `least_exclusion` of `health`. The others are in what has been summed
/// up.
std::optional<std::string> fixedGuardField(const GuardParams& now, const GuardParams& wanted);

/// Why a guard cannot be made with these; nullopt when it can.
std::optional<Refusal> whyUnusable(const GuardParams& params);

}  // namespace sightline::core
