#include "sightline/core/fusion/reports/report_rounds.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <vector>

namespace sightline::core {
namespace {

constexpr double kOverdue = 0.5;       // usual intervals after which a report is not expected any more
constexpr double kSoon = 0.5;          // shortest intervals from now
constexpr double kLongestRound = 0.9;  // shortest intervals: less than one, for the next round is like this

}  // namespace

void ReportRounds::note(const std::string& tracker, const LocalReports& reports) {
  if (new_reports_.empty()) begun_ = reports.newest();
  ++new_reports_[tracker];
  last_[tracker] = reports.newest();
}

bool ReportRounds::isDue(const LocalReports& reports) const {
  if (new_reports_.empty()) return false;
  std::optional<double> shortest;  // usual interval [s]
  std::vector<double> expected;    // from now [s]
  for (const auto& [name, tracker] : reports.trackers()) {
    const auto last = last_.find(name);
    if (last == last_.end() || !(tracker.interval > 0.0)) continue;
    const double next = tracker.interval - seconds(reports.newest() - last->second);
    if (next < -kOverdue * tracker.interval) continue;
    shortest = std::min(shortest.value_or(tracker.interval), tracker.interval);
    if (new_reports_.count(name) == 0) expected.push_back(std::max(next, 0.0));
  }
  if (expected.empty()) return true;
  const double waited = seconds(reports.newest() - begun_);
  const double longest = std::min(max_wait_, kLongestRound * *shortest);
  if (waited < 0.0 || waited >= longest) return true;  // before zero: the stamps went back
  const double next = *std::min_element(expected.begin(), expected.end());
  return next > kSoon * *shortest || waited + next > longest;
}

NewReports ReportRounds::end(const LocalReports& reports) {
  const auto is_forgotten = [&reports](const auto& entry) {
    return reports.trackers().count(entry.first) == 0;
  };
  for (auto it = last_.begin(); it != last_.end();) it = is_forgotten(*it) ? last_.erase(it) : std::next(it);
  NewReports ended;
  for (const auto& entry : new_reports_) {
    if (!is_forgotten(entry)) ended.insert(entry);
  }
  new_reports_.clear();
  return ended;
}

}  // namespace sightline::core
