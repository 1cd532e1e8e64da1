#include "sightline/core/sensors/guard_settings.h"

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

using Change = std::function<void(GuardParams&)>;

GuardParams changed(const Change& change) {
  GuardParams params;
  change(params);
  return params;
}

TEST(GuardSettings, ThresholdsAndReleasesMayChange) {
  EXPECT_FALSE(fixedGuardField({}, changed([](GuardParams& guard) {
                                 guard.health.noise_threshold = 1.0;
                                 guard.health.bias_threshold = 2.0;
                                 guard.health.noise_release = 3.0;
                                 guard.health.bias_release = 4.0;
                                 guard.health.least_exclusion = 5.0;
                               })));
}

TEST(GuardSettings, EverythingElseIsNamed) {
  const std::vector<std::pair<std::string, Change>> fixed = {
      {"enabled", [](GuardParams& guard) { guard.enabled = false; }},
      {"roll_back", [](GuardParams& guard) { guard.roll_back = 1.0; }},
      {"support", [](GuardParams& guard) { guard.support = 1.0; }},
      {"reach", [](GuardParams& guard) { guard.reach = 1.0; }},
      {"clock", [](GuardParams& guard) { guard.clock.memory = 1.0; }},
      {"clock", [](GuardParams& guard) { guard.clock.least = 1.0; }},
      {"health", [](GuardParams& guard) { guard.health.form = HealthForm::specified; }},
      {"health", [](GuardParams& guard) { guard.health.noise_ratio = 2.0; }},
      {"health", [](GuardParams& guard) { guard.health.largest_evidence = 2.0; }},
      {"health", [](GuardParams& guard) { guard.health.bias_slack = 2.0; }},
      {"health", [](GuardParams& guard) { guard.health.largest_innovation = 2.0; }},
      {"health", [](GuardParams& guard) { guard.health.memory = 2.0; }},
      {"health", [](GuardParams& guard) { guard.health.largest_scale = 2.0; }},
      {"health", [](GuardParams& guard) { guard.health.least_scale = 2.0; }},
  };
  for (const auto& [name, change] : fixed) {
    const auto field = fixedGuardField({}, changed(change));
    ASSERT_TRUE(field) << name;
    EXPECT_EQ(field->rfind(name, 0), 0u) << *field;
  }
}

TEST(GuardSettings, WhatNoGuardCanBeMadeWithIsRefused) {
  EXPECT_FALSE(whyUnusable({}));
  const auto why = whyUnusable(changed([](GuardParams& guard) { guard.health.bias_threshold = 0.0; }));
  ASSERT_TRUE(why);
  EXPECT_EQ(why->kind, "invalid");
  EXPECT_NE(why->detail.find("guard"), std::string::npos) << why->detail;
}

}  // namespace
}  // namespace sightline::core
