#include "sightline/formats/csv_columns.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "format_files.h"

namespace {

using namespace sightline::test;
using namespace sightline::formats;

CsvLayout csvLayout(const std::string& text, const std::string& columns = "") {
  ImportOptions options;
  options.columns = columns;
  return csvLayoutOf(TextFile("f", text), options);
}

TEST(CsvColumns, SeparatorsAreFoundInTheOrderOfTheirRarity) {
  EXPECT_EQ(separatorOf("a\tb;c,d"), '\t');
  EXPECT_EQ(separatorOf("a 1;b,c"), ';');
  EXPECT_EQ(separatorOf("a b,c|d"), ',');
  EXPECT_EQ(separatorOf("a|b"), '|');
  EXPECT_EQ(separatorOf("a b"), ' ');
}

TEST(CsvColumns, ColumnsAreFoundByThisPackagesNamesAndByAssignment) {
  const CsvLayout layout =
      csvLayout("# x\n\nt,elevation,dir,azimuth,sensor\n", "time=t,azimuth=dir:deg:compass");
  EXPECT_EQ(layout.first_row, 4u);
  EXPECT_EQ(layout.columns.at("time").place, 0u);
  EXPECT_EQ(layout.columns.at("azimuth").place, 2u);
  EXPECT_EQ(layout.columns.at("azimuth").unit, "deg");
  EXPECT_EQ(layout.columns.at("azimuth").convention, "compass");
  EXPECT_EQ(layout.columns.at("elevation").place, 1u);
  EXPECT_FALSE(layout.columns.at("elevation").is_told);
  EXPECT_FALSE(layout.has("scan"));
}

TEST(CsvColumns, NamesMayHoldColonsOfTheirOwn) {
  const CsvLayout layout =
      csvLayout("UTC:s,az:deg,el:deg\n", "time=UTC:s:iso,azimuth=az:deg:deg:math,elevation=el:deg:deg");
  EXPECT_EQ(layout.columns.at("azimuth").name, "az:deg");
}

TEST(CsvColumns, WithoutAHeaderColumnsHaveNumbers) {
  const CsvLayout layout = csvLayout("1.0 2.0 3.0\n", "time=#1,azimuth=#2:rad:math,elevation=#3:rad");
  EXPECT_EQ(layout.first_row, 1u);
  EXPECT_EQ(layout.names, (std::vector<std::string>{"#1", "#2", "#3"}));
  EXPECT_TRUE(contains(refusal([] { csvLayout("1.0 2.0\n", "time=#3"); }),
                       "there is no column \"#3\"; there are #1, #2"));
}

}  // namespace
