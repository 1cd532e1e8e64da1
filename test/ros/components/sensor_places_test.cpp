#include "sightline/ros/components/sensor_places.h"

#include <map>
#include <string>

#include <gtest/gtest.h>

#include <geometry_msgs/TransformStamped.h>

namespace {

using sightline_ros::SensorPlaces;

/// tf with frames along x of `world` at these places [m].
void fill(tf2::BufferCore& transforms, const std::map<std::string, double>& places) {
  for (const auto& [frame, x] : places) {
    geometry_msgs::TransformStamped transform;
    transform.header.frame_id = "world";
    transform.child_frame_id = frame;
    transform.transform.translation.x = x;
    transform.transform.rotation.w = 1.0;
    transforms.setTransform(transform, "test", true);
  }
}

TEST(SensorPlaces, TrackerWhoseSensorsStandApartIsLeftOutAndToldWhatToUse) {
  tf2::BufferCore transforms;
  fill(transforms, {{"left", 0.0}, {"right", 3.0}, {"far", 150.0}});
  SensorPlaces places(10.0, transforms);
  EXPECT_FALSE(places.take("a", {"left"}, 1e-3));
  EXPECT_FALSE(places.take("b", {"right"}, 1e-3));
  const auto refusal = places.take("c", {"right", "far"}, 1e-3);
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->kind, "apart");
  for (const char* part : {"\"c\"", "sensor far", "150 m from left", "150000 m", "position_tracker"})
    EXPECT_NE(refusal->detail.find(part), std::string::npos) << refusal->detail;
  EXPECT_FALSE(places.take("a", {"left"}, 1e-3)) << "the first stays";
  EXPECT_NEAR(places.spread(), 150.0, 1e-9);
}

TEST(SensorPlaces, OfASensorWithoutAFrameNothingIsSaidUntilItIsSet) {
  tf2::BufferCore transforms;
  fill(transforms, {{"left", 0.0}, {"link", 50.0}});
  SensorPlaces places(10.0, transforms);
  EXPECT_FALSE(places.take("b", {"camera"}, 0.0));
  EXPECT_FALSE(places.take("a", {"left"}, 0.0));
  EXPECT_FALSE(places.take("b", {"camera"}, 0.0));
  places.setFrame("camera", "link");
  EXPECT_TRUE(places.take("b", {"camera"}, 0.0));
}

TEST(SensorPlaces, CanBeLeftUnchecked) {
  tf2::BufferCore transforms;
  fill(transforms, {{"left", 0.0}, {"far", 150.0}});
  SensorPlaces places(0.0, transforms);
  EXPECT_FALSE(places.take("a", {"left"}, 0.0));
  EXPECT_FALSE(places.take("b", {"far"}, 0.0));
}

}  // namespace
