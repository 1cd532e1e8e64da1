#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "sightline/core/model/time.h"

namespace sightline::core {

/// Before which items a Timeline keeps the state. Both depend on the items alone, not on their arrival.
enum class Spacing {
  since_last_kept,  ///< the first item at least `interval` after the last one with a state
  by_clock          ///< the first item of each interval of the clock
};

struct TimelineParams {
  double span = 0.0;      ///< how far back from the newest item the state can be restored [s], >= 0
  double interval = 0.0;  ///< between kept states [s], >= 0
  Spacing spacing = Spacing::since_last_kept;
  /// Items to which the state can be restored at most; beyond, the oldest are closed, >= 1
  std::size_t most_items = std::numeric_limits<std::size_t>::max();
};

/// The items of the last seconds in their order and, now and then, the state that its owner had before
/// processing one. The owner processes the items one after the other (`next`, `advance`). It rolls back for
/// an item that comes late, and to process items again in another way (roll-back after an alarm).
///
/// What a roll-back after an alarm replaced is kept: a still later item before it undoes it first, so that
/// the owner always goes on from what it knew then, whatever had come since.
///
/// `Item`: has `Time timeOf(const Item&)` and `bool precedes(const Item&, const Item&)`, a strict weak order
/// by time first. `Use`: how an item was used last; a value. `State`: copied. Copies of a timeline are
/// independent (kept states are constant and shared).
template <typename Item, typename Use, typename State>
class Timeline {
 public:
  struct Entry {
    Item item;
    Use use{};
    std::shared_ptr<const State> before;  ///< the state before the item, kept for some
    std::uint64_t serial = 0;             ///< in order of arrival
  };

  explicit Timeline(const TimelineParams& params)
      : span_(durationOf(params.span)),
        interval_(params.interval),
        spacing_(params.spacing),
        most_items_(params.most_items) {}

  bool empty() const { return entries_.empty(); }
  std::size_t size() const { return entries_.size(); }
  const Entry& operator[](std::size_t k) const { return entries_[k]; }

  /// The item to be processed next, size() when all are; the items before it are in the owner's state.
  std::size_t next() const { return next_; }

  /// The first item that others can be put before; it has a state once it has been processed.
  std::size_t open() const { return open_; }

  void clear() {
    entries_.clear();
    roll_backs_.clear();
    open_ = next_ = 0;
  }

  /// Whether an equal item (neither precedes the other) is here.
  bool holds(const Item& item) const {
    const std::size_t place = placeFor(item);
    return place > open_ && !precedes(entries_[place - 1].item, item);
  }

  /// Puts an item in its place, behind equal ones, and returns that. A state before the item that follows is
  /// now the one before this item. When the place is before `next()`, the owner must `restore` from it.
  std::size_t insert(Item item) {
    const std::size_t index = placeFor(item);
    Entry entry{std::move(item), Use{}, nullptr, next_serial_++};
    const bool has_successor = index < entries_.size();
    if (has_successor) entry.before = std::move(entries_[index].before);
    if (index < next_) ++next_;
    entries_.insert(entries_.begin() + static_cast<std::ptrdiff_t>(index), std::move(entry));
    return index;
  }

  /// Takes an item out that is not in the owner's state (restored to before it).
  void erase(std::size_t k) {
    std::shared_ptr<const State> before = std::move(entries_[k].before);
    entries_.erase(entries_.begin() + static_cast<std::ptrdiff_t>(k));
    if (k < entries_.size() && before) entries_[k].before = std::move(before);
  }

  /// The nearest item, this one or an earlier one, whose state is kept.
  std::size_t keptAt(std::size_t k) const {
    while (!entries_[k].before) --k;
    return k;
  }

  /// Of the open items up to the next one: the first that is not before `time`, or the next one.
  std::size_t firstNotBefore(Time time) const {
    std::size_t k = next_;
    while (k > open_ && timeOf(entries_[k - 1].item) >= time) --k;
    return k;
  }

  /// Of the open items up to the next one: the last that is not after `time`, or the first one.
  std::size_t lastNotAfter(Time time) const {
    std::size_t k = std::min(next_, entries_.size() - 1);
    while (k > open_ && timeOf(entries_[k].item) > time) --k;
    return k;
  }

  /// Restores the nearest kept state before item k or an earlier one, without what came after it. Roll-backs
  /// by items from there on are undone. Returns the item, now the next, from which to process again.
  std::size_t restore(std::size_t k, State& state) {
    const std::size_t from = keptAt(k);
    while (!roll_backs_.empty() && placeOf(roll_backs_.back().by) >= from) undoRollBack();
    for (std::size_t i = from + 1; i < entries_.size(); ++i) entries_[i].before.reset();
    return restart(from, state);
  }

