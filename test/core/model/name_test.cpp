#include "sightline/core/model/name.h"

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

TEST(Name, IsRefusedBeyond255LettersAndQuotedShort) {
  EXPECT_FALSE(whyTooLong("the sensor's name", ""));
  EXPECT_FALSE(whyTooLong("the sensor's name", std::string(255, 'x')));
  const std::string too_long(10000000, 'x');
  const auto refusal = whyTooLong("the sensor's name", too_long);
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->kind, "invalid");
  EXPECT_EQ(refusal->detail, "the sensor's name \"" + std::string(32, 'x') +
                                 "...\" has 10000000 letters: give it at most 255");
  EXPECT_EQ(readableName("camera"), "camera");
  EXPECT_EQ(readableName(too_long).size(), 35u);
}

TEST(Name, SourcesAreRefusedWhereTheyAreTooManyOrTooLong) {
  EXPECT_FALSE(whyTooLong(std::vector<std::string>(1024, "camera")));
  EXPECT_TRUE(whyTooLong(std::vector<std::string>(1025, "camera")));
  EXPECT_TRUE(whyTooLong({"camera", std::string(256, 'x')}));
}

}  // namespace
}  // namespace sightline::core
