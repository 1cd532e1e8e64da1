#pragma once

#include <cstdint>
#include <optional>

#include "sightline/core/model/refusal.h"
#include "sightline/core/model/time.h"
#include "sightline/core/simulation/random_stream.h"

namespace sightline::core {

/// When a sensor looks.
struct SightingTiming {
  enum class Kind {
    random,  ///< the paper's sequence (S-1)
    fixed    ///< at a constant rate
  };
  Kind kind = Kind::random;
  double shortest = 0.010;  ///< dmin of (S-1): shortest interval, and the tick of which all are multiples [s]
  double spread = 0.050;    ///< dmax of (S-1), >= dmin [s]
  double rate = 30.0;       ///< of the fixed kind [Hz]
  double first = 0.0;       ///< first exposure after time zero, >= 0 [s]

  bool operator==(const SightingTiming& other) const;
};

/// Intervals of (S-1) that a uniform rho in [0, 1) gives, in ticks of dmin: 1 + floor(rho dmax/dmin).
std::int64_t ticksOf(double rho, Duration shortest, Duration spread);

/// Mean rate of exposures [Hz].
double expectedRate(const SightingTiming& timing);

/// The exposures of a sensor, one after the other, exact to the nanosecond for ever.
class SightingSequence {
 public:
  SightingSequence(const SightingTiming& timing, std::uint64_t seed);

  /// Time of the next exposure since time zero.
  Duration next();

 private:
  SightingTiming timing_;
  RandomStream stream_;
  std::int64_t count_ = 0;  // of exposures so far
  std::int64_t ticks_ = 0;  // of the random kind: from the first exposure to the next
};

/// What is wrong with a timing; nullopt when nothing is.
std::optional<Refusal> refusalOf(const SightingTiming& timing);

}  // namespace sightline::core
