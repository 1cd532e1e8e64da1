#include "sightline/core/ordering/stamp_watch.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <stdexcept>

namespace sightline::core {
namespace {

constexpr double kLeastJump = 0.25;        // that is no jitter [s]
constexpr double kIntervals = 3.0;         // of a sensor's usual ones that make a silence, or a leap
constexpr double kIntervalMemory = 0.95;   // of the usual largest interval, at each scan
constexpr std::size_t kMostWatched = 256;  // that are watched; of more, the longest silent are forgotten

std::string secondsText(double seconds) {
  std::ostringstream text;
  if (std::abs(seconds) < 1000.0)
    text << std::setprecision(3);
  else
    text << std::fixed << std::setprecision(0);
  text << seconds << " s";
  return text.str();
}

Refusal refusalAhead(const std::string& detail) {
  return {"ahead", detail};
}

}  // namespace

StampWatch::StampWatch(const StampWatchParams& params) : params_(params) {
  if (!(params.max_lag >= 0.0) || !(params.alive > 0.0) || !(params.agreement > 0.0) ||
      params.scans_back < 1 || params.max_held < 1) {
    throw std::invalid_argument(
        "StampWatchParams: max_lag >= 0, alive > 0, agreement > 0, scans_back >= 1 and max_held >= 1 are "
        "required");
  }
  params_.max_lag = std::max(params_.max_lag, kLeastJump);
}

StampJudgement StampWatch::take(std::uint64_t scan, const std::string& sensor, Time stamp,
                                std::optional<Time> clock) {
  StampJudgement result;
  if (sensors_.size() >= kMostWatched && sensors_.count(sensor) == 0) forgetLongestSilent();
  const bool agrees_with_clock = clock && std::abs(seconds(*clock - stamp)) <= params_.agreement;
  const auto [entry, is_new] = sensors_.try_emplace(sensor);
  if (!front_) front_ = stamp;
  const double ahead = seconds(stamp - *front_);
  const bool is_jump = isJump(entry->second, stamp, is_new);
  const bool was_ahead = entry->second.place == Place::held || entry->second.place == Place::ahead;
  const double leeway = was_ahead ? params_.max_lag / 2.0 : params_.max_lag;
  const bool steps_back = seconds(entry->second.newest - stamp) > params_.max_lag;
  const bool stepped_back = is_new || entry->second.behind > 0 || steps_back;
  noteStamp(entry->second, stamp, is_new);
  entry->second.offset = ahead;

  if (ahead < -params_.max_lag) {
    if (steps_back) entry->second.behind = 0;
    if (entry->second.behind == 0) entry->second.front_then = *front_;
    entry->second.behind = stepped_back ? entry->second.behind + 1 : 0;
    takeBehind(scan, sensor, stamp, result);
  } else if (ahead > leeway && (is_jump || was_ahead) && !agrees_with_clock) {
    takeAhead(scan, sensor, stamp, result);
  } else {
    takeOnLine(scan, sensor, stamp, result);
  }
  return result;
}

StampJudgement StampWatch::finish() {
  StampJudgement result;
  for (const Held& held : held_) result.verdicts.push_back({held.scan, std::nullopt});
  held_.clear();
  return result;
}

/// Brings the sensor's own time on. A leap or a pause of its stamps does not count, nor does what comes soon
/// after they went back: stamps that go to and fro would make time fly, and the others silent.
void StampWatch::noteStamp(Sensor& sensor, Time stamp, bool is_new) {
  const double step = seconds(stamp - sensor.newest);
  const bool steps_back = step < -params_.max_lag;
  sensor.steady = is_new ? params_.scans_back : steps_back ? 0 : sensor.steady + 1;
  if (is_new || sensor.steady <= params_.scans_back || step > aliveFor(sensor)) {
    sensor.way = elapsed_;
  } else if (step > 0.0) {
    sensor.way += stamp - sensor.newest;
  }
  if (!is_new && step > 0.0) {  // one long step is a leap or a pause, two are its rate
    sensor.interval = std::max(kIntervalMemory * sensor.interval, std::min(step, sensor.last_step));
    sensor.last_step = step;
  }
  if (is_new || steps_back || step > 0.0) sensor.newest = stamp;
  elapsed_ = std::max(elapsed_, sensor.way);
  sensor.last_received = elapsed_;
}

/// Of those of which no scan is held.
void StampWatch::forgetLongestSilent() {
  auto longest = sensors_.end();
  for (auto it = sensors_.begin(); it != sensors_.end(); ++it) {
    const bool is_earlier =
        longest == sensors_.end() || it->second.last_received < longest->second.last_received;
    if (it->second.place != Place::held && is_earlier) longest = it;
  }
  if (longest != sensors_.end()) sensors_.erase(longest);
}

bool StampWatch::isJump(const Sensor& sensor, Time stamp, bool is_new) const {
  return is_new || seconds(stamp - sensor.newest) > std::max(params_.max_lag, kIntervals * sensor.interval);
}

double StampWatch::aliveFor(const Sensor& sensor) const {
  return std::max(params_.alive, kIntervals * sensor.interval);
}

bool StampWatch::isAlive(const Sensor& sensor) const {
  return seconds(elapsed_ - sensor.last_received) <= aliveFor(sensor);
}

/// Whether a sensor is off the line in that direction, where one with this stamp is.
bool StampWatch::agrees(const Sensor& sensor, Place place, Time stamp) const {
  const bool is_there =
      place == Place::back ? sensor.behind > 0 : sensor.place == Place::held || sensor.place == Place::ahead;
  return is_there && std::abs(seconds(sensor.newest - stamp)) <= params_.agreement;
}

/// Whether more than half of the active sensors are there, with so many scans each on the average.
bool StampWatch::isMajority(Place place, Time stamp, int least_scans) const {
  int alive = 0, there = 0, scans = 0;
  for (const auto& [name, sensor] : sensors_) {
    if (!isAlive(sensor)) continue;
    ++alive;
    if (!agrees(sensor, place, stamp)) continue;
    ++there;
    scans += sensor.behind;
  }
  return 2 * there > alive && scans >= least_scans * there;
}

void StampWatch::takeOnLine(std::uint64_t scan, const std::string& name, Time stamp, StampJudgement& result) {
  resolveHeld(name, stamp, result);
  rejoin(name, sensors_[name], result);
  front_ = std::max(*front_, stamp);
  result.verdicts.push_back({scan, std::nullopt});
}

/// A scan on the line decides about those that are held: it has caught up with them, or shows that time goes
/// on where it was. Scans of a sensor that is on the line again are dropped without a notice.
void StampWatch::resolveHeld(const std::string& name, Time stamp, StampJudgement& result) {
  for (const Held& held : held_) {
    Sensor& sensor = sensors_[held.sensor];
    const double ahead = seconds(held.stamp - stamp);
    if (ahead <= params_.max_lag) {
      result.verdicts.push_back({held.scan, std::nullopt});
      rejoin(held.sensor, sensor, result);
      front_ = std::max(*front_, held.stamp);
      continue;
    }
    result.verdicts.push_back(
        {held.scan,
         refusalAhead("its stamp is " + secondsText(ahead) +
                      " ahead of the others', which go on: synchronise the clock of " + held.sensor)});
    sensor.offset = ahead;
    if (held.sensor != name) reportOff(held.sensor, sensor, Place::ahead, result);
  }
  held_.clear();
}

void StampWatch::takeAhead(std::uint64_t scan, const std::string& name, Time stamp, StampJudgement& result) {
  Sensor& sensor = sensors_[name];
  sensor.behind = 0;
  if (sensor.place != Place::ahead) {
    sensor.place = Place::held;
    held_.push_back({scan, name, stamp});
    if (isMajority(Place::held, stamp, 0)) return goAhead(stamp, result);
    if (held_.size() <= params_.max_held) return;
    result.verdicts.push_back(
        {held_.front().scan, refusalAhead("too many scans are ahead of the other sensors'")});
    held_.erase(held_.begin());
    return;
  }
  if (isMajority(Place::ahead, stamp, 0)) {
    held_.push_back({scan, name, stamp});
    return goAhead(stamp, result);
  }
  result.verdicts.push_back(
      {scan, refusalAhead("its stamp is " + secondsText(sensor.offset) +
                          " ahead of the other sensors', which go on: synchronise the clock of " + name)});
}

/// Most are there: the line goes on from where they are.
void StampWatch::goAhead(Time stamp, StampJudgement& result) {
  for (auto& [name, sensor] : sensors_) {
    if (agrees(sensor, Place::held, stamp)) rejoin(name, sensor, result);
  }
  std::vector<Held> others;
  for (const Held& held : held_) {
    if (std::abs(seconds(held.stamp - stamp)) > params_.agreement) {
      others.push_back(held);
      continue;
    }
    result.verdicts.push_back({held.scan, std::nullopt});
    front_ = std::max(*front_, held.stamp);
  }
  held_ = std::move(others);
}

/// Late scans are the tracker's business, unless most have gone back.
void StampWatch::takeBehind(std::uint64_t scan, const std::string& name, Time stamp, StampJudgement& result) {
  Sensor& sensor = sensors_[name];
  if (sensor.behind > 0 && isMajority(Place::back, stamp, params_.scans_back)) {
    restartLine(name, stamp, result);
  } else if (sensor.behind >= params_.scans_back && *front_ > sensor.front_then) {
    reportOff(name, sensor, Place::back, result);
  }
  result.verdicts.push_back({scan, std::nullopt});
}

void StampWatch::restartLine(const std::string& name, Time stamp, StampJudgement& result) {
  const double by = seconds(*front_ - stamp);
  result.went_back = by;
  result.notices.push_back("stamps went back by " + secondsText(by) +
                           (sensors_.size() > 1 ? " (of " + name + " and most others)" : "") +
                           ": a recording in a loop, simulated time that was reset, or a clock that was set; "
                           "tracks are given up, tracking goes on from there");
  for (const Held& held : held_)
    result.verdicts.push_back({held.scan, refusalAhead("time went back while it was held")});
  held_.clear();
  for (auto& [other, sensor] : sensors_) {
    if (agrees(sensor, Place::back, stamp)) {
      sensor.is_reported = false;
      rejoin(other, sensor, result);
    } else if (isAlive(sensor) && seconds(sensor.newest - stamp) > params_.max_lag) {
      sensor.offset = seconds(sensor.newest - stamp);
      reportOff(other, sensor, Place::ahead, result);
    }
  }
  front_ = stamp;
}

void StampWatch::rejoin(const std::string& name, Sensor& sensor, StampJudgement& result) {
  if (sensor.is_reported) result.notices.push_back("stamps of " + name + " agree with the others' again");
  sensor.place = Place::on_line;
  sensor.behind = 0;
  sensor.is_reported = false;
}

void StampWatch::reportOff(const std::string& name, Sensor& sensor, Place place, StampJudgement& result) {
  sensor.place = place;
  if (sensor.is_reported) return;
  sensor.is_reported = true;
  result.notices.push_back("stamps of " + name + " are " + offsetText(sensor));
}

std::string StampWatch::offsetText(const Sensor& sensor) const {
  const bool is_ahead = sensor.place == Place::ahead;
  return secondsText(std::abs(sensor.offset)) + (is_ahead ? " ahead of" : " behind") +
         " the others', which go on: its scans are not used until they agree again; synchronise its clock, "
         "or "
         "raise max_lag (" +
         secondsText(params_.max_lag) + ")";
}

std::vector<WatchedStamps> StampWatch::sensors() const {
  std::vector<WatchedStamps> all;
  all.reserve(sensors_.size());
  for (const auto& [name, sensor] : sensors_)
    all.push_back({name, sensor.is_reported ? offsetText(sensor) : ""});
  return all;
}

}  // namespace sightline::core
