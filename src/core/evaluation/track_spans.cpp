#include "sightline/core/evaluation/track_spans.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace sightline::core {

void TrackSpans::add(const TrackReport& report) {
  bool has_track = false;
  for (const Track& track : report.tracks) {
    if (track.status == TrackStatus::tentative) continue;
    has_track = true;
    spans_.try_emplace(track.id, Span{report.time, report.time}).first->second.last = report.time;
  }

  if (last_report_) {
    const double step = seconds(report.time - *last_report_);
    const bool paused = step > pause_;
    pause_in_gap_ = pause_in_gap_ || paused;
    if (!paused) reported_ += step;
    if (!paused && has_track && had_track_) covered_ += step;
  }
  if (has_track) noteGap(report.time);
  last_report_ = report.time;
  had_track_ = has_track;
}

void TrackSpans::noteGap(Time time) {
  if (last_with_track_ && !had_track_ && !pause_in_gap_) {
    ++breaks_;
    longest_break_ = std::max(longest_break_, seconds(time - *last_with_track_));
  }
  last_with_track_ = time;
  pause_in_gap_ = false;
}

double TrackSpans::medianLength() const {
  if (spans_.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::vector<double> lengths;
  for (const auto& [id, span] : spans_) lengths.push_back(seconds(span.last - span.first));
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

double TrackSpans::longestLength() const {
  double longest = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [id, span] : spans_) longest = std::fmax(longest, seconds(span.last - span.first));
  return longest;
}

double TrackSpans::coverage() const {
  return reported_ > 0.0 ? covered_ / reported_ : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace sightline::core
