#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sightline/core/model/refusal.h"
#include "sightline/core/model/time.h"

namespace sightline::core {

struct StampWatchParams {
  double max_lag =
      0.5;  ///< lateness, and step of a sensor's stamps, up to which nothing is done [s], >= 0; 0.25 at least
  double alive = 2.0;  ///< silence after which a sensor has no vote [s], > 0; at least three of its intervals
  double agreement = 5.0;       ///< stamps no further apart than this follow one clock [s], > 0
  int scans_back = 5;           ///< for each sensor that went back, until time has gone back for all, >= 1
  std::size_t max_held = 1000;  ///< scans that are held at once, >= 1; beyond, the oldest is dropped
};

/// What is to be done after a scan has come.
struct StampJudgement {
  struct Verdict {
    std::uint64_t scan = 0;          ///< its number
    std::optional<Refusal> refusal;  ///< why it is not to be used; nullopt = to be used
  };
  std::vector<Verdict> verdicts;  ///< of this scan and of others that were held, in the order of their use;
                                  ///< none for a scan that is held
  std::optional<double>
      went_back;  ///< time went back for all, by so much [s]: before these verdicts, start anew
  std::vector<std::string> notices;  ///< what an operator should know, each reported once
};

/// How a sensor's stamps stand to those of the others.
struct WatchedStamps {
  std::string sensor;
  std::string text;  ///< "12.3 s ahead of the others': ..."; empty = they agree
};

/// Watches the stamps of several sensors for clocks that jump: a recording that starts again, simulated time
/// that is reset, one sensor's clock that steps. One sensor's clock must not disturb the others; what
/// all clocks do is followed. Time comes in with the scans.
///
/// Sensors whose stamps follow each other are on the line, whose front is the newest stamp. Nothing is done
/// about scans that come within `max_lag` of the front, nor about late ones of a sensor whose own stamps go
/// on. A sensor whose stamps leap ahead is held back: until most of the active sensors are there, too (a
/// pause: all its scans are used), or until another one goes on where it was (then it is the odd one out, and
/// its scans are dropped until it agrees again). Stamps that go back are late and nothing else, unless most
/// of the active sensors do so: then time went back. Stamps that go to and fro are those of one sensor, whose
/// late scans are late.
///
/// For input that arrives within `max_lag` all scans are used, whatever the order of arrival.
class StampWatch {
 public:
  /// Throws std::invalid_argument for parameters out of range.
  explicit StampWatch(const StampWatchParams& params);

  /// Takes the scan of that number; numbers are the caller's and differ. `clock`: when it arrived, where that
  /// is known by a clock that stamps should agree with; one that does has not leapt ahead.
  StampJudgement take(std::uint64_t scan, const std::string& sensor, Time stamp,
                      std::optional<Time> clock = std::nullopt);

  /// No more scans will come: what is held is to be used.
  StampJudgement finish();

  /// Every sensor of which a scan has been taken, by name.
  std::vector<WatchedStamps> sensors() const;

  std::size_t held() const { return held_.size(); }

 private:
  enum class Place { on_line, held, ahead, back };

  struct Sensor {
    Place place = Place::on_line;
    Time newest{};             // of its stamps, since they stepped last
    double last_step = 0.0;    // between its last two stamps [s]
    double interval = 0.0;     // the usual largest between its stamps [s]
    Duration last_received{};  // when its last scan came, on the clock `elapsed_`
    Duration way{};            // that clock at `newest`
    Time front_then{};         // the line's, when its stamps went back
    int behind = 0;            // scans in a row behind the line, since its stamps went back
    int steady = 0;            // scans since its stamps went back
    double offset = 0.0;       // how far it was off the line, last [s]
    bool is_reported = false;  // that it is off the line
  };
  struct Held {
    std::uint64_t scan = 0;
    std::string sensor;
    Time stamp{};
  };

  void forgetLongestSilent();
  void noteStamp(Sensor& sensor, Time stamp, bool is_new);
  bool isJump(const Sensor& sensor, Time stamp, bool is_new) const;
  bool isAlive(const Sensor& sensor) const;
  double aliveFor(const Sensor& sensor) const;
  bool isMajority(Place place, Time stamp, int least_scans) const;
  bool agrees(const Sensor& sensor, Place place, Time stamp) const;

  void takeOnLine(std::uint64_t scan, const std::string& name, Time stamp, StampJudgement& result);
  void takeAhead(std::uint64_t scan, const std::string& name, Time stamp, StampJudgement& result);
  void takeBehind(std::uint64_t scan, const std::string& name, Time stamp, StampJudgement& result);
  void resolveHeld(const std::string& name, Time stamp, StampJudgement& result);
  void rejoin(const std::string& name, Sensor& sensor, StampJudgement& result);
  void goAhead(Time stamp, StampJudgement& result);
  void restartLine(const std::string& name, Time stamp, StampJudgement& result);
  void reportOff(const std::string& name, Sensor& sensor, Place place, StampJudgement& result);
  std::string offsetText(const Sensor& sensor) const;

  StampWatchParams params_;
  std::map<std::string, Sensor> sensors_;
  std::vector<Held> held_;     // in order of arrival
  std::optional<Time> front_;  // newest stamp on the line
  Duration elapsed_{};         // how long scans have been coming, by the sensors' own stamps
};

/// A StampWatch and the scans that it holds, in whatever form the caller has them.
template <typename Item>
class StampGate {
 public:
  struct Passed {
    Item item;
    std::optional<Refusal> refusal;  ///< nullopt = to be used
  };
  struct Result {
    std::vector<Passed> passed;  ///< in the order of their use
    std::optional<double> went_back;
    std::vector<std::string> notices;
  };

  explicit StampGate(const StampWatchParams& params) : watch_(params) {}

  Result take(const std::string& sensor, Time stamp, Item item, std::optional<Time> clock = std::nullopt) {
    const std::uint64_t number = next_++;
    items_.emplace(number, std::move(item));
    return pass(watch_.take(number, sensor, stamp, clock));
  }

  Result finish() { return pass(watch_.finish()); }

  std::vector<WatchedStamps> sensors() const { return watch_.sensors(); }

 private:
  Result pass(StampJudgement judgement) {
    Result result{{}, judgement.went_back, std::move(judgement.notices)};
    for (StampJudgement::Verdict& verdict : judgement.verdicts) {
      const auto item = items_.find(verdict.scan);
      result.passed.push_back({std::move(item->second), std::move(verdict.refusal)});
      items_.erase(item);
    }
    return result;
  }

  StampWatch watch_;
  std::map<std::uint64_t, Item> items_;
  std::uint64_t next_ = 0;
};

}  // namespace sightline::core
