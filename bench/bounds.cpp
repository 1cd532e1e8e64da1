#include "bounds.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace sightline::bench {
namespace {

/// Mean over the span of g(t)^T J(t)^-1 g(t), with the information J of all sightings until t about
/// parameters of which the position depends through g. `azimuth` and `elevation` may differ.
template <int kParameters, typename Gradient>
double meanBound(const Stream& stream, const Span& span, const Gradient& gradient) {
  using Vector = Eigen::Matrix<double, kParameters, 1>;
  using Matrix = Eigen::Matrix<double, kParameters, kParameters>;
  double sum = 0.0;
  int counted = 0;
  Matrix information[2] = {Matrix::Zero(), Matrix::Zero()};
  for (const Instant& instant : stream) {
    for (int channel = 0; channel < 2; ++channel) {
      const Vector g = gradient(0.01 * instant.tick, channel);
      if (instant.seen && !instant.outlier)
        information[channel] += g * g.transpose() / instant.measurement.covariance(channel, channel);
      if (instant.tick <= span.after || instant.tick > span.until) continue;
      const Eigen::LDLT<Matrix> solver(information[channel]);
      sum += g.dot(solver.solve(g));
      ++counted;
    }
  }
  return sum / counted;
}

}  // namespace

double sinusoidBound(const Stream& stream, const Span& span) {
  return meanBound<4>(stream, span, [](double t, int channel) {
    const double phase = channel == 0 ? t : t + std::acos(0.0);
    return Eigen::Vector4d(1.0, std::sin(phase), std::cos(phase), t * std::cos(phase));
  });
}

double lineBound(const Stream& stream, const Span& span) {
  return meanBound<2>(stream, span, [](double t, int) { return Eigen::Vector2d(1.0, t); });
}

double whiteAccelerationBound(const Stream& stream, double q, double scale, const Span& span) {
  const double variance = scale * scale;
  Eigen::Matrix2d P;
  P << 1e6 * variance, 0.0, 0.0, 0.25 * variance;
  double sum = 0.0;
  int counted = 0, tick = 0;
  for (const Instant& instant : stream) {
    const double h = 0.01 * (instant.tick - tick);
    tick = instant.tick;
    Eigen::Matrix2d F, Q;
    F << 1.0, h, 0.0, 1.0;
    Q << h * h * h / 3.0, h * h / 2.0, h * h / 2.0, h;
    P = F * P * F.transpose() + q * variance * Q;
    if (instant.seen && !instant.outlier) {
      const double S = P(0, 0) + instant.measurement.covariance(0, 0);
      const Eigen::Vector2d K = P.col(0) / S;
      P -= S * K * K.transpose();
    }
    if (instant.tick > span.after && instant.tick <= span.until) sum += P(0, 0), ++counted;
  }
  return sum / counted;
}

}  // namespace sightline::bench
