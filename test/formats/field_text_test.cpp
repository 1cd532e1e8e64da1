#include "sightline/formats/field_text.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "format_files.h"

namespace {

using namespace sightline::test;
using namespace sightline::formats;
using sightline::core::Time;

std::int64_t nanoseconds(const std::optional<Time>& time) {
  return time ? time->time_since_epoch().count() : -1;
}

TEST(FieldText, FieldsWithQuotesAndBlanks) {
  using Fields = std::vector<std::string>;
  EXPECT_EQ(fieldsOf(" a , \"b, \"\"c\"\"\" ,", ','), (Fields{"a", "b, \"c\"", ""}));
  EXPECT_EQ(fieldsOf("  a \t b  \"c d\" ", ' '), (Fields{"a", "b", "c d"}));
  EXPECT_EQ(fieldsOf("", ','), (Fields{""}));
  EXPECT_TRUE(fieldsOf("  ", ' ').empty());
}

TEST(FieldText, IsoTimesToTheNanosecondInAllZones) {
  EXPECT_EQ(nanoseconds(isoTime("1970-01-01T00:00:00Z")), 0);
  EXPECT_EQ(nanoseconds(isoTime("2014-11-25T15:21:15.386")), 1416928875386000000);
  EXPECT_EQ(nanoseconds(isoTime("2014-11-25 15:21:15,123456789123 UTC")), 1416928875123456789);
  EXPECT_EQ(nanoseconds(isoTime("2014-329T15:21:15")), 1416928875000000000);
  EXPECT_EQ(nanoseconds(isoTime("2014-11-25T16:21+01:00")), 1416928860000000000);
  EXPECT_EQ(nanoseconds(isoTime("2014-11-25T10:21-0500")), 1416928860000000000);
  EXPECT_EQ(nanoseconds(isoTime("2016-12-31T23:59:60Z")), 1483228800000000000);
  EXPECT_EQ(nanoseconds(isoTime("2000-02-29T00:00:00")), 951782400000000000);
  for (const char* wrong :
       {"2014-02-29T00:00:00", "2014-13-01T00:00:00", "2014-366T00:00:00", "2014-11-25T24:00:00", "noon", ""})
    EXPECT_FALSE(isoTime(wrong)) << wrong;
  EXPECT_TRUE(namesZone("2014-11-25T15:21:15Z"));
  EXPECT_FALSE(namesZone("2014-11-25T15:21:15"));
  EXPECT_EQ(isoText(*isoTime("1969-12-31T23:59:59.25Z")), "1969-12-31T23:59:59.250Z");
}

TEST(FieldText, DecimalTimesKeepTheirDigits) {
  EXPECT_EQ(nanoseconds(decimalTime("1700000000.123456789", 0)), 1700000000123456789);
  EXPECT_EQ(nanoseconds(decimalTime("1700000000123.456789", -3)), 1700000000123456789);
  EXPECT_EQ(nanoseconds(decimalTime("1700000000123456789", -9)), 1700000000123456789);
  EXPECT_EQ(nanoseconds(decimalTime("-0.5", 0)), -500000000);
  EXPECT_EQ(nanoseconds(decimalTime("1.5e3", -3)), 1500000000);
  EXPECT_FALSE(decimalTime("99999999999999999999", -3));
  EXPECT_FALSE(decimalTime("9999999999999999999", 0));
  EXPECT_FALSE(decimalTime("nan", 0));
}

TEST(FieldText, JulianDates) {
  EXPECT_EQ(nanoseconds(julianTime("2440587.5")), 0);
  EXPECT_EQ(nanoseconds(julianTime("2451545.0")), 946728000000000000);
  EXPECT_NEAR(static_cast<double>(nanoseconds(julianTime("2457818.4514367362")) - 1488754204134007680), 0.0,
              20.0);
  EXPECT_FALSE(julianTime("57818.45"));
}

TEST(FieldText, AnglesHaveTheirUnits) {
  EXPECT_NEAR(*angleWithUnit("0.5deg"), 0.5 * kDegree, 1e-15);
  EXPECT_NEAR(*angleWithUnit(" 1e-3 rad"), 1e-3, 1e-15);
  EXPECT_NEAR(*angleWithUnit("-20 arcsec"), -20.0 * kDegree / 3600.0, 1e-15);
  EXPECT_FALSE(angleWithUnit("0.5"));
  EXPECT_FALSE(angleWithUnit("deg"));
  EXPECT_FALSE(angleWithUnit("1gon"));
}

TEST(FieldText, OtherTimeSystemsAreAheadOfUtcByTheirLeapSeconds) {
  const Time time = *isoTime("2020-01-01T00:00:37Z");
  EXPECT_EQ(nanoseconds(utcOf(time, "TAI")), nanoseconds(isoTime("2020-01-01T00:00:00Z")));
  EXPECT_EQ(nanoseconds(utcOf(time, "GPS")), nanoseconds(isoTime("2020-01-01T00:00:19Z")));
  EXPECT_EQ(nanoseconds(utcOf(*isoTime("2016-12-31T00:00:36Z"), "TAI")),
            nanoseconds(isoTime("2016-12-31T00:00:00Z")));
  EXPECT_FALSE(utcOf(time, "MET"));
}

}  // namespace
