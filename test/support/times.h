#pragma once

#include "sightline/core/model/time.h"

namespace sightline::test {

/// A stamp so many seconds after the epoch.
inline core::Time at(double seconds) {
  return core::Time(core::durationOf(seconds));
}

}  // namespace sightline::test
