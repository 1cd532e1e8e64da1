#pragma once

#include <array>
#include <string>
#include <vector>

#include "baselines.h"
#include "scenarios.h"

/// Contenders over many runs of a scenario, on several threads; the figures do not depend on how many.
namespace sightline::bench {

struct Options;

/// One value for each run, all runs independent: the mean and how far chance may have moved it.
class Sample {
 public:
  explicit Sample(std::vector<double> values = {}) : values_(std::move(values)) {}
  const std::vector<double>& values() const { return values_; }
  double mean() const;
  /// Standard error of the mean.
  double standardError() const;
  double root() const;
  /// Half width of the 95 % band of the mean, and of its root.
  double band() const { return 1.96 * standardError(); }
  double rootBand() const { return band() / (2.0 * root()); }

 private:
  std::vector<double> values_;
};

/// Quotient of the roots of two samples' means, run by run from the same sightings, with the 95 % band of its
/// logarithm (which is, small, the relative one).
struct Ratio {
  double value = 0.0;
  double log_band = 0.0;
};
Ratio rootRatio(const Sample& numerator, const Sample& denominator);
/// Of ratios from independent runs.
Ratio geometricMean(const std::vector<Ratio>& ratios);

/// Instants at which consistency is looked at: every 0.1 s from 1 s on.
constexpr int kCheckpoints = 91;
using Checkpoints = std::array<double, kCheckpoints>;

/// Figures of one contender over t in (1, 10] s, both channels.
struct Score {
  std::string name;
  Sample estimate,
      prediction;  ///< mean squared errors [rad^2]; where nothing is seen the estimate is predicted
  Sample nees_position, nees_state;  ///< normalised by 2 and by 4
  Sample gap, gap_nees;  ///< squared position error predicted across the dropout [rad^2], and normalised
  Checkpoints position_at{}, state_at{};  ///< normalised squared errors there, mean over runs
};

/// Every contender over the same runs.
std::vector<Score> evaluate(const Scenario& scenario, const Sensors& sensors,
                            const std::vector<Contender>& contenders, const Options& options);

/// Index of the smallest root mean square error.
std::size_t bestOf(const std::vector<Score>& scores);

}  // namespace sightline::bench
