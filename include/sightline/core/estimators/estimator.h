#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/model/sighting.h"
#include "sightline/core/model/sphere.h"
#include "sightline/core/model/time.h"

namespace sightline::core {

/// A sighting as an estimator sees it: in the chart of its track.
struct Measurement {
  Time time{};
  Eigen::Vector2d position = Eigen::Vector2d::Zero();        ///< (azimuth, elevation) in the chart [rad]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< of `position` [rad^2]
  double ifov = std::numeric_limits<double>::quiet_NaN();    ///< of the sensor [rad], NaN = not known
  double sightings = 1.0;  ///< how many of the sensor's sightings were summed up in this one, > 0
  bool is_certain = true;  ///< false: several sightings that may be the target's, joined: its scatter and its
                           ///< covariance tell nothing of the sensor's noise
};

/// The same sighting in a chart whose frame is turned by R_new_old.
Measurement rotate(const Measurement& measurement, const Eigen::Matrix3d& R_new_old);

/// `angle` plus so many whole turns as bring it within half a turn of `other` [rad].
double nextTo(double other, double angle);

/// The same window of sightings, oldest first, in a chart whose frame is turned by R_new_old. A target may
/// have gone round its sensor within it: azimuths go on from that of the newest sighting, beyond +-pi as
/// well.
void rotate(std::vector<Measurement>& window, const Eigen::Matrix3d& R_new_old);

/// One of the motions between which an estimator has not decided.
struct Hypothesis {
  double probability = 1.0;
  AngularState state;
};

/// The one virtual interface: sightings of one target in, its motion out. Coordinates are those of the
/// track's chart throughout; time only moves forward (late data are put in their place by the tracker).
class Estimator {
 public:
  Estimator() = default;
  virtual ~Estimator() = default;
  Estimator& operator=(const Estimator&) = delete;

  /// A copy with its whole memory, for going back in time.
  virtual std::unique_ptr<Estimator> clone() const = 0;

  /// Takes a sighting of the target; its time is not before that of the last one. Equal times are welcome.
  virtual void update(const Measurement& measurement) = 0;

  /// Motion expected at `time`, usually at or after the last sighting; nullopt before the first sighting.
  /// The covariance is symmetric positive definite.
  virtual std::optional<AngularState> stateAt(Time time) const = 0;

  /// The mixture of which `stateAt` gives mean and covariance; the probabilities sum to one. After a silence
  /// one normal distribution is a poor picture of it: models of an agile target, improbable as they are, make
  /// its covariance. Empty before the first sighting.
  virtual std::vector<Hypothesis> hypothesesAt(Time time) const;

  /// Whether anything is known of the target's rates; not while one instant has been seen and no prior is
  /// given. Until then the covariance of `stateAt` says what is not known by one normal distribution, which
  /// is a poor picture of it: see rate_prior.
  virtual bool knowsRates() const = 0;

  /// Variance of the sightings' white noise over the stated one in each coordinate, as far as the estimator
  /// has learnt it [1]: see `noiseCovariance`.
  virtual Eigen::Vector2d noiseScale() const { return Eigen::Vector2d::Ones(); }

  /// Whether the noise scale is learnt from the next sighting on; what has been learnt of it is forgotten, so
  /// that without learning the stated covariances count. Nothing to do where it is not learnt at all.
  virtual void learnNoise(bool /*enabled*/) {}

  /// Goes over to a chart whose frame is turned by R_new_old.
  virtual void rotate(const Eigen::Matrix3d& R_new_old) = 0;

 protected:
  Estimator(const Estimator&) = default;
};

/// What is known of a target seen once: the sighting's position, no motion but the prior's.
/// `rate_sigma`: standard deviation of each rate before anything is known [rad/s].
AngularState firstState(const Measurement& measurement, double rate_sigma);

/// The state of a window with the prior of its rates taken in, zero with standard deviation `rate_sigma`
/// [rad/s], where the sightings are too few or too close in time to tell the rates better than that. Only for
/// a window of less than twenty sightings and half a second: after that a target must not be held back by
/// what was expected of it at first. `sightings`: number in the window, `span`: time from the first to the
/// last [s].
AngularState withRatePrior(AngularState state, double rate_sigma, std::size_t sightings, double span);

}  // namespace sightline::core
