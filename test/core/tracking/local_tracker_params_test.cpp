#include "sightline/core/tracking/local_tracker_params.h"

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

using Change = std::function<void(LocalTrackerParams&)>;

std::optional<Refusal> whyNot(const Change& change) {
  LocalTrackerParams wanted;
  change(wanted);
  return whyNotInFlight({}, wanted);
}

TEST(LocalTrackerParams, WhatScansAreHeldAgainstMayChangeInFlight) {
  EXPECT_FALSE(whyNot([](auto& p) { p.gate = {0.5, GateShape::rectangle, 1e-3, 0.1}; }));
  EXPECT_FALSE(whyNot([](auto& p) { p.association = AssociationMethod::jpda; }));
  EXPECT_FALSE(whyNot([](auto& p) { p.adapt_gate = false; }));
  EXPECT_FALSE(whyNot([](auto& p) {
    p.lifecycle.by_existence = false;
    p.lifecycle.confirm_hits = p.lifecycle.confirm_scans = 4;
    p.lifecycle.show_existence = 0.0;
    p.lifecycle.presence.mean_life = 10.0;
  }));
  EXPECT_FALSE(whyNot([](auto& p) { p.guard.health.bias_threshold = 20.0; }));
  EXPECT_FALSE(whyNot([](auto& p) {
    p.noise_calibration.enabled = false;
    p.estimator.twbls_consistent.noise.enabled = p.estimator.noga_consistent.noise.enabled = false;
  }));
}

TEST(LocalTrackerParams, WhatTracksAreMadeWithMayNotAndIsNamed) {
  const std::vector<std::pair<std::string, Change>> fixed = {
      {"estimator", [](auto& p) { p.estimator.kind = EstimatorKind::kalman; }},
      {"estimator", [](auto& p) { p.estimator.kalman.process_noise = 1.0; }},
      {"estimator", [](auto& p) { p.estimator.imm.models[0].noise.ratio = 2.0; }},
      {"estimator", [](auto& p) { p.estimator.noga_consistent.models.pop_back(); }},
      {"estimator", [](auto& p) { p.estimator.noga_consistent.noise.memory = 2.0; }},
      {"detection", [](auto& p) { p.detection.births = 1.0; }},
      {"noise_calibration", [](auto& p) { p.noise_calibration.max_scale = 2.0; }},
      {"guard.enabled", [](auto& p) { p.guard.enabled = false; }},
      {"guard.roll_back", [](auto& p) { p.guard.roll_back = 0.5; }},
      {"max_lag", [](auto& p) { p.max_lag = 1.0; }},
      {"max_tracks", [](auto& p) { p.max_tracks = 1; }},
      {"max_sightings", [](auto& p) { p.max_sightings = 1; }},
  };
  for (const auto& [name, change] : fixed) {
    const auto why = whyNot(change);
    ASSERT_TRUE(why) << name;
    EXPECT_EQ(why->kind, "fixed");
    EXPECT_EQ(why->detail.rfind(name, 0), 0u) << why->detail;
  }
}

TEST(LocalTrackerParams, WhatIsOutOfRangeIsRefused) {
  const std::vector<std::pair<std::string, Change>> bad = {
      {"gate.probability", [](auto& p) { p.gate.probability = 1.0; }},
      {"gate.probability", [](auto& p) { p.gate.probability = std::nan(""); }},
      {"min_half_width", [](auto& p) { p.gate.min_half_width = 2.0; }},
      {"confirm_hits", [](auto& p) { p.lifecycle.confirm_hits = 7; }},
      {"confirm_existence", [](auto& p) { p.lifecycle.confirm_existence = 1.0; }},
      {"show_existence", [](auto& p) { p.lifecycle.show_existence = 1.0; }},
      {"coast_misses", [](auto& p) { p.lifecycle.coast_misses = 0; }},
      {"coast_silence", [](auto& p) { p.lifecycle.coast_silence = 0.0; }},
      {"remember", [](auto& p) { p.lifecycle.remember = -1.0; }},
      {"max_spread", [](auto& p) { p.lifecycle.max_spread = 1.0; }},
      {"presence", [](auto& p) { p.lifecycle.presence.mean_hidden = 0.0; }},
      {"guard", [](auto& p) { p.guard.health.noise_release = 1.0; }},
      {"noise_calibration", [](auto& p) { p.noise_calibration.enabled = false; }},
  };
  for (const auto& [name, change] : bad) {
    const auto why = whyNot(change);
    ASSERT_TRUE(why) << name;
    EXPECT_EQ(why->kind, "invalid");
    EXPECT_NE(why->detail.find(name), std::string::npos) << why->detail;
  }
}

}  // namespace
}  // namespace sightline::core
