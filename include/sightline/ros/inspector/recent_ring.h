#pragma once

#include <cstddef>
#include <deque>

#include "sightline/core/model/time.h"

namespace sightline_ros {

/// The entries of the last `span` [s], at most `most` of them: the oldest give way. `Entry` has a member
/// `arrival`, the time at which it came; entries come in its order.
template <typename Entry>
class RecentRing {
 public:
  RecentRing(std::size_t most, double span) : most_(most), span_(sightline::core::durationOf(span)) {}

  void add(const Entry& entry) {
    entries_.push_back(entry);
    while (entries_.size() > most_ || entries_.front().arrival < entry.arrival - span_) entries_.pop_front();
  }

  void clear() { entries_.clear(); }

  std::size_t size() const { return entries_.size(); }
  auto begin() const { return entries_.begin(); }  ///< oldest first
  auto end() const { return entries_.end(); }
  auto rbegin() const { return entries_.rbegin(); }  ///< newest first
  auto rend() const { return entries_.rend(); }

 private:
  std::size_t most_;
  sightline::core::Duration span_;
  std::deque<Entry> entries_;
};

}  // namespace sightline_ros
