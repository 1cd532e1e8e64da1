#include "sightline/report/csv_table.h"

#include <functional>
#include <sstream>

#include <gtest/gtest.h>

#include "support/complaint.h"

using namespace sightline::report;
using sightline::test::complaintOf;
namespace core = sightline::core;

namespace {

CsvTable table(const std::string& text) {
  std::istringstream stream(text);
  return CsvTable(stream, "in.csv", {"time", "x"}, {"name"});
}

TEST(CsvTable, ColumnsStandInAnyOrderAndBlankLinesDoNotCount) {
  const CsvTable read = table("\xEF\xBB\xBFx, time\r\n\n 2.5 ,1\r\n   \n-3,2\n");
  ASSERT_EQ(read.rows(), 2u);
  EXPECT_EQ(read.number(0, "x", "m"), 2.5);
  EXPECT_EQ(read.text(1, "x"), "-3");
  EXPECT_FALSE(read.has("name"));
  EXPECT_TRUE(table("time,x,name\n").has("name"));
}

TEST(CsvTable, TimesAreExactToTheNanosecond) {
  const CsvTable read = table("time,x\n1700000000.123456789,0\n-0.25,0\n1e3,0\n");
  EXPECT_EQ(read.time(0, "time"), core::timeOf(1700000000123456789));
  EXPECT_EQ(read.time(1, "time"), core::timeOf(-250000000));
  EXPECT_EQ(read.time(2, "time"), core::timeOf(1000000000000));
}

TEST(CsvTable, AComplaintNamesFileLineAndValue) {
  const CsvTable read = table("time,x\n\n1,far\n1e12,1\n");
  EXPECT_EQ(complaintOf<CsvError>([&] { read.number(0, "x", "m"); }),
            "in.csv:3: x: expected a finite number [m], got \"far\"");
  EXPECT_EQ(complaintOf<CsvError>([&] { read.time(1, "time"); }),
            "in.csv:4: time: expected seconds, got 1e12 (milli- or nanoseconds?)");
  EXPECT_EQ(std::string(read.error(0, "x: is far").what()), "in.csv:3: x: is far");
}

TEST(CsvTable, AHeaderWithMistakesIsRefused) {
  EXPECT_NE(complaintOf<CsvError>([] { table(""); }).find("expected a header line: time,x"),
            std::string::npos);
  EXPECT_NE(complaintOf<CsvError>([] { table("time\n"); }).find("\"x\" is missing"), std::string::npos);
  for (const char* separated : {"time;x\n", "time\tx\n", "time|x\n"}) {
    EXPECT_NE(complaintOf<CsvError>([&] { table(separated); }).find("not between commas"), std::string::npos)
        << separated;
  }
  EXPECT_NE(complaintOf<CsvError>([] { table("time,x,y\n"); }).find("unknown column \"y\""),
            std::string::npos);
  EXPECT_NE(complaintOf<CsvError>([] { table("time,x,x\n"); }).find("stands twice"), std::string::npos);
}

TEST(CsvTable, ARowOfAnotherLengthIsRefused) {
  EXPECT_EQ(complaintOf<CsvError>([] { table("time,x\n1,2,3\n"); }), "in.csv:2: expected 2 fields, got 3");
}

TEST(CsvTable, AFileThatIsNotThereIsRefusedByName) {
  const auto read = [] { CsvTable::fromFile("/no/such/file.csv", {"time"}); };
  EXPECT_EQ(complaintOf<CsvError>(read).find("/no/such/file.csv: cannot be opened"), 0u);
}

}  // namespace
