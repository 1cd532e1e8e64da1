#include "sightline/report/sensor_text.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace sightline::report {
namespace {

constexpr double kLeastLooks = 30.0;  // at mature targets, below which their share is not given

/// A stamp as seconds to the millisecond.
std::string stampOf(core::Time time) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(3) << core::seconds(time.time_since_epoch());
  return text.str();
}

/// Verdict, size and reason.
std::string findingOf(const core::HealthChange& change) {
  std::ostringstream text;
  text << std::setprecision(3);
  switch (change.verdict) {
    case core::SensorVerdict::healthy:
      return "is as it states again";
    case core::SensorVerdict::noisy:
      text << "noise has grown to " << std::sqrt(change.scale) << " times its stated sigma";
      break;
    case core::SensorVerdict::biased:
      text << "off by (" << change.bias(0) << ", " << change.bias(change.bias.size() - 1)
           << ") sigma in (azimuth, elevation) from what the others see";
      break;
  }
  text << ", since " << stampOf(change.began);
  return text.str();
}

std::string consequenceOf(core::SensorVerdict verdict, bool undecided) {
  if (undecided) return "nothing is done: only one other sensor sees the target, and either may be to blame";
  switch (verdict) {
    case core::SensorVerdict::healthy:
      return "used as it states";
    case core::SensorVerdict::noisy:
      return "used with that noise";
    case core::SensorVerdict::biased:
      return "not used";
  }
  return "";
}

}  // namespace

std::string textOf(const core::SensorChange& change) {
  return "sensor \"" + change.sensor + "\" " + findingOf(change.change) + " (noticed at " +
         stampOf(change.change.time) + "): " + consequenceOf(change.change.verdict, change.undecided);
}

std::string textOf(const core::CalibratedDetection& sensor) {
  std::ostringstream words;
  words << std::setprecision(2);
  if (sensor.looked >= kLeastLooks)
    words << 100.0 * sensor.seen / sensor.looked << " % of settled targets seen, ";
  words << sensor.clutter / std::max(sensor.scans, 1.0) << " false sightings a scan";
  return words.str();
}

std::string textOf(const core::CalibratedSensor& sensor) {
  std::ostringstream text;
  text << std::setprecision(2) << std::sqrt(sensor.scale) << " times the stated sigma (from " << std::fixed
       << std::setprecision(0) << sensor.sightings << " sightings)";
  return text.str();
}

std::string clockTextOf(const core::WatchedSensor& sensor) {
  if (!sensor.clock) return "";
  std::ostringstream text;
  text << std::setprecision(3) << "clock of " << sensor.sensor << " is " << std::abs(sensor.clock->behind)
       << " +- " << sensor.clock->sigma << " s " << (sensor.clock->behind > 0.0 ? "behind" : "ahead of")
       << (sensor.clock_undecided ? " the other's, either of the two may be wrong" : " the others'")
       << ": its sightings are used with a variance grown by what the target moves in that time";
  return text.str();
}

std::string textOf(const core::WatchedSensor& sensor) {
  if (!sensor.last) return "healthy";
  std::string words = findingOf(*sensor.last);
  if (sensor.verdict == core::SensorVerdict::healthy)
    return "healthy, recovered at " + stampOf(sensor.last->time);
  if (sensor.verdict == core::SensorVerdict::noisy && !sensor.undecided) {
    std::ostringstream now;
    now << std::setprecision(3) << ", now " << std::sqrt(sensor.noise_scale) << " times";
    words += now.str();
  }
  return words + ": " + consequenceOf(sensor.verdict, sensor.undecided);
}

}  // namespace sightline::report
