#include "sightline/core/ordering/arrival_survey.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sightline::core {
namespace {

constexpr std::size_t kMostSamples = 4096;
constexpr std::size_t kMostSurveyed = 1000;
constexpr double kFewest = 0.01;  // share of the scans that may be ahead by more than `ahead`
constexpr double kUsual = 0.95;   // share of the changes that are no larger than the jitter

/// Of values, of which there is one at least: that which a share `p` does not exceed; of two neighbours the
/// upper.
double quantile(std::vector<double> values, double p) {
  const auto place =
      values.begin() + static_cast<std::ptrdiff_t>(std::ceil(p * static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

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

void ArrivalSurvey::take(const std::string& name, Time stamp, Time received) {
  if (sensors_.size() >= kMostSurveyed && sensors_.count(name) == 0) return;
  Sensor& sensor = sensors_[name];
  const double latency = seconds(received - stamp);
  const double change = sensor.scans == 0 ? 0.0 : std::abs(latency - sensor.last_latency);
  sensor.last_latency = latency;
  if (sensor.scans++ % sensor.every != 0) return;
  auto& samples = sensor.samples;
  samples.push_back({received, latency, change});
  if (samples.size() < kMostSamples) return;
  for (std::size_t k = 0; 2 * k < samples.size(); ++k) samples[k] = samples[2 * k];
  samples.resize((samples.size() + 1) / 2);
  sensor.every *= 2;
}

/// The one with the most scans.
const ArrivalSurvey::Sensor* ArrivalSurvey::reference() const {
  const auto most = std::max_element(sensors_.begin(), sensors_.end(), [](const auto& a, const auto& b) {
    return a.second.scans < b.second.scans;
  });
  return most == sensors_.end() ? nullptr : &most->second;
}

/// Of the one sensor's latency over the other's at the sample before, or at the first one.
double ArrivalSurvey::delayBetween(const Sensor& sensor, const Sensor& reference) {
  std::vector<double> delays;
  delays.reserve(sensor.samples.size());
  std::size_t other = 0;
  for (const Sample& sample : sensor.samples) {
    while (other + 1 < reference.samples.size() && reference.samples[other + 1].received <= sample.received)
      ++other;
    delays.push_back(sample.latency - reference.samples[other].latency);
  }
  return quantile(std::move(delays), 0.5);
}

ArrivalPlan ArrivalSurvey::plan() const {
  const Sensor* const reference = this->reference();
  if (reference == nullptr) return {};
  std::vector<double> all, latencies;
  for (const auto& [name, sensor] : sensors_) all.push_back(delayBetween(sensor, *reference));
  for (const Sample& sample : reference->samples) latencies.push_back(sample.latency);
  std::vector<double> sorted = all;
  std::sort(sorted.begin(), sorted.end());
  const double median = sorted[(sorted.size() - 1) / 2];  // of two the earlier one's

  ArrivalPlan plan;
  auto delay = all.begin();
  for (const auto& [name, sensor] : sensors_) {
    if (std::abs(*delay - median) <= most_) plan.delays[name] = *delay - median;
    ++delay;
    std::vector<double> changes;
    for (const Sample& sample : sensor.samples) changes.push_back(sample.change);
    plan.jitter = std::max(plan.jitter, std::min(most_, quantile(std::move(changes), kUsual)));
  }
  plan.ahead = std::max(0.0, -(quantile(std::move(latencies), kFewest) + median));
  return plan;
}

}  // namespace sightline::core
