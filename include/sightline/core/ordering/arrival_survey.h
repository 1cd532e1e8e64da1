#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sightline/core/model/time.h"

namespace sightline::core {

/// How the scans of a recording came in, which is known only when all of it has been looked at.
struct ArrivalPlan {
  /// By sensor: how much later than the others' its scans usually came, after their stamps [s]. None for a
  /// sensor that differs by more than the survey's `most`: its clock is off.
  std::map<std::string, double> delays;
  double jitter = 0.0;  ///< by how much the latency of a sensor changes from scan to scan, 95 %, largest [s]
  double ahead = 0.0;  ///< by how much the stamps of most are ahead of the clock of arrival at most [s], >= 0

  /// That of a sensor; 0 when there is none.
  double delayOf(const std::string& sensor) const;
  double longestDelay() const;
};

/// Looks at stamps and times of arrival of a whole recording. A sensor's latency is compared with the median
/// of all sensors' at that moment, so that neither a recording that starts again nor one that is played at
/// another speed counts as latency. The memory is bounded.
class ArrivalSurvey {
 public:
  /// `most`: delay up to which a sensor is late, and its clock not off [s], > 0.
  explicit ArrivalSurvey(double most) : most_(most) {}

  /// The next scan, in the order of arrival.
  void take(const std::string& sensor, Time stamp, Time received);

  ArrivalPlan plan() const;

 private:
  /// Values evenly over the recording: every `every`th one.
  class Samples {
   public:
    void add(double value);
    std::optional<double> quantile(double p) const;

   private:
    std::vector<double> values_;
    std::size_t every_ = 1, count_ = 0;
  };
  struct Sensor {
    double latency = 0.0;  // the last one [s]
    std::size_t scans = 0;
    Samples delays;   // against the others [s]
    Samples changes;  // of the latency, from scan to scan [s]
  };

  double usualLatency() const;

  double most_;
  std::map<std::string, Sensor> sensors_;
  Samples latencies_;  // the usual ones of all sensors [s]
};

}  // namespace sightline::core
