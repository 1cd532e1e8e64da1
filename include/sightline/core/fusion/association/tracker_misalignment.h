#pragma once

#include <map>
#include <string>
#include <vector>

/// By how much local trackers are off against one another: boresights that are not quite where they are
/// thought to be. No track's covariance tells, but many targets seen by many trackers do.
namespace sightline::core {

/// A local track against all that other trackers say of its target.
struct Disagreement {
  double distance_squared = 0.0;  ///< between the positions [rad^2]
  double variance = 0.0;          ///< of that in each angle, by both covariances, in the mean [rad^2]
};

/// Learns from report to report.
class TrackerMisalignment {
 public:
  /// `least`: standard deviation of every tracker's misalignment that is allowed for in any case [rad], >= 0.
  explicit TrackerMisalignment(double least) : least_(least) {}

  /// What a tracker's report says, of targets that others see too. Less than three say nothing: one target
  /// that was taken for another would look the same. The median counts.
  void take(const std::string& tracker, const std::vector<Disagreement>& disagreements);

  /// Standard deviation of the tracker's misalignment in each angle [rad].
  double sigma(const std::string& tracker) const;

  /// Of the tracker that is off most [rad].
  double largestSigma() const;

 private:
  double least_;                             // [rad]
  std::map<std::string, double> variances_;  // [rad^2]; at most 256
};

}  // namespace sightline::core
