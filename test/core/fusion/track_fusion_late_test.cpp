// Reports that come late, one by one or in bursts, as over a bad link.
#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <random>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "sightline/core/fusion/track_fusion.h"

#include "support/local_tracks.h"

namespace sightline::core {
namespace {

using test::at;
using test::localTrack;
using test::reportOf;

/// A target that turns, as a tracker that follows it well reports it.
Track turningTrack(double t) {
  return localTrack(1, {0.2 * std::sin(0.7 * t), 0.15 * std::cos(0.5 * t)}, 3e-4,
                    {0.14 * std::cos(0.7 * t), -0.075 * std::sin(0.5 * t)});
}

/// Fuses what "a" says of that target at once, and what "b" says once it has come; `lateness` of a report of
/// that time [s]. Returns the ids of the global tracks; there is never more than one.
std::set<std::uint32_t> idsOfTurning(double duration, const std::function<double(double)>& lateness) {
  TrackFusion fusion(TrackFusionParams{});
  std::set<std::uint32_t> ids;
  std::deque<std::pair<double, LocalReport>> under_way;
  const auto fuse = [&](const LocalReport& report, double now) {
    const FusionReport fused = fusion.onReport(report);
    EXPECT_LE(fused.tracks.size(), 1u) << "at " << now << " s, report of " << seconds(report.time - Time{});
    for (const FusedTrack& track : fused.tracks) ids.insert(track.track.id);
  };
  for (int k = 0; k < 30.0 * duration; ++k) {
    const double t = 10.0 + k / 30.0;
    fuse(reportOf("a", t, {turningTrack(t)}), t);
    Track track = turningTrack(t);
    if (k < 10) track.status = TrackStatus::tentative;
    under_way.emplace_back(t + lateness(t), reportOf("b", t, {track}));
    for (; !under_way.empty() && under_way.front().first <= t; under_way.pop_front())
      fuse(under_way.front().second, t);
  }
  return ids;
}

TEST(TrackFusionOfLateReports, ATargetThatTurnsStaysOneTrackWhenAReportIsLate) {
  EXPECT_EQ(idsOfTurning(30.0, [](double) { return 0.2; }).size(), 1u);
}

TEST(TrackFusionOfLateReports, ATargetThatTurnsStaysOneTrackOverALinkThatStalls) {
  // Each stall begins while the last ones' reports come, all at once.
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform;
  double stalls_until = 0.0;
  EXPECT_EQ(idsOfTurning(300.0,
                         [&](double t) {
                           if (t > stalls_until && uniform(random) < 0.3)
                             stalls_until = t + 0.9 * uniform(random);
                           return std::max(stalls_until - t, 0.0);
                         })
                .size(),
            1u);
}

TEST(TrackFusionOfLateReports, TargetsThatPartBecomeTwoTracksThoughTheReportsAreLate) {
  TrackFusion fusion(TrackFusionParams{});
  const auto parting = [](double t) { return 0.05 * std::max(t - 12.0, 0.0); };
  std::size_t tracks = 0;
  for (int k = 0; k < 300; ++k) {
    const double t = 10.0 + k / 30.0, late = t - 0.3;
    fusion.onReport(reportOf("a", t, {localTrack(1, {0.0, 0.0}, 3e-4)}));
    const Eigen::Vector2d rates(late > 12.0 ? 0.05 : 0.0, 0.0);
    tracks = fusion.onReport(reportOf("b", late, {localTrack(1, {parting(late), 0.0}, 3e-4, rates)}))
                 .tracks.size();
    if (t < 12.0) {
      EXPECT_EQ(tracks, 1u) << "at " << t << " s";
    }
  }
  EXPECT_EQ(tracks, 2u);
}

}  // namespace
}  // namespace sightline::core
