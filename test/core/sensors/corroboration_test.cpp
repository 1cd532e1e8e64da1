#include "sightline/core/sensors/corroboration.h"

#include <gtest/gtest.h>

#include "support/times.h"

namespace sightline::core {
namespace {

using test::at;

struct Source {
  std::string sensor;
  Time last_sighting;
  Eigen::Vector2d innovation;
};

const std::vector<Source> kSources{{"a", at(10.0), {1.0, -1.0}},
                                   {"b", at(9.9), {2.0, 3.0}},
                                   {"c", at(9.8), {4.0, -2.0}},
                                   {"long silent", at(1.0), {100.0, 100.0}}};

TEST(Corroboration, OthersThatSawTheTargetLatelyCountAndAgreeByTheirSignedMedian) {
  const SensorGuard guard{GuardParams{}};
  const Corroboration of_a = corroborationBy(kSources, "a", at(10.0), guard);
  EXPECT_TRUE(of_a.has_sensor);
  EXPECT_EQ(of_a.others, 2);
  EXPECT_EQ(of_a.shared, Eigen::Vector2d(3.0, 0.0)) << "of different signs: nothing is shared";
  const Corroboration of_new = corroborationBy(kSources, "new", at(10.0), guard);
  EXPECT_FALSE(of_new.has_sensor);
  EXPECT_EQ(of_new.others, 3);
  EXPECT_EQ(of_new.shared, Eigen::Vector2d(2.0, -1.0));
}

TEST(Corroboration, ATrackThatTellsNothingYetHasNoOthers) {
  const SensorGuard guard{GuardParams{}};
  const Corroboration corroboration = corroborationBy(kSources, "a", at(10.0), guard, false);
  EXPECT_TRUE(corroboration.has_sensor);
  EXPECT_EQ(corroboration.others, 0);
  EXPECT_EQ(corroboration.shared, Eigen::Vector2d::Zero());
}

}  // namespace
}  // namespace sightline::core
