#include "sightline/ros/display/display_colours.h"

#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace {

using sightline_ros::Colour;
using sightline_ros::dimmed;
using sightline_ros::GateOutcome;
using sightline_ros::withAlpha;

std::vector<float> componentsOf(const Colour& colour) {
  return {colour.r, colour.g, colour.b};
}

TEST(SensorColours, NamesGivenTakeDifferentColoursAndOthersAlwaysTheSame) {
  const sightline_ros::SensorColours colours({"a", "b", "c", "d", "e", "f"});
  std::set<std::vector<float>> distinct;
  for (const char* name : {"a", "b", "c", "d", "e", "f"}) {
    const Colour colour = colours.of(name);
    distinct.insert({colour.r, colour.g, colour.b});
  }
  EXPECT_EQ(distinct.size(), 6U);
  const Colour here = colours.of("another"), there = sightline_ros::SensorColours({"z"}).of("another");
  EXPECT_EQ(here.r, there.r);
  EXPECT_EQ(here.g, there.g);
}

TEST(DisplayColours, OutcomesOfAGateAreToldApart) {
  std::set<std::vector<float>> distinct;
  for (const GateOutcome outcome : {GateOutcome::accepted, GateOutcome::nothing_seen,
                                    GateOutcome::claimed_by_other, GateOutcome::tentative}) {
    distinct.insert(componentsOf(sightline_ros::colourOf(outcome)));
  }
  EXPECT_EQ(distinct.size(), 4U);
}

TEST(DisplayColours, DimmingLeadsFromTheBackgroundToTheColourAndStaysOpaque) {
  const Colour colour = sightline_ros::truthColour();
  EXPECT_EQ(componentsOf(dimmed(colour, 1.0)), componentsOf(colour));
  EXPECT_EQ(componentsOf(dimmed(colour, 0.0)), componentsOf(sightline_ros::backgroundColour()));
  EXPECT_EQ(dimmed(withAlpha(colour, 0.2), 0.5).a, 1.0F);
}

TEST(DisplayColours, AlphaChangesTheOpacityOnly) {
  const Colour colour = sightline_ros::gridColour(), faint = withAlpha(colour, 0.25);
  EXPECT_EQ(componentsOf(faint), componentsOf(colour));
  EXPECT_EQ(faint.a, 0.25F);
}

}  // namespace
