#include "sightline/ros/diagnosis/sensor_record.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "sightline/core/model/chi_square.h"
#include "sightline/core/model/sighting.h"
#include "sightline/report/value_text.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/messages/framed_scan.h"

namespace sightline_ros {

namespace core = sightline::core;
using sightline::report::valueOf;

namespace {

constexpr std::size_t kMostFrames = 8;    // that are remembered
constexpr std::size_t kLeastScans = 10;   // below, rates and delays are not reported
constexpr double kOtherTime = 600.0;      // behind the clock: the stamps are of another time [s]
constexpr double kBackStep = 0.25;        // that is no mere change of order [s]
constexpr double kShare = 0.05;           // of the scans that may be odd
constexpr double kGap = 0.5;              // silence that is reported [s] ...
constexpr double kUsualIntervals = 10.0;  // ... when it is so many usual intervals
constexpr double kOffInnovations = 3.0;   // median over that
constexpr std::size_t kLeastInnovations = 30;

}  // namespace

void SensorRecord::take(const sightline::SightingArray& scan, core::Time arrival) {
  ++scans_;
  sightings_ += scan.sightings.size();
  empty_ += scan.sightings.empty() ? 1 : 0;
  if (frames_.size() < kMostFrames) frames_.insert(scan.header.frame_id);
  if (const auto refusal = refusalOf(scan)) {
    Counted& counted = refused_scans_[refusal->kind];
    if (counted.count++ == 0) counted.first = refusal->detail;
  }
  if (!scan.header.stamp.isZero()) takeStamp(toCore(scan.header.stamp), arrival);
  takeSightings(scan);
}

void SensorRecord::takeStamp(core::Time stamp, core::Time arrival) {
  if (arrival != core::Time{}) latencies_.add(core::seconds(arrival - stamp));
  if (stamped_++ > 0) {
    const double step = core::seconds(stamp - last_stamp_);
    if (step > 0.0) intervals_.add(step);
    longest_gap_ = std::max(longest_gap_, core::seconds(stamp - newest_stamp_));
    back_ += step < 0.0 ? 1 : 0;
    farthest_back_ = std::max(farthest_back_, -step);
    repeated_ += step == 0.0 ? 1 : 0;
  }
  last_stamp_ = stamp;
  newest_stamp_ = std::max(newest_stamp_, stamp);
}

void SensorRecord::takeSightings(const sightline::SightingArray& scan) {
  for (const sightline::Sighting& sighting : scan.sightings) {
    const Eigen::Vector2d angles(sighting.azimuth, sighting.elevation);
    const Eigen::Matrix2d covariance =
        Eigen::Map<const Eigen::Matrix<double, 2, 2, Eigen::RowMajor>>(sighting.covariance.data());
    if (const auto why = core::rejectionOf(angles, covariance)) {
      if (refused_sightings_.count++ == 0) refused_sightings_.first = why->detail;
      continue;
    }
    sigmas_.add(std::sqrt(covariance.trace() / 2.0));
  }
}

std::vector<Finding> SensorRecord::findings(const std::string& subject, const InputLimits& limits) const {
  std::vector<Finding> found;
  const auto report = [&](const std::optional<std::string>& text) {
    if (text) found.push_back({subject, *text});
  };
  for (const auto& [reason, counted] : refused_scans_) report(count(counted.count) + ": " + counted.first);
  if (refused_sightings_.count > 0) {
    report(std::to_string(refused_sightings_.count) + " of " + std::to_string(sightings_) +
           " sightings cannot be used, the first because its " + refused_sightings_.first);
  }
  if (const auto text = emptyText()) found.push_back({subject, *text, true});
  if (scans_ < kLeastScans) return found;
  report(latencyText(limits));
  report(stampText(limits));
  report(duplicateText());
  report(gapText());
  report(innovationText());
  return found;
}

std::string SensorRecord::count(std::size_t number) const {
  return std::to_string(number) + " of " + std::to_string(scans_) + " scans";
}

std::optional<std::string> SensorRecord::latencyText(const InputLimits& limits) const {
  if (latencies_.size() < kLeastScans) return std::nullopt;
  const double usual = *latency(0.5), late = *latency(0.95), early = *latency(0.05);
  const std::string of = " (median of " + std::to_string(latencies_.size()) + " scans)";
  if (usual < -limits.max_future) {
    return "its stamps are " + valueOf(-usual, "s") + " ahead of the clock" + of +
           ": trackers drop what is more than " + valueOf(limits.max_future, "s") +
           " ahead (max_future); synchronise the sensor's clock, or correct the stamps in its driver";
  }
  if (early < -limits.max_future) {
    return "some of its stamps are ahead of the clock, by up to " + valueOf(-*latency(0.0), "s") +
           ": its clock steps or is not synchronised; trackers drop such scans (max_future)";
  }
  if (usual > kOtherTime) {
    return "its stamps are " + valueOf(usual, "s") + " behind the clock" + of +
           ", of another time: play recordings with --clock and use_sim_time, or synchronise the sensor's "
           "clock";
  }
  if (usual > limits.max_lag) {
    return "its stamps are " + valueOf(usual, "s") + " behind the clock" + of +
           ": what is more than max_lag (" + valueOf(limits.max_lag, "s") +
           ") behind other sensors is dropped; synchronise its clock, shorten the way to the tracker, or "
           "raise "
           "max_lag";
  }
  if (late - usual > limits.max_lag) {
    return "its scans come after " + valueOf(usual, "s") + " mostly, but one in twenty after more than " +
           valueOf(late, "s") + ": the network or the driver holds them up; beyond max_lag (" +
           valueOf(limits.max_lag, "s") + ") they are dropped";
  }
  return std::nullopt;
}

std::optional<std::string> SensorRecord::stampText(const InputLimits& limits) const {
  const bool is_often = static_cast<double>(back_) > kShare * static_cast<double>(stamped_);
  if (back_ == 0 || (farthest_back_ <= std::max(kBackStep, limits.max_lag) && !is_often)) return std::nullopt;
  return count(back_) + " are stamped before the one that came before them, by up to " +
         valueOf(farthest_back_, "s") +
         ": two sensors under one name, a clock that steps, or a recording in a loop";
}

std::optional<std::string> SensorRecord::duplicateText() const {
  if (static_cast<double>(repeated_) <= kShare * static_cast<double>(stamped_)) return std::nullopt;
  const std::size_t distinct = std::max<std::size_t>(1, stamped_ - repeated_);
  return count(repeated_) + " repeat the stamp of the one before (" +
         valueOf(static_cast<double>(stamped_) / static_cast<double>(distinct), "scans") +
         " share each stamp): an exposure is one message, with its own stamp, and errors look like motion "
         "where "
         "stamps are wrong; duplicates are dropped. Two publishers of the same topic, or stamps that are too "
         "coarse "
         "(rounded to whole seconds?)";
}

std::optional<std::string> SensorRecord::gapText() const {
  const auto usual = interval(0.5);
  if (!usual || longest_gap_ <= std::max(kGap, kUsualIntervals * *usual)) return std::nullopt;
  return "was silent for up to " + valueOf(longest_gap_, "s") + ", where a scan comes every " +
         valueOf(*usual, "s") +
         ": silence says nothing; publish an empty scan when nothing is seen, or see why the driver pauses";
}

std::optional<std::string> SensorRecord::emptyText() const {
  if (scans_ < kLeastScans || empty_ < scans_) return std::nullopt;
  return "saw nothing in " + std::to_string(scans_) +
         " scans: is the cap on, the threshold too high, or does it look elsewhere?";
}

std::optional<std::string> SensorRecord::innovationText() const {
  if (innovations_.size() < kLeastInnovations) return std::nullopt;
  const double off = *innovations_.quantile(0.5) / core::kChiSquareMedian2;
  if (off < kOffInnovations) return std::nullopt;
  return "its innovations are " + valueOf(std::sqrt(off), "times") +
         " what the tracker expects (normalised innovation squared " + valueOf(2.0 * off, "instead of 2") +
         "): its covariance is too small, or it is misaligned";
}

}  // namespace sightline_ros
