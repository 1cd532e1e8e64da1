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

}  // namespace
}  // namespace sightline::core
