#pragma once

#include "scenarios.h"

/// What no estimator can beat: Cramer-Rao bounds of the position, both channels alike.
namespace sightline::bench {

/// The instants that count, tick in (after, until].
struct Span {
  int after = 100;
  int until = kTicks;
};

/// Of a sinusoid r(t) = offset + amplitude sin(w t + phase) with all four unknown, by the sightings so far:
/// mean variance over t in (1, 10] s of one run [rad^2]. Outliers count as not seen.
double sinusoidBound(const Stream& stream, const Span& span = {});

/// Of a straight line with unknown position and velocity.
double lineBound(const Stream& stream, const Span& span = {});

/// Posterior bound of a target of white acceleration, density `q` for amplitude 1, its first rate known to
/// +-0.5 rad/s: the Kalman filter that knows q.
double whiteAccelerationBound(const Stream& stream, double q, double scale, const Span& span = {});

}  // namespace sightline::bench
