#include "sightline/core/estimators/revisit_time.h"

#include <algorithm>
#include <cmath>

namespace sightline::core {
namespace {

constexpr double kNewest = 0.2;       // share of the newest interval in the usual one
constexpr double kLargestStep = 4.0;  // a longer interval counts as so many usual ones: it may be a gap
constexpr double kIntervalsOfUnit = 3.0;
constexpr double kLeastUnit = 1.0;  // [s]

}  // namespace

void RevisitTime::note(double h) {  // (S-91)
  if (h < kSameTime) return;
  usual_ = isKnown() ? usual_ + kNewest * (std::min(h, kLargestStep * usual_) - usual_) : h;
}

double RevisitTime::unit(double h) const {  // (S-91)
  return std::max(kLeastUnit, kIntervalsOfUnit * (isKnown() ? usual_ : std::abs(h)));
}

}  // namespace sightline::core
