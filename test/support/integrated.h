#pragma once

#include <functional>

namespace sightline::test {

/// Integral of `acceleration` from rest at zero by Simpson's rule in velocity and position.
inline double integrated(const std::function<double(double)>& acceleration, double angle, double rate,
                         double time) {
  const int steps = 40000;
  const double h = time / steps;
  for (int i = 0; i < steps; ++i) {
    const double t = i * h;
    const double a0 = acceleration(t + 1e-12), a1 = acceleration(t + 0.5 * h),
                 a2 = acceleration(t + h - 1e-12);
    angle += h * rate + h * h / 6.0 * (a0 + 2.0 * a1);
    rate += h / 6.0 * (a0 + 4.0 * a1 + a2);
  }
  return angle;
}

}  // namespace sightline::test
