#pragma once

/// Quantiles of the chi-square distribution, and the band of its mean.
namespace sightline::core {

/// Median of chi^2 with two degrees of freedom, 2 ln 2.
inline constexpr double kChiSquareMedian2 = 1.386294361119891;

/// Quantile of chi^2 with two degrees of freedom, -2 ln(1 - probability); `probability` in [0, 1).
double chiSquareQuantile2(double probability);

/// Quantile of chi^2 with four degrees of freedom; `probability` in (0, 1).
double chiSquareQuantile4(double probability);

}  // namespace sightline::core
