#include "sightline/core/model/chi_square.h"

#include <cmath>

namespace sightline::core {

double chiSquareQuantile2(double probability) {  // (S-19)
  return -2.0 * std::log1p(-probability);
}

double chiSquareQuantile4(double probability) {  // (S-19)
  // 1 - exp(-x/2) (1 + x/2) = p is increasing in x; bisection, as its slope vanishes at both ends.
  double low = 0.0, high = 1.0;
  const auto tail = [](double x) { return std::exp(-0.5 * x) * (1.0 + 0.5 * x); };
  while (tail(high) > 1.0 - probability && high < 1e3) high *= 2.0;
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = 0.5 * (low + high);
    (tail(middle) > 1.0 - probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace sightline::core
