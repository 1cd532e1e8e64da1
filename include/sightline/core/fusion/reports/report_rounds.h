#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "sightline/core/fusion/reports/local_reports.h"
#include "sightline/core/model/time.h"

namespace sightline::core {

/// Decides when local reports are fused: once a round of the trackers, not at every report.
///
/// A round begins with the first report that is not fused yet. It ends with the report after which no other
/// tracker is expected soon: within half the shortest usual interval of all trackers, and within
/// `max_wait` and nine tenths of that interval from the round's beginning. So reports of one instant are
/// fused together, a tracker at a pace of its own is not waited for, and one that falls silent delays a
/// single round. A tracker is expected one usual interval after its last report, counted in the common time
/// at which its reports came, so that one whose stamps lag behind is expected when its reports really come.
class ReportRounds {
 public:
  /// `max_wait`: longest that a report waits for others [s], >= 0; 0 = it does not.
  explicit ReportRounds(double max_wait) : max_wait_(max_wait) {}

  /// Notes a report of this tracker, which `reports` has taken.
  void note(const std::string& tracker, const LocalReports& reports);

  /// Whether there are reports to be fused, and none is worth waiting for.
  bool isDue(const LocalReports& reports) const;

  bool isEmpty() const { return new_reports_.empty(); }

  /// Ends the round. Returns what came in it, of the trackers that `reports` still knows.
  NewReports end(const LocalReports& reports);

 private:
  double max_wait_;
  Time begun_{};                      // the common time at the round's first report
  NewReports new_reports_;            // of the round
  std::map<std::string, Time> last_;  // common time at each tracker's last report
};

}  // namespace sightline::core
