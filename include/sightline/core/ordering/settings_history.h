#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <utility>

#include "sightline/core/model/time.h"

namespace sightline::core {

/// Settings that change while data come in, each with the time after which it holds: what is processed again
/// after a late scan is processed with the settings that held at its time. Copies share the settings, which
/// are constant.
template <typename Settings>
class SettingsHistory {
 public:
  using Pointer = std::shared_ptr<const Settings>;

  explicit SettingsHistory(Settings first) { startWith(std::move(first)); }

  /// Forgets all others: these hold at every time.
  void startWith(Settings settings) {
    history_.clear();
    history_.push_back({Time::min(), std::make_shared<const Settings>(std::move(settings))});
  }

  /// These hold for what is later than `after`. Of several changes at one time the last one holds, and where
  /// time has gone back, no earlier change holds beyond it.
  void change(Settings settings, Time after) {
    while (history_.size() > 1 && history_.back().after >= after) history_.pop_back();
    history_.push_back({after, std::make_shared<const Settings>(std::move(settings))});
  }

  /// Nothing before `oldest` is asked for any more.
  void forgetBefore(Time oldest) {
    while (history_.size() > 1 && history_[1].after < oldest) history_.pop_front();
  }

  /// What holds at `time`; never null.
  const Pointer& at(Time time) const {
    std::size_t k = history_.size() - 1;
    while (k > 0 && history_[k].after >= time) --k;
    return history_[k].settings;
  }

  /// What holds from now on; never null.
  const Pointer& newest() const { return history_.back().settings; }

  std::size_t size() const { return history_.size(); }

 private:
  struct Entry {
    Time after;
    Pointer settings;
  };

  std::deque<Entry> history_;  // never empty; ascending `after`
};

}  // namespace sightline::core
