#include "sightline/core/simulation/angular_trajectory.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "sightline/core/model/sphere.h"
#include "sightline/core/simulation/random_stream.h"
#include "sightline/core/simulation/turning_integrals.h"

namespace sightline::core {
namespace {

/// One channel: angle [rad] and rate [rad/s].
struct Channel {
  double angle = 0.0;
  double rate = 0.0;
};

AngularMotion together(const Channel& azimuth, const Channel& elevation) {
  return {{azimuth.angle, elevation.angle}, {azimuth.rate, elevation.rate}};
}

/// What a piece of acceleration has added to angle and rate by `time`.
Channel effectOf(const AccelerationPiece& piece, double time) {
  if (time <= piece.from) return {};
  const double t = std::min(time, piece.to) - piece.from;
  const TurningIntegrals integrals = turningIntegrals(piece.frequency * t);  // (S-86)
  const std::complex<double> swing = std::polar(piece.amplitude, piece.phase);
  Channel effect;
  effect.rate = t * (piece.constant + std::imag(swing * integrals.once));
  effect.angle = t * t * (0.5 * piece.constant + std::imag(swing * integrals.twice));
  effect.angle += effect.rate * std::max(0.0, time - piece.to);
  return effect;
}

Channel weaveChannel(double angle, double rate, const std::vector<AccelerationPiece>& pieces, double time) {
  Channel sum{angle + rate * time, rate};
  for (const AccelerationPiece& piece : pieces) {
    const Channel effect = effectOf(piece, time);
    sum.angle += effect.angle;
    sum.rate += effect.rate;
  }
  return sum;
}

std::optional<Refusal> refusalOfPieces(const std::vector<AccelerationPiece>& pieces) {
  for (const AccelerationPiece& piece : pieces) {
    if (piece.to > piece.from && piece.from >= 0.0) continue;
    std::ostringstream why;
    why << "a piece of acceleration must start at or after 0 s and end after its start, got [" << piece.from
        << ", " << piece.to << ") s";
    return Refusal{"weave", why.str()};
  }
  return std::nullopt;
}

/// Integrated Brownian motion of one channel (S-87), found by halving (Levy 1948): the ends of an interval
/// are drawn first, then its middle given the ends, down to the grid. Any time is reached from the seed alone
/// in a few tens of draws.
class BrownianPath {
 public:
  explicit BrownianPath(double density) : density_(density) {}

  Channel at(Channel start, std::uint64_t seed, double time) const {
    double from = 0.0, length = 1.0;  // intervals [0, 1), [1, 2), [2, 4), [4, 8) ... s
    std::uint64_t interval = 0;
    while (true) {
      RandomStream stream(seed + interval);
      const Channel end = forward(start, length, stream.normalPair());
      if (time < from + length) return within(start, end, length, stream.bits(), time - from);
      start = end;
      from += length;
      length = from;
      ++interval;
    }
  }

 private:
  static constexpr double kGrid = 0x1p-10;  // [s]

  /// (S-87), later state of a white-acceleration motion: x + h v, v, with Q = q [[h^3/3, h^2/2], [h^2/2, h]].
  Channel forward(const Channel& start, double h, const Eigen::Vector2d& draw) const {
    const double turn = std::sqrt(density_ * h) * draw.x();  // of the rate
    const double rest = std::sqrt(density_ * h * h * h / 12.0) * draw.y();
    return {start.angle + h * start.rate + 0.5 * h * turn + rest, start.rate + turn};
  }

  /// (S-87), the state in the middle given both ends, each h away: the cubic between them plus independent
  /// errors of variance q h^3/24 (angle) and q h/8 (rate).
  Channel middle(const Channel& start, const Channel& end, double h, const Eigen::Vector2d& draw) const {
    Channel middle = cubic(start, end, 2.0 * h, 0.5);
    middle.angle += std::sqrt(density_ * h * h * h / 24.0) * draw.x();
    middle.rate += std::sqrt(density_ * h / 8.0) * draw.y();
    return middle;
  }

  static Channel cubic(const Channel& start, const Channel& end, double length, double u) {
    const double step = end.angle - start.angle;
    return {start.angle + u * u * (3.0 - 2.0 * u) * step +
                length * u * (1.0 - u) * ((1.0 - u) * start.rate - u * end.rate),
            6.0 * u * (1.0 - u) * step / length + (1.0 - u) * (1.0 - 3.0 * u) * start.rate +
                u * (3.0 * u - 2.0) * end.rate};
  }