  /// The next item has shown that items from `first` on are to be used in another way: as `restore`, but what
  /// it replaces, of the items up to this one, is remembered, and an item put before this one undoes it. The
  /// owner then says with `use` how each is to be used.
  std::size_t rollBack(std::size_t first, State& state) {
    const std::size_t from = keptAt(first);
    RollBack roll_back;
    roll_back.by = entries_[next_].serial;
    for (std::size_t i = from; i <= next_; ++i) {
      Entry& entry = entries_[i];
      const bool keeps_state = i > from && entry.before != nullptr;
      roll_back.replaced.push_back(
          {entry.serial, entry.use, keeps_state, keeps_state ? std::move(entry.before) : nullptr});
    }
    roll_backs_.push_back(std::move(roll_back));
    return restart(from, state);
  }

  /// Notes how item k is used.
  void use(std::size_t k, const Use& use) { entries_[k].use = use; }

  /// Keeps the owner's state before the next item where one is due: the first, then by `spacing`. Returns
  /// whether it was kept now.
  bool keepIfDue(const State& state) {
    if (entries_[next_].before || !isStateDue()) return false;
    entries_[next_].before = std::make_shared<const State>(state);
    return true;
  }

  /// The next item has been processed.
  void advance() { ++next_; }

  /// Closes the items before the last kept state that is `span` older than `newest`: nothing is put before it
  /// any more. Returns whether any were closed. Closed items stay until they are dropped.
  bool close(Time newest) {
    const Time oldest = newest - span_;
    std::size_t open = open_;
    for (std::size_t k = open_ + 1; k < next_; ++k) {
      const bool too_many = entries_.size() - open > most_items_;
      if (timeOf(entries_[k].item) > oldest && !too_many) break;
      if (entries_[k].before) open = k;
    }
    if (open == open_) return false;
    for (std::size_t k = open_; k < open; ++k) entries_[k].before.reset();
    open_ = open;
    return true;
  }

  /// Drops the closed items but the last `keep`.
  void dropClosed(std::size_t keep = 0) {
    const std::size_t drop = open_ - std::min(open_, keep);
    entries_.erase(entries_.begin(), entries_.begin() + static_cast<std::ptrdiff_t>(drop));
    open_ -= drop;
    next_ -= drop;
    while (!roll_backs_.empty() && placeOf(roll_backs_.front().by) == entries_.size())
      roll_backs_.pop_front();
  }

 private:
  struct Replaced {
    std::uint64_t serial = 0;
    Use use{};
    bool had_state = false;  // after the first
    std::shared_ptr<const State> before;
  };
  struct RollBack {
    std::uint64_t by = 0;  // serial of the item that showed it
    std::vector<Replaced> replaced;
  };

  /// Where an item belongs among the open ones.
  std::size_t placeFor(const Item& item) const {
    const auto place =
        std::upper_bound(entries_.begin() + static_cast<std::ptrdiff_t>(open_), entries_.end(), item,
                         [](const Item& a, const Entry& b) { return precedes(a, b.item); });
    return static_cast<std::size_t>(place - entries_.begin());
  }

  /// Place of the item with this serial, size() when it has been dropped.
  std::size_t placeOf(std::uint64_t serial) const {
    std::size_t k = 0;
    while (k < entries_.size() && entries_[k].serial != serial) ++k;
    return k;
  }

  std::size_t restart(std::size_t from, State& state) {
    state = State(*entries_[from].before);
    next_ = from;
    return from;
  }

  void undoRollBack() {
    for (Replaced& replaced : roll_backs_.back().replaced) {
      const std::size_t k = placeOf(replaced.serial);
      if (k == entries_.size()) continue;
      entries_[k].use = replaced.use;
      if (replaced.had_state) entries_[k].before = std::move(replaced.before);
    }
    roll_backs_.pop_back();
  }

  bool isStateDue() const {
    const Time time = timeOf(entries_[next_].item);
    if (spacing_ == Spacing::by_clock)
      return next_ == 0 || intervalOf(time) != intervalOf(timeOf(entries_[next_ - 1].item));
    for (std::size_t earlier = next_; earlier-- > open_;) {
      if (entries_[earlier].before) return seconds(time - timeOf(entries_[earlier].item)) >= interval_;
    }
    return true;
  }

  /// Which of the clock's intervals the time is in; of length 0, each instant is one.
  std::int64_t intervalOf(Time time) const {
    const auto length = durationOf(interval_).count();
    return length > 0 ? time.time_since_epoch().count() / length : time.time_since_epoch().count();
  }

  Duration span_;
  double interval_;  // [s]
  Spacing spacing_;
  std::size_t most_items_;
  std::vector<Entry> entries_;       // in order; closed ones first
  std::size_t open_ = 0;             // the first that others can be put before
  std::size_t next_ = 0;             // the first that is not in the owner's state
  std::deque<RollBack> roll_backs_;  // in the order in which they happened
  std::uint64_t next_serial_ = 0;
};

}  // namespace sightline::core
