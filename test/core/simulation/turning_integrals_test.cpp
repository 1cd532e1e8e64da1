#include "sightline/core/simulation/turning_integrals.h"

#include <cmath>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

using Complex = std::complex<double>;

/// Integral of exp(i x u) weight(u) over u in [0, 1] by Simpson's rule.
template <typename Weight>
Complex integralOf(double x, const Weight& weight) {
  constexpr int kSteps = 2000;
  Complex sum = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    const double u = static_cast<double>(i) / kSteps;
    const double factor = i == 0 || i == kSteps ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
    sum += factor * weight(u) * std::exp(Complex(0.0, x * u));
  }
  return sum / (3.0 * kSteps);
}

TEST(TurningIntegrals, AreThoseOfATurningAccelerationForSmallAndLargeTurns) {
  for (const double x : {-20.0, -0.6, -0.4, 1e-9, 1e-3, 0.49, 0.51, 2.0, 10.0}) {
    const TurningIntegrals integrals = turningIntegrals(x);
    EXPECT_LT(std::abs(integrals.once - integralOf(x, [](double) { return 1.0; })), 1e-9) << x;
    // Integrated twice, what comes at u counts for the time that is left.
    EXPECT_LT(std::abs(integrals.twice - integralOf(x, [](double u) { return 1.0 - u; })), 1e-9) << x;
  }
}

TEST(TurningIntegrals, WithoutTurnAreThoseOfAConstantAcceleration) {
  EXPECT_EQ(turningIntegrals(0.0).once, Complex(1.0));
  EXPECT_EQ(turningIntegrals(0.0).twice, Complex(0.5));
}

TEST(TurningIntegrals, SeriesAndQuotientsMeet) {
  const TurningIntegrals series = turningIntegrals(0.5),
                         quotients = turningIntegrals(std::nextafter(0.5, 1.0));
  EXPECT_LT(std::abs(series.once - quotients.once), 1e-15);
  EXPECT_LT(std::abs(series.twice - quotients.twice), 1e-14);
}

}  // namespace
}  // namespace sightline::core
