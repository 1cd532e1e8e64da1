#include "sightline/core/simulation/route.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kClosed = 1e-9;  // [unit of place]: the last waypoint of a loop is the first

Eigen::Vector3d difference(const Eigen::Vector3d& to, const Eigen::Vector3d& from) {
  return to - from;
}
Eigen::Vector2d difference(const Eigen::Vector2d& to, const Eigen::Vector2d& from) {
  return angleDifference(to, from);
}

/// The pieces between waypoints, counted 0 .. size - 2; on a loop they go round.
template <int N>
class Legs {
 public:
  using Place = Eigen::Matrix<double, N, 1>;

  explicit Legs(const Route<N>& route) : route_(route), last_(static_cast<int>(route.points.size()) - 2) {}

  double length(int leg) const { return point(leg + 1).time - point(leg).time; }  // [s]
  Place step(int leg) const { return difference(point(leg + 1).place, point(leg).place); }
  Place secant(int leg) const { return step(leg) / length(leg); }

  /// (S-88): rate at the start of a leg, of the parabola through the waypoint and its neighbours. An open
  /// route starts and ends with the rate of its first and last secant.
  Place tangent(int leg) const {
    const bool first = leg == 0, beyond = leg == last_ + 1;
    if (!route_.loop && first) return secant(0);
    if (!route_.loop && beyond) return secant(last_);
    const int before = first ? last_ : leg - 1, after = beyond ? 0 : leg;
    const double h_before = length(before), h_after = length(after);
    return (h_after * secant(before) + h_before * secant(after)) / (h_before + h_after);
  }

  int legAt(double time) const {
    const auto later = std::upper_bound(route_.points.begin(), route_.points.end(), time,
                                        [](double t, const Waypoint<N>& p) { return t < p.time; });
    return std::clamp(static_cast<int>(later - route_.points.begin()) - 1, 0, last_);
  }

  const Waypoint<N>& point(int index) const { return route_.points[static_cast<std::size_t>(index)]; }
  const Waypoint<N>& end() const { return route_.points.back(); }
  int last() const { return last_; }

 private:
  const Route<N>& route_;
  int last_;
};

/// (S-88): cubic Hermite interpolation from the start of a leg.
template <int N>
Passage<N> onLeg(const Legs<N>& legs, int leg, double time) {
  const double h = legs.length(leg), u = (time - legs.point(leg).time) / h;
  const auto step = legs.step(leg);
  const auto m0 = legs.tangent(leg), m1 = legs.tangent(leg + 1);
  Passage<N> passage;
  passage.place = legs.point(leg).place + u * u * (3.0 - 2.0 * u) * step +
                  h * u * ((1.0 - u) * (1.0 - u) * m0 - u * (1.0 - u) * m1);
  passage.rate = 6.0 * u * (1.0 - u) / h * step + (1.0 - u) * (1.0 - 3.0 * u) * m0 + u * (3.0 * u - 2.0) * m1;
  return passage;
}

template <int N>
Passage<N> straightFrom(const Waypoint<N>& point, const Eigen::Matrix<double, N, 1>& rate, double time) {
  return {point.place + (time - point.time) * rate, rate};
}

}  // namespace

template <int N>
Passage<N> passageAt(const Route<N>& route, double time) {
  const Legs<N> legs(route);
  const double start = legs.point(0).time, end = legs.end().time;
  if (route.loop) {
    const double round = std::fmod(time - start, end - start);
    time = start + (round < 0.0 ? round + (end - start) : round);
  }
  if (time < start) return straightFrom<N>(legs.point(0), legs.tangent(0), time);
  if (time > end) return straightFrom<N>(legs.end(), legs.tangent(legs.last() + 1), time);
  return onLeg(legs, legs.legAt(time), time);
}

template <int N>
std::optional<Refusal> refusalOf(const Route<N>& route) {
  std::ostringstream why;
  const std::size_t least = route.loop ? 3 : 2;
  if (route.points.size() < least) {
    why << "a " << (route.loop ? "loop" : "route") << " needs at least " << least << " waypoints, got "
        << route.points.size();
    return Refusal{"route", why.str()};
  }
  for (std::size_t i = 1; i < route.points.size(); ++i) {
    if (route.points[i].time > route.points[i - 1].time) continue;
    why << "waypoint times must ascend: waypoint " << i + 1 << " at " << route.points[i].time << " s follows "
        << route.points[i - 1].time << " s";
    return Refusal{"route", why.str()};
  }
  if (route.loop && difference(route.points.back().place, route.points.front().place).norm() > kClosed) {
    return Refusal{
        "route",
        "the last waypoint of a loop must be the place of the first: repeat it at the end, or set loop to "
        "false"};
  }
  return std::nullopt;
}

template Passage<2> passageAt(const Route<2>&, double);
template Passage<3> passageAt(const Route<3>&, double);
template std::optional<Refusal> refusalOf(const Route<2>&);
template std::optional<Refusal> refusalOf(const Route<3>&);

}  // namespace sightline::core
