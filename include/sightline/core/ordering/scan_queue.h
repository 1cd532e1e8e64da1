#pragma once

#include <cstddef>
#include <iterator>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "sightline/core/model/time.h"
#include "sightline/core/ordering/scan_order.h"

namespace sightline::core {

/// Puts scans into their order: holds each until none that precedes it can come any more, given that they
/// arrive at most `max_lag` [s] after a newer one. `Item` is the scan in whatever form the caller has it.
template <typename Item>
class ScanQueue {
 public:
  explicit ScanQueue(double max_lag) : max_lag_(durationOf(max_lag)) {}

  /// Takes a scan; false when it is later than max_lag and its place may have been passed.
  bool add(ScanOrder order, Item item) {
    if (newest_ && order.time < *newest_ - max_lag_) return false;
    if (!newest_ || *newest_ < order.time) newest_ = order.time;
    held_.emplace(std::move(order), std::move(item));
    return true;
  }

  /// The scans that no other can precede any more, in order.
  std::vector<Item> release() {
    auto end = held_.begin();
    while (end != held_.end() && end->first.time < *newest_ - max_lag_) ++end;
    return take(end);
  }

  /// Everything held, in order: no more scans will come.
  std::vector<Item> releaseAll() { return take(held_.end()); }

  std::size_t size() const { return held_.size(); }

 private:
  using Held = std::multimap<ScanOrder, Item>;

  std::vector<Item> take(typename Held::iterator end) {
    std::vector<Item> items;
    for (auto it = held_.begin(); it != end; ++it) items.push_back(std::move(it->second));
    held_.erase(held_.begin(), end);
    return items;
  }

  Duration max_lag_;
  std::optional<Time> newest_;
  Held held_;
};

}  // namespace sightline::core
