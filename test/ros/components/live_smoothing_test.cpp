#include "sightline/ros/components/live_smoothing.h"

#include <boost/make_shared.hpp>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <tf2/buffer_core.h>

#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/params/param_reader.h"

#include "support/scans.h"

namespace {

namespace core = sightline::core;
using sightline_ros::LiveSmoothing;
using sightline_ros::LocalTrackerComponent;
using sightline_ros::ParamReader;
using sightline_ros::TrackerReport;

constexpr double kLiveLag = 0.4;      // [s]
constexpr double kLivePeriod = 0.04;  // of the scans [s]

/// A tracker of one target and what it reports, with the smoother behind it.
class LiveSmoothingTest : public testing::Test {
 protected:
  LiveSmoothingTest() : component_(ParamReader(XmlRpc::XmlRpcValue(), ""), "live", transforms_) {
    component_.keepSightings();
  }

  /// Scans from the `from`th up to the `to`th; what comes of them goes to `reports_` and `smoothed_`.
  void show(int from, int to) {
    for (int i = from; i < to; ++i) {
      const double stamp = 100.0 + kLivePeriod * i;
      const auto scan = boost::make_shared<sightline::SightingArray>(scanOf("a", stamp, {target_.at(stamp)}));
      for (const TrackerReport& report : component_.onScan(scan, core::Time{})) {
        reports_.push_back(report);
        keep(smoothing_.onReport(report));
        most_waiting_ = std::max(most_waiting_, smoothing_.waiting());
      }
    }
  }

  void keep(const LiveSmoothing::Messages& messages) {
    smoothed_.insert(smoothed_.end(), messages.begin(), messages.end());
  }

  double errorOf(const sightline::TrackArray& message) {
    const auto [azimuth, elevation] = target_.at(message.header.stamp.toSec(), 0.0);
    return std::hypot(message.tracks.at(0).azimuth - azimuth, message.tracks.at(0).elevation - elevation);
  }

  tf2::BufferCore transforms_;
  LocalTrackerComponent component_;
  LiveSmoothing smoothing_{core::EstimatorParams{}, kLiveLag};
  SeenTarget target_{7};
  std::vector<TrackerReport> reports_;
  LiveSmoothing::Messages smoothed_;
  std::size_t most_waiting_ = 0;
};

TEST_F(LiveSmoothingTest, EveryMessageComesOnceMoreInItsOrderAndNearerToTheTarget) {
  show(0, 500);
  const auto newest = sightline_ros::toCore(reports_.back().tracks->header.stamp);
  EXPECT_TRUE(smoothing_.overdue(newest + core::durationOf(kLiveLag)).empty());
  keep(smoothing_.overdue(newest + core::durationOf(2.0 * kLiveLag)));
  EXPECT_EQ(smoothing_.waiting(), 0u);
  ASSERT_EQ(smoothed_.size(), reports_.size());
  double of_filter = 0.0, of_smoother = 0.0;
  for (std::size_t i = 0; i < smoothed_.size(); ++i) {
    ASSERT_EQ(smoothed_[i]->header.stamp, reports_[i].tracks->header.stamp);
    ASSERT_EQ(smoothed_[i]->tracks.size(), reports_[i].tracks->tracks.size());
    if (i < 50) continue;
    EXPECT_EQ(smoothed_[i]->tracks[0].id, reports_[i].tracks->tracks[0].id);
    of_filter += std::pow(errorOf(*reports_[i].tracks), 2);
    of_smoother += std::pow(errorOf(*smoothed_[i]), 2);
  }
  EXPECT_LT(std::sqrt(of_smoother / of_filter), 0.72);
}

TEST_F(LiveSmoothingTest, NoMoreWaitsThanOneAndAHalfLags) {
  show(0, 1000);
  EXPECT_LE(most_waiting_, static_cast<std::size_t>(1.5 * kLiveLag / kLivePeriod) + 2);
  EXPECT_EQ(smoothing_.late(), 0u);
}

TEST_F(LiveSmoothingTest, WhenTimeGoesBackWhatWaitedIsSaidAndItGoesOnFromThere) {
  show(0, 100);
  const std::size_t said = smoothed_.size();
  TrackerReport back;
  back.went_back = true;
  const std::size_t waited = smoothing_.waiting();
  keep(smoothing_.onReport(back));
  EXPECT_EQ(smoothed_.size(), said + waited);
  component_.startAnew(core::Time(core::durationOf(100.0)));
  show(0, 100);
  EXPECT_GT(smoothed_.size(), said + waited + 50u);
  EXPECT_EQ(smoothing_.late(), 0u);
}

TEST_F(LiveSmoothingTest, ALateSightingIsUsedWithinTheLagAndCountedBeyond) {
  show(0, 100);
  TrackerReport late;
  core::TrackTracklet sighting = reports_.back().sightings.at(0);
  sighting.tracklet.time -= core::durationOf(0.01);
  late.sightings = {sighting};
  smoothing_.onReport(late);
  EXPECT_EQ(smoothing_.late(), 0u);
  late.sightings[0].tracklet.time -= core::durationOf(10.0 * kLiveLag);
  smoothing_.onReport(late);
  EXPECT_EQ(smoothing_.late(), 1u);
}

TEST(LiveSmoothing, RefusesWhatCannotBeSmoothed) {
  core::EstimatorParams paper;
  paper.noga_form = core::EstimatorForm::paper;
  EXPECT_THROW(LiveSmoothing(paper, 0.5), std::invalid_argument);
  EXPECT_THROW(LiveSmoothing(core::EstimatorParams{}, 0.0), std::invalid_argument);
}

}  // namespace