  Channel within(Channel start, Channel end, double length, std::uint64_t seed, double time) const {
    while (length > kGrid) {
      RandomStream stream(seed);
      const Channel mid = middle(start, end, 0.5 * length, stream.normalPair());
      const std::uint64_t left = stream.bits(), right = stream.bits();
      length *= 0.5;
      const bool second_half = time >= length;
      if (second_half) time -= length;
      (second_half ? start : end) = mid;
      seed = second_half ? right : left;
    }
    return cubic(start, end, length, time / length);
  }

  double density_;  // [rad^2/s^3]
};

}  // namespace

Weave benchmarkWeave(double scale) {
  Weave weave;
  weave.rates = scale * Eigen::Vector2d(0.3, -0.2);
  weave.azimuth = {{3.0, 6.0, 0.0, 2.0 * scale, 2.5, 0.0}, {6.5, 8.5, 1.5 * scale, 0.0, 0.0, 0.0}};
  weave.elevation = {{2.0, 4.0, 1.2 * scale, 0.0, 0.0, 0.0}, {5.0, 8.0, 0.0, -2.5 * scale, 4.0, 0.0}};
  return weave;
}

AngularMotion motionAt(const Sinusoid& sinusoid, double time) {
  const Eigen::Array2d argument = (sinusoid.frequency * time + sinusoid.phase).array();
  AngularMotion motion;
  motion.angles = sinusoid.offset + (sinusoid.amplitude.array() * argument.sin()).matrix();
  motion.rates = (sinusoid.amplitude.array() * sinusoid.frequency.array() * argument.cos()).matrix();
  return motion;
}

AngularMotion motionAt(const AngularLine& line, double time) {
  return {line.angles + time * line.rates, line.rates};
}

AngularMotion motionAt(const Weave& weave, double time) {
  return together(weaveChannel(weave.angles.x(), weave.rates.x(), weave.azimuth, time),
                  weaveChannel(weave.angles.y(), weave.rates.y(), weave.elevation, time));
}

AngularMotion motionAt(const WhiteAcceleration& path, double time) {
  const BrownianPath brownian(path.density);
  const double t = std::max(time, 0.0);
  return together(brownian.at({path.angles.x(), path.rates.x()}, seedOf(path.seed, "azimuth"), t),
                  brownian.at({path.angles.y(), path.rates.y()}, seedOf(path.seed, "elevation"), t));
}

AngularMotion motionAt(const AngularRoute& route, double time) {
  const Passage<2> passage = passageAt(route, time);
  return {passage.place, passage.rate};
}

AngularState onSphere(const AngularMotion& motion) {
  double azimuth = motion.angles.x(), elevation = wrapAngle(motion.angles.y());
  double elevation_rate = motion.rates.y();
  if (std::abs(elevation) > kPi / 2.0) {  // over the pole: seen on the other side, moving the other way
    azimuth += kPi;
    elevation = std::copysign(kPi, elevation) - elevation;
    elevation_rate = -elevation_rate;
  }
  AngularState state;
  state.mean << wrapAngle(azimuth), elevation, motion.rates.x(), elevation_rate;
  return state;
}

std::optional<Refusal> refusalOf(const Sinusoid& sinusoid) {
  const bool finite = sinusoid.amplitude.allFinite() && sinusoid.frequency.allFinite() &&
                      sinusoid.phase.allFinite() && sinusoid.offset.allFinite();
  if (!finite) return Refusal{"sinusoid", "every parameter of a sinusoid must be finite"};
  return std::nullopt;
}

std::optional<Refusal> refusalOf(const AngularLine& line) {
  if (!line.angles.allFinite() || !line.rates.allFinite())
    return Refusal{"line", "angles and rates of a line must be finite"};
  return std::nullopt;
}

std::optional<Refusal> refusalOf(const Weave& weave) {
  if (!weave.angles.allFinite() || !weave.rates.allFinite())
    return Refusal{"weave", "angles and rates of a weave must be finite"};
  if (auto refusal = refusalOfPieces(weave.azimuth)) return Refusal{"weave", "azimuth: " + refusal->detail};
  if (auto refusal = refusalOfPieces(weave.elevation))
    return Refusal{"weave", "elevation: " + refusal->detail};
  return std::nullopt;
}

std::optional<Refusal> refusalOf(const WhiteAcceleration& path) {
  if (path.density >= 0.0 && std::isfinite(path.density)) return std::nullopt;
  std::ostringstream why;
  why << "the density of a white acceleration must be at least 0 rad^2/s^3, got " << path.density;
  return Refusal{"white acceleration", why.str()};
}

}  // namespace sightline::core
