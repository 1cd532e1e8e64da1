#include "sightline/formats/csv_sightings.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "format_files.h"

namespace {

using namespace sightline::test;
using sightline::formats::ImportOptions;
using sightline::formats::Recording;

const std::string kHead = "time,sensor,azimuth,elevation,sigma_azimuth,sigma_elevation\n";

ImportOptions withColumns(const std::string& columns) {
  ImportOptions options = withSigma();
  options.columns = columns;
  return options;
}

TEST(CsvSightings, ThisPackagesOwnTableNeedsNoOption) {
  const Recording recording =
      read(kHead + "1000.5,cam,0.1,0.3,0.001,0.002\n999.25,cam,-0.1,0.2,0.001,0.002\n");
  ASSERT_EQ(recording.scans.size(), 2u);
  EXPECT_EQ(timeOf(recording.scans[0]), "999250000000");
  EXPECT_EQ(recording.scans[1].sightings[0].angles, Eigen::Vector2d(0.1, 0.3));
  EXPECT_EQ(recording.scans[1].sightings[0].sigma, Eigen::Vector2d(0.001, 0.002));
}

TEST(CsvSightings, SeparatorsDecimalCommasCommentsAndExtraColumnsAreFound) {
  const std::string rows =
      "time;sensor;azimuth;elevation;sigma_azimuth;sigma_elevation\n1000,5;cam;0,1;0,3;0,001;0,002\n";
  for (const char separator : {';', '\t', '|'}) {
    std::string text = rows;
    std::replace(text.begin(), text.end(), ';', separator);
    const Recording recording = read(text);
    EXPECT_EQ(timeOf(recording.scans.at(0)), "1000500000000") << separator;
    EXPECT_EQ(recording.scans[0].sightings[0].angles, Eigen::Vector2d(0.1, 0.3));
    EXPECT_TRUE(contains(remarksOf(recording), "decimal commas"));
  }
  const Recording blanks = read(
      "# made by hand\r\ntime  sensor azimuth elevation label\r\n 1 cam  0.1 0.3 \"x y\"\r\n", withSigma());
  EXPECT_EQ(sightingsOf(blanks), 1u);
  EXPECT_TRUE(contains(remarksOf(blanks), "columns not used: label"));
  ImportOptions points;
  points.decimal_comma = false;
  EXPECT_TRUE(contains(refusalOf(rows, points), "expected a finite number [s], got \"1000,5\""));
}

TEST(CsvSightings, IsoTimesDegreesAndTheCompass) {
  const Recording recording = read(
      "datetime,camera,az_deg,alt_deg,err_az,err_alt\n2026-03-01T21:54:00.250Z,cam,359.000,17.2,0.06,0.06\n",
      withColumns("time=datetime,sensor=camera,azimuth=az_deg:deg:compass,elevation=alt_deg:deg,"
                  "sigma_azimuth=err_az:deg,sigma_elevation=err_alt:deg"));
  EXPECT_EQ(timeOf(recording.scans.at(0)), "1772402040250000000");
  EXPECT_NEAR(recording.scans[0].sightings[0].angles.x(), 91.0 * kDegree, 1e-12);
  EXPECT_NEAR(recording.scans[0].sightings[0].angles.y(), 17.2 * kDegree, 1e-12);
  EXPECT_NEAR(recording.scans[0].sightings[0].sigma.x(), 0.06 * kDegree, 1e-12);
}

TEST(CsvSightings, UnitsOfTimesFollowFromTheirSizeAndAreSaid) {
  for (const std::string time : {"1700000000.123", "1700000000123", "1700000000123000", "1700000000123000000",
                                 "2023-11-14 22:13:20.123", "2023-11-15T00:13:20.123+02:00"}) {
    EXPECT_EQ(timeOf(read("time,sensor,azimuth,elevation\n" + time + ",a,0,0\n", withSigma()).scans.at(0)),
              "1700000000123000000")
        << time;
  }
  EXPECT_TRUE(contains(remarksOf(read("time,sensor,azimuth,elevation\n1700000000123,a,0,0\n", withSigma())),
                       "time [ms]"));
  EXPECT_TRUE(
      contains(remarksOf(read("time,sensor,azimuth,elevation\n2023-11-14 22:13:20,a,0,0\n", withSigma())),
               "times without a zone are UTC"));
}

TEST(CsvSightings, MathematicalAzimuthsArcsAndSnr) {
  const Recording recording = read("t;dir;el;s;q\n12;350;60;1;5\n", [] {
    ImportOptions options =
        withColumns("time=t:s,azimuth=dir:deg:math,elevation=el:deg,sigma_azimuth=s:deg:arc,snr=q");
    options.sensor = "df";
    return options;
  }());
  const auto& sighting = recording.scans.at(0).sightings.at(0);
  EXPECT_NEAR(sighting.angles.x(), -10.0 * kDegree, 1e-12);
  EXPECT_NEAR(sighting.sigma.x(), 2.0 * kDegree, 1e-12);
  EXPECT_EQ(sighting.sigma.y(), 0.002);
  EXPECT_EQ(sighting.snr, 5.0);
}

TEST(CsvSightings, RowsWithoutAnglesSawNothing) {
  const Recording recording =
      read("time,sensor,azimuth,elevation\n1,a,0.1,0.2\n2,a,,\n3,a,nan,NaN\n", withSigma());
  ASSERT_EQ(recording.scans.size(), 3u);
  EXPECT_EQ(sightingsOf(recording), 1u);
  EXPECT_TRUE(recording.scans[1].sightings.empty());
  EXPECT_TRUE(contains(remarksOf(recording), "saw nothing (2 lines, first line 3)"));
  EXPECT_TRUE(contains(refusalOf("time,sensor,azimuth,elevation\n1,a,0.1,\n", withSigma()),
                       "file:2: elevation is empty"));
}

TEST(CsvSightings, RowsOfOneScanAreOneExposureAndOthersAreScansOfTheirOwn) {
  const std::string rows = "1,a,0.1,0.2,7\n1,a,0.3,0.2,7\n2,a,0.1,0.2,8\n";
  EXPECT_EQ(read("time,sensor,azimuth,elevation,scan\n" + rows, withSigma()).scans.size(), 2u);
  const Recording apart = read("time,sensor,azimuth,elevation,n\n" + rows, withSigma());
  EXPECT_EQ(apart.scans.size(), 3u);
  EXPECT_TRUE(contains(remarksOf(apart), "--columns scan=time"));
  EXPECT_EQ(read("time,sensor,azimuth,elevation,n\n" + rows, withColumns("scan=time,time=time")).scans.size(),
            2u);
  EXPECT_TRUE(contains(refusalOf("time,sensor,azimuth,elevation,scan\n1,a,0,0,7\n2,a,0,0,7\n", withSigma()),
                       "different times"));
}

TEST(CsvSightings, TablesWithoutAHeaderAreReadByNumbersOrByACommentedHeader) {
  const Recording numbers =
      read("1,a,45,10\n2,a,46,10\n", withColumns("time=#1:s,sensor=#2,azimuth=#3:deg:math,elevation=#4:deg"));
  EXPECT_EQ(numbers.scans.size(), 2u);
  const Recording commented = read("# time azimuth elevation\n1.0e+00 4.5e-01 1.0e-01\n", [] {
    ImportOptions options = withSigma();
    options.sensor = "a";
    return options;
  }());
  EXPECT_EQ(commented.scans.at(0).sightings.at(0).angles, Eigen::Vector2d(0.45, 0.1));
}

TEST(CsvSightings, WhatIsMissingIsAskedForByItsOption) {
  EXPECT_TRUE(
      contains(refusalOf("datetime,camera,az_deg,alt_deg\n2026-03-01T21:54:00Z,cam,1,2\n"),
               "--columns time=datetime,sensor=camera,azimuth=az_deg:deg:compass,elevation=alt_deg:deg"));
  EXPECT_TRUE(contains(refusalOf("time,sensor,azimuth\n1,a,0.1\n"), "--elevation 0deg"));
  EXPECT_TRUE(contains(refusalOf("time,azimuth,elevation\n1,0.1,0\n", withSigma()), "--sensor NAME"));
  EXPECT_TRUE(contains(refusalOf("time,sensor,azimuth,elevation\n1,a,0.1,0\n"), "--sigma 0.05deg"));
  EXPECT_TRUE(contains(refusalOf("time,sensor,az,elevation\n1,a,0.1,0\n", withColumns("azimuth=az")),
                       "azimuth=az:deg:compass"));
  EXPECT_TRUE(contains(refusalOf("time,sensor,az,elevation\n1,a,0.1,0\n", withColumns("azimuth=az:deg")),
                       ":compass or :math"));
  ImportOptions options = withSigma();
  options.elevation = 0.0;
  EXPECT_EQ(read("time,sensor,azimuth\n1,a,0.1\n", options).scans.at(0).sightings.at(0).angles,
            Eigen::Vector2d(0.1, 0.0));
}

TEST(CsvSightings, MistakesAreNamedWithLineValueAndRemedy) {
  EXPECT_TRUE(contains(refusalOf(kHead + "1,cam,200,0.3,0.001,0.002\n"),
                       "file:2: azimuth: 200 is no azimuth in rad"));
  EXPECT_TRUE(contains(refusalOf(kHead + "1,cam,0.1,0.3,0.001\n"),
                       "file:2: expected 6 fields between commas, got 5"));
  EXPECT_TRUE(contains(refusalOf(kHead + "1,cam,0.1,0.3,0.001,x\n"),
                       "sigma_elevation: expected a finite number [rad], got \"x\""));
  EXPECT_TRUE(contains(refusalOf(kHead + "1,cam,0.1,0.3,0,0.1\n"), "file:2: "));
  EXPECT_TRUE(contains(refusalOf(kHead + "1,cam,0.1,0.3,0.001,0.002\nyesterday,cam,0.1,0.3,0.001,0.002\n"),
                       "file:3: time: expected a time in the unit s, got \"yesterday\""));
  EXPECT_TRUE(contains(refusalOf("time,time\n1,2\n"), "stands twice"));
  EXPECT_TRUE(
      contains(refusalOf(kHead, withColumns("azimuth=nothing:deg:math")), "there is no column \"nothing\""));
  EXPECT_TRUE(
      contains(refusalOf(kHead, withColumns("bearing=azimuth")), "a column is one of time, sensor, azimuth"));
  EXPECT_TRUE(contains(refusalOf(kHead, withColumns("azimuth=azimuth:gon:math")),
                       "is meant as a unit or convention"));
  EXPECT_TRUE(contains(refusalOf(kHead), "there is no sighting"));
}

}  // namespace
