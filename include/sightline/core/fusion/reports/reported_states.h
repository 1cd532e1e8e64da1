#pragma once

#include <cstddef>
#include <vector>

#include "sightline/core/model/sphere.h"
#include "sightline/core/model/time.h"

namespace sightline::core {

/// A state as a local tracker has reported it, in the tracking frame.
struct ReportedState {
  Time time{};
  AngularState state;
};

/// What a local track said lately: 32 reports, not closer together than a thirtieth of a second. With them
/// the reports of others that come late are compared with what was said at their time.
class ReportedStates {
 public:
  /// A further report, later than the last; one that follows too soon is left out.
  void add(const ReportedState& reported);

  /// The one whose time is nearest; null before the first.
  const ReportedState* nearest(Time time) const;

 private:
  std::vector<ReportedState> ring_;
  std::size_t next_ = 0;  // to be written
};

}  // namespace sightline::core
