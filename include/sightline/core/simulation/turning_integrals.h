#pragma once

#include <complex>

namespace sightline::core {

/// (S-86): integrals of exp(i w u) for u from 0 to t, per t and per t^2, as functions of x = w t; smooth at
/// x = 0.
/// An acceleration a exp(i (phase + w t)) gives the velocity a t exp(i phase) once(x) and the position
/// a t^2 exp(i phase) twice(x).
struct TurningIntegrals {
  std::complex<double> once;   ///< (exp(ix) - 1) / (ix)
  std::complex<double> twice;  ///< (exp(ix) - 1 - ix) / (ix)^2
};

inline TurningIntegrals turningIntegrals(double x) {
  const std::complex<double> ix(0.0, x);
  if (std::abs(x) > 0.5) {
    const std::complex<double> turned = std::exp(ix) - 1.0;
    return {turned / ix, (turned - ix) / (ix * ix)};
  }
  // The quotients cancel near zero; their power series sum (ix)^k / (k+1)! and (ix)^k / (k+2)! do not.
  TurningIntegrals sum{0.0, 0.0};
  std::complex<double> term = 1.0;  // (ix)^k / (k+1)!
  for (int k = 0; k < 14; ++k) {
    sum.once += term;
    sum.twice += term / static_cast<double>(k + 2);
    term *= ix / static_cast<double>(k + 2);
  }
  return sum;
}

}  // namespace sightline::core
