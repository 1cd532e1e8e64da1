#include "sightline/ros/params/param_text.h"

#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

namespace {

using XmlRpc::XmlRpcValue;

std::string textOf(XmlRpcValue value) {
  return sightline_ros::textOf(value);
}

std::string remedyFor(XmlRpcValue value) {
  return sightline_ros::remedyForNumber(value);
}

TEST(ParamText, ShortestTextReadsBackAsTheSameNumber) {
  EXPECT_EQ(sightline_ros::shortestText(0.1), "0.1");
  EXPECT_EQ(sightline_ros::shortestText(1000000.0), "1000000");
  for (const double value : {1.0 / 3.0, 6.02e23, -1e-300, 123456.789}) {
    EXPECT_EQ(std::strtod(sightline_ros::shortestText(value).c_str(), nullptr), value);
  }
}

TEST(ParamText, ValuesAreNamedWithTheirType) {
  EXPECT_EQ(textOf(XmlRpcValue(true)), "true");
  EXPECT_EQ(textOf(XmlRpcValue(3)), "3");
  EXPECT_EQ(textOf(XmlRpcValue(0.25)), "0.25");
  EXPECT_EQ(textOf(XmlRpcValue("1e-3")), "the string \"1e-3\"");
  EXPECT_EQ(textOf(XmlRpcValue()), "no value");
  XmlRpcValue list;
  list.setSize(2);
  EXPECT_EQ(textOf(list), "a list of 2");
}

TEST(ParamText, RemedyIsGivenForStringsThatLookLikeNumbersOnly) {
  EXPECT_EQ(remedyFor(XmlRpcValue("1e-3")), " (write 0.001 or 1.0e-03 with a sign and a point)");
  EXPECT_EQ(remedyFor(XmlRpcValue("fast")), "");
  EXPECT_EQ(remedyFor(XmlRpcValue("")), "");
  EXPECT_EQ(remedyFor(XmlRpcValue(1.0)), "");
}

TEST(ParamText, NearestNameIsFoundForASpellingErrorOnly) {
  const std::set<std::string> asked = {"/node/gate/probability", "/node/max_lag"};
  EXPECT_EQ(sightline_ros::nearestName("/node/max_leg", asked), "/node/max_lag");
  EXPECT_EQ(sightline_ros::nearestName("/node/gate/probabilty", asked), "/node/gate/probability");
  EXPECT_EQ(sightline_ros::nearestName("/node/colour", asked), "");
}

TEST(ParamText, PartsAreJoinedWithTheSeparatorBetween) {
  EXPECT_EQ(sightline_ros::joined({"a", "b", "c"}, ", "), "a, b, c");
  EXPECT_EQ(sightline_ros::joined({}, ", "), "");
}

}  // namespace
