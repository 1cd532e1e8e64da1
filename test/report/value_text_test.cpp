#include "sightline/report/value_text.h"

#include <limits>

#include <gtest/gtest.h>

using namespace sightline::report;

namespace {

TEST(ValueText, ANumberHasThreeDigitsOrAllBeforeThePoint) {
  EXPECT_EQ(valueOf(0.7349, "s"), "0.735 s");
  EXPECT_EQ(valueOf(-12.0, "rad"), "-12 rad");
  EXPECT_EQ(valueOf(3600.4, "s"), "3600 s");
  EXPECT_EQ(valueOf(1e16, "s"), "1e+16 s");
}

TEST(ValueText, ALongListNamesTheFirstAndCountsTheRest) {
  EXPECT_EQ(listOf({}), "");
  EXPECT_EQ(listOf({"b", "a"}), "a, b");
  EXPECT_EQ(listOf({"a", "b", "c"}, 3), "a, b, c");
  EXPECT_EQ(listOf({"a", "b", "c", "d"}, 2), "a, b and 2 more");
}

TEST(ValueText, ANumberIsReadOnlyFromAWholeFiniteText) {
  EXPECT_EQ(numberFrom("-1.5e3"), -1500.0);
  for (const char* text : {"", "1.5 s", "1,5", "nan", "inf", "never"}) EXPECT_FALSE(numberFrom(text)) << text;
}

TEST(OrEmpty, ATenDigitFigureOrNothing) {
  EXPECT_EQ(orEmpty(1.0 / 3.0), "0.3333333333");
  EXPECT_EQ(orEmpty(std::numeric_limits<double>::quiet_NaN()), "");
}

TEST(CsvCell, IsInQuotesOnlyWhereItNeedsThem) {
  EXPECT_EQ(csvCell("cam 1"), "cam 1");
  EXPECT_EQ(csvCell("a,b"), "\"a,b\"");
  EXPECT_EQ(csvCell("say \"a\""), "\"say \"\"a\"\"\"");
}

TEST(IsAmong, AWholeNameOnly) {
  EXPECT_TRUE(isAmong({"time", "sigma"}, "sigma"));
  EXPECT_FALSE(isAmong({"time", "sigma"}, "sig"));
}

}  // namespace
