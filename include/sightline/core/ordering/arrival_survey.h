#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "sightline/core/model/time.h"

namespace sightline::core {

/// How the scans of a recording came in, which is known only when all of it has been looked at.
struct ArrivalPlan {
  /// By sensor: how much later than the median sensor's its scans usually came, after their stamps [s]. None
  /// for a sensor that differs by more than the survey's `most`: its clock is off.
  std::map<std::string, double> delays;
  double jitter = 0.0;  ///< by how much the latency of a sensor changes from scan to scan, 95 %, largest [s]
  double ahead = 0.0;  ///< by how much the stamps of most are ahead of the clock of arrival at most [s], >= 0

  /// That of a sensor; 0 when there is none.
  double delayOf(const std::string& sensor) const;
  double longestDelay() const;
};

/// Looks at stamps and times of arrival of a whole recording. A sensor's latency is compared with that of
/// another one at the same moment, so that neither a recording that starts again nor one that is played at
/// another speed counts as latency. The memory is bounded.
class ArrivalSurvey {
 public:
  /// `most`: delay up to which a sensor is late, and its clock not off [s], > 0.
  explicit ArrivalSurvey(double most) : most_(most) {}

  /// The next scan, in the order of arrival.
  void take(const std::string& sensor, Time stamp, Time received);

  ArrivalPlan plan() const;

 private:
  struct Sample {
    Time received{};
    double latency = 0.0;  // [s]
    double change = 0.0;   // of the latency, since the scan before, as a size [s]
  };
  /// Samples evenly over the recording: every `every`th scan.
  struct Sensor {
    std::vector<Sample> samples;
    std::size_t every = 1, scans = 0;
    double last_latency = 0.0;  // [s]
  };

  const Sensor* reference() const;
  static double delayBetween(const Sensor& sensor, const Sensor& reference);

  double most_;
  std::map<std::string, Sensor> sensors_;
};

}  // namespace sightline::core
