#pragma once

namespace sightline::core {

/// Sightings closer than this [s] are of one instant: they determine no rate.
constexpr double kSameTime = 1e-6;

/// The usual time between the sightings of one target, and the unit of time in which the motion of a target
/// that is seen at such a pace is described (S-91): one second, or three intervals where these are longer.
/// Settings in that unit serve a camera and a telescope that looks every ten minutes. Plain state.
class RevisitTime {
 public:
  /// A sighting comes `h` seconds after the last one; sightings of one instant do not count.
  void note(double h);

  bool isKnown() const { return usual_ > 0.0; }

  /// The usual interval [s]; 0 before the second sighting.
  double usual() const { return usual_; }

  /// The unit of time for a prediction `h` seconds ahead [s]: before the second sighting `h` itself is the
  /// interval.
  double unit(double h) const;

 private:
  double usual_ = 0.0;
};

}  // namespace sightline::core
