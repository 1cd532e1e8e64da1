#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sightline/core/model/sighting.h"
#include "sightline/core/model/time.h"

namespace sightline::core {

/// Order in which scans are followed: by time; at one instant by sensor, then by content, so that the order
/// of arrival does not matter.
bool precedes(const Scan& a, const Scan& b);

bool isSameExposure(const Scan& a, const Scan& b);

/// The scans of the last seconds in their order, and now and then the state of the tracker before one, so
/// that it can go back: for a scan that comes late, or to follow a sensor's scans again in another way.
///
/// What going back for a sensor replaced is kept: a scan that is still later undoes it first, so that the
/// tracker always goes on from what it knew then, whatever had come since.
template <typename State>
class ScanMemory {
 public:
  struct Entry {
    Scan scan;
    double noise_scale = 1.0;       ///< with which it was followed last
    std::uint64_t serial = 0;       ///< in order of arrival
    std::unique_ptr<State> before;  ///< some have it, the first always
  };

  /// `max_lag`: lateness up to which a scan is put in its place, `roll_back`: how far a sensor's scans can be
  /// followed again, from any place a scan can be put to [s].
  ScanMemory(double max_lag, double roll_back)
      : span_(durationOf(max_lag + roll_back)),
        state_interval_(std::max(max_lag, roll_back / 2.0) / kStatesPerLag) {}

  bool empty() const { return entries_.empty(); }
  std::size_t size() const { return entries_.size(); }
  const Entry& operator[](std::size_t k) const { return entries_[k]; }

  void clear() {
    entries_.clear();
    roll_backs_.clear();
  }

  /// Whether all scans before `time` may have been forgotten.
  bool isBefore(Time time) const { return !empty() && time < entries_.front().before->time; }

  bool holds(const Scan& scan) const {
    for (auto it = entries_.rbegin(); it != entries_.rend() && it->scan.time >= scan.time; ++it) {
      if (isSameExposure(it->scan, scan)) return true;
    }
    return false;
  }

  /// Puts a scan in its place and returns that.
  std::size_t insert(const Scan& scan) {
    const auto place = std::upper_bound(entries_.begin(), entries_.end(), scan,
                                        [](const Scan& a, const Entry& b) { return precedes(a, b.scan); });
    const auto index = static_cast<std::size_t>(place - entries_.begin());
    Entry entry;
    entry.scan = scan;
    entry.serial = next_serial_++;
    entries_.insert(place, std::move(entry));
    return index;
  }

  /// For a scan that has been put before others: sets `state` to the nearest one that has seen nothing after
  /// it and returns the entry from which to follow.
  std::size_t goBack(std::size_t index, State& state) {
    if (index == 0) entries_[0].before = std::move(entries_[1].before);
    std::size_t from = index;
    while (!entries_[from].before) --from;
    while (!roll_backs_.empty() && placeOf(roll_backs_.back().by) >= from) undoRollBack();
    state = State(*entries_[from].before);
    for (std::size_t k = from + 1; k < entries_.size(); ++k) entries_[k].before.reset();
    return from;
  }

  void use(std::size_t k, double noise_scale) { entries_[k].noise_scale = noise_scale; }

  /// Keeps the state before entry k where one is due: the first, then a few for each lag.
  void keepIfDue(std::size_t k, const State& state) {
    if (isStateDue(k)) entries_[k].before = std::make_unique<State>(state);
  }

  /// Entry k shows that the scans of `sensor` since `began` are to be used with `noise_scale`: notes that and
  /// returns the entry, with a state, from which to follow again. `keepAgain` is then to be called before
  /// each entry up to k.
  std::size_t rollBack(std::size_t k, const std::string& sensor, Time began, double noise_scale) {
    std::size_t first = k;
    while (first > 0 && entries_[first - 1].scan.time >= began) --first;
    std::size_t from = first;
    while (!entries_[from].before) --from;

    RollBack roll_back;
    roll_back.by = entries_[k].serial;
    for (std::size_t i = from; i <= k; ++i) {
      Entry& entry = entries_[i];
      const bool keeps_state = i > from && entry.before != nullptr;
      roll_back.replaced.push_back(
          {entry.serial, entry.noise_scale, keeps_state, keeps_state ? std::move(entry.before) : nullptr});
      if (i >= first && entry.scan.sensor == sensor) entry.noise_scale = noise_scale;
    }
    roll_backs_.push_back(std::move(roll_back));
    return from;
  }

  /// While entries are followed again: keeps the state before entry k where there was one.
  void keepAgain(std::size_t k, const State& state) {
    for (const Replaced& replaced : roll_backs_.back().replaced) {
      if (replaced.serial == entries_[k].serial && replaced.had_state)
        entries_[k].before = std::make_unique<State>(state);
    }
  }

  /// Drops the scans before the last kept state that is old enough: nothing will go back before it any more.
  void forget(Time newest) {
    const Time oldest = newest - span_;
    std::size_t keep_from = 0;
    for (std::size_t k = 1; k < entries_.size(); ++k) {
      const bool too_many = entries_.size() - keep_from > kMostEntries;
      if (entries_[k].scan.time > oldest && !too_many) break;
      if (entries_[k].before) keep_from = k;
    }
    if (keep_from == 0) return;
    entries_.erase(entries_.begin(), entries_.begin() + static_cast<std::ptrdiff_t>(keep_from));
    while (!roll_backs_.empty() && placeOf(roll_backs_.front().by) == entries_.size())
      roll_backs_.pop_front();
  }

  static constexpr std::size_t kMostEntries = 4096;

 private:
  static constexpr int kStatesPerLag = 8;

  struct Replaced {
    std::uint64_t serial = 0;
    double noise_scale = 1.0;
    bool had_state = false;  // after the first
    std::unique_ptr<State> before;
  };
  struct RollBack {
    std::uint64_t by = 0;  // serial of the entry that showed it
    std::vector<Replaced> replaced;
  };

  /// Place of the entry with this serial, size() when it has been forgotten.
  std::size_t placeOf(std::uint64_t serial) const {
    std::size_t k = 0;
    while (k < entries_.size() && entries_[k].serial != serial) ++k;
    return k;
  }

  void undoRollBack() {
    for (Replaced& replaced : roll_backs_.back().replaced) {
      const std::size_t k = placeOf(replaced.serial);
      if (k == entries_.size()) continue;
      entries_[k].noise_scale = replaced.noise_scale;
      if (replaced.had_state) entries_[k].before = std::move(replaced.before);
    }
    roll_backs_.pop_back();
  }

  bool isStateDue(std::size_t k) const {
    if (entries_[k].before) return false;
    for (std::size_t earlier = k; earlier-- > 0;) {
      if (!entries_[earlier].before) continue;
      return seconds(entries_[k].scan.time - entries_[earlier].scan.time) >= state_interval_;
    }
    return true;
  }

  Duration span_;
  double state_interval_;            // [s]
  std::deque<Entry> entries_;        // in order of time; the first one has its state
  std::deque<RollBack> roll_backs_;  // in the order in which they happened
  std::uint64_t next_serial_ = 0;
};

}  // namespace sightline::core
