#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/model/sighting.h"
#include "sightline/core/model/time.h"

#include "fuzz/random_input.h"

namespace sightline_fuzz {

/// How much of what a case feeds is not what it should be.
struct Hazards {
  double values = 0.0;     ///< share of the numbers that are absurd
  double times = 0.0;      ///< share of the scans that come late, twice, or after a leap
  double floods = 0.0;     ///< share of the scans that have very many sightings
  double newcomers = 0.0;  ///< share of the scans of a sensor with a name never used before
};

Hazards randomHazards(RandomInput& input);

/// Scans of several sensors of some targets that move, with noise, misses, clutter, and hazards.
class RandomScans {
 public:
  RandomScans(RandomInput& input, const Hazards& hazards);

  sightline::core::Scan next();

  std::size_t sensors() const { return sensors_.size(); }
  sightline::core::Time time() const { return now_; }

  /// Direction (azimuth, elevation) of target `k`, counted round, now [rad].
  Eigen::Vector2d targetAt(std::size_t k, sightline::core::Time time) const;
  Eigen::Vector2d ratesOf(std::size_t k) const;

 private:
  struct Target {
    Eigen::Vector2d angles, rates;
    double wave = 0.0, frequency = 1.0;  // of the azimuth [rad, 1/s]
  };
  struct Sensor {
    std::string name;
    double interval = 0.03, sigma = 1e-3, detection = 0.9, clutter = 0.0;  // [s], [rad], share, a scan
    double shape = 1.0;                                                    // sigma of the elevation over it
    double states = 1.0;                                                   // stated sigma over the true one
    double ifov = 0.0;
    bool has_view = false, is_biased = false;
    sightline::core::Time next{};
  };

  sightline::core::Scan scanOf(const Sensor& sensor);
  void addSighting(sightline::core::Scan& scan, const Sensor& sensor, const Eigen::Vector2d& angles);
  void addFlood(sightline::core::Scan& scan, const Sensor& sensor);

  RandomInput& input_;
  Hazards hazards_;
  sightline::core::Time begin_{}, now_{};
  std::vector<Target> targets_;
  std::vector<Sensor> sensors_;
  std::vector<sightline::core::Scan> past_;  // the last ones
  std::size_t newcomers_ = 0;
};

}  // namespace sightline_fuzz
