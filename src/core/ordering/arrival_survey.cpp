#include "sightline/core/ordering/arrival_survey.h"

#include <algorithm>
#include <cmath>

namespace sightline::core {
namespace {

constexpr std::size_t kMostSamples = 4096;
constexpr std::size_t kMostSensors = 1000;
constexpr double kFewest = 0.01;  // share of the scans that may be ahead by more than `ahead`

}  // namespace

double ArrivalPlan::delayOf(const std::string& sensor) const {
  const auto found = delays.find(sensor);
  return found == delays.end() ? 0.0 : found->second;
}

double ArrivalPlan::longestDelay() const {
  double longest = 0.0;
  for (const auto& [sensor, delay] : delays) longest = std::max(longest, delay);
  return longest;
}

void ArrivalSurvey::Samples::add(double value) {
  if (count_++ % every_ != 0) return;
  values_.push_back(value);
  if (values_.size() < kMostSamples) return;
  for (std::size_t k = 0; 2 * k < values_.size(); ++k) values_[k] = values_[2 * k];
  values_.resize((values_.size() + 1) / 2);
  every_ *= 2;
}

/// Of two neighbours the upper.
std::optional<double> ArrivalSurvey::Samples::quantile(double p) const {
  if (values_.empty()) return std::nullopt;
  std::vector<double> sorted = values_;
  const auto place =
      sorted.begin() + static_cast<std::ptrdiff_t>(std::ceil(p * static_cast<double>(sorted.size() - 1)));
  std::nth_element(sorted.begin(), place, sorted.end());
  return *place;
}

void ArrivalSurvey::take(const std::string& sensor, Time stamp, Time received) {
  if (sensors_.size() >= kMostSensors && sensors_.count(sensor) == 0) return;
  const double latency = seconds(received - stamp);
  Sensor& known = sensors_[sensor];
  if (known.scans++ > 0) known.changes.add(std::abs(latency - known.latency));
  known.latency = latency;
  const double usual = usualLatency();
  known.delays.add(latency - usual);
  latencies_.add(usual);
}

/// The median of the sensors' last ones; of an even number the lower.
double ArrivalSurvey::usualLatency() const {
  std::vector<double> last;
  last.reserve(sensors_.size());
  for (const auto& [name, sensor] : sensors_) last.push_back(sensor.latency);
  const auto middle = last.begin() + static_cast<std::ptrdiff_t>((last.size() - 1) / 2);
  std::nth_element(last.begin(), middle, last.end());
  return *middle;
}

ArrivalPlan ArrivalSurvey::plan() const {
  ArrivalPlan plan;
  for (const auto& [name, sensor] : sensors_) {
    const double delay = sensor.delays.quantile(0.5).value_or(0.0);
    if (std::abs(delay) <= most_) plan.delays[name] = delay;
    plan.jitter = std::max(plan.jitter, std::min(most_, sensor.changes.quantile(0.95).value_or(0.0)));
  }
  plan.ahead = std::max(0.0, -latencies_.quantile(kFewest).value_or(0.0));
  return plan;
}

}  // namespace sightline::core
