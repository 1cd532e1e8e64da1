#include "sightline/ros/display/label_places.h"

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

namespace {

using sightline::core::directionOf;
using sightline_ros::LabelPlaces;
using sightline_ros::labelSize;

TEST(LabelPlaces, ALabelIsAsWideAsItsLongestLineAndAsHighAsItsLines) {
  const Eigen::Vector2d one = labelSize("12345", 0.1), two = labelSize("123\n12345", 0.1);
  EXPECT_DOUBLE_EQ(one.x(), two.x());
  EXPECT_DOUBLE_EQ(2.0 * one.y(), two.y());
  EXPECT_GT(one.x(), one.y());
}

TEST(LabelPlaces, APlaceIsTakenOnceAndItsNeighboursAreFree) {
  LabelPlaces places;
  const Eigen::Vector2d size(0.2, 0.1);
  EXPECT_TRUE(places.take(directionOf({0.0, 0.0}), size));
  EXPECT_FALSE(places.take(directionOf({0.15, 0.05}), size));
  EXPECT_TRUE(places.take(directionOf({0.25, 0.0}), size));
  EXPECT_TRUE(places.take(directionOf({0.0, 0.15}), size));
  EXPECT_TRUE(places.take(directionOf({sightline::core::kPi, 0.0}), size));
}

TEST(LabelPlaces, NothingIsPutOntoABlockedDisc) {
  LabelPlaces places;
  places.block({1.0, 0.5}, 0.25);
  EXPECT_FALSE(places.take(directionOf({1.0, 0.7}), {0.1, 0.1}));
  EXPECT_TRUE(places.take(directionOf({1.0, 0.9}), {0.1, 0.1}));
}

}  // namespace
