#include "sightline/core/fusion/track_fusion_params.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "sightline/core/model/chi_square.h"

namespace sightline::core {
namespace {

TEST(TrackFusionParams, DefaultsAreValid) {
  EXPECT_NO_THROW(requireValid({}));
}

TEST(TrackFusionParams, EveryValueOutOfItsRangeIsRefused) {
  const auto refused = [](auto spoil) {
    TrackFusionParams params;
    spoil(params);
    EXPECT_THROW(requireValid(params), std::invalid_argument);
  };
  for (const double bad : {-1.0, std::nan("")}) {
    refused([bad](auto& p) { p.gate_probability = bad; });
    refused([bad](auto& p) { p.leave_factor = bad; });
    refused([bad](auto& p) { p.leave_after = bad; });
    refused([bad](auto& p) { p.registration_sigma = bad; });
    refused([bad](auto& p) { p.process_noise = bad; });
    refused([bad](auto& p) { p.coasting_age = bad; });
    refused([bad](auto& p) { p.delete_after = bad; });
    refused([bad](auto& p) { p.remember = bad; });
    refused([bad](auto& p) { p.reports.max_age = bad; });
    refused([bad](auto& p) { p.tracklets.max_lag = bad; });
    refused([bad](auto& p) { p.tracklets.memory = bad; });
    refused([bad](auto& p) { p.tracklets.max_missing = bad; });
  }
  refused([](auto& p) { p.gate_probability = 1.0; });
  refused([](auto& p) { p.leave_factor = 0.9; });
  refused([](auto& p) { p.tracklets.max_missing = 1.1; });
  refused([](auto& p) { p.reports.forget_after = 0.5 * p.reports.max_age; });
  refused([](auto& p) { p.max_tracks = 0; });
  refused([](auto& p) { p.reports.max_tracks = 0; });
  refused([](auto& p) { p.reports.max_trackers = 0; });
  refused([](auto& p) { p.tracklets.guard.support = 0.0; });
  refused([](auto& p) { p.tracklets.estimator.kind = static_cast<EstimatorKind>(99); });
}

TEST(TrackFusionParams, TrackletsAreRememberedAsLongAsTheyCouldBeTaken) {
  TrackFusionParams params;
  params.tracklets.max_lag = 0.7;
  params.tracklets.memory = 0.4;
  params.reports.max_trackers = 5;
  EXPECT_DOUBLE_EQ(memoryParamsOf(params).age, 1.1);
  EXPECT_EQ(memoryParamsOf(params).max_trackers, 5);
}

TEST(TrackFusionParams, ASupporterContradictsAtLeaveFactorTimesTheGate) {
  TrackFusionParams params;
  params.gate_probability = 0.99;
  params.leave_factor = 3.0;
  EXPECT_EQ(thresholdsOf(params).join, chiSquareQuantile4(0.99));
  EXPECT_EQ(thresholdsOf(params).contradict, 3.0 * chiSquareQuantile4(0.99));
}

}  // namespace
}  // namespace sightline::core
