#include "sightline/core/model/refusal.h"

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

TEST(Refusal, ItsTextIsKindAndDetail) {
  EXPECT_EQ(textOf({"late", "0.7 s older"}), "late: 0.7 s older");
}

TEST(Refusal, WithoutDetailItsTextIsTheKind) {
  EXPECT_EQ(textOf({"duplicate", ""}), "duplicate");
}

TEST(Refusal, ADetailThatIsTooLongToReadIsCut) {
  const std::string text = textOf({"name", std::string(100000, 'x')});
  EXPECT_LT(text.size(), 1100U);
  EXPECT_NE(text.find("xxx... (100000 letters)"), std::string::npos);
}

}  // namespace
}  // namespace sightline::core
