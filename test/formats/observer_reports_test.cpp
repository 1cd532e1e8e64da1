#include "sightline/formats/observer_reports.h"

#include <cmath>

#include <gtest/gtest.h>

#include "sightline/formats/star_coordinates.h"

#include "format_files.h"

namespace {

using namespace sightline::test;
using sightline::formats::Equinox;
using sightline::formats::horizontalOf;
using sightline::formats::ImportOptions;
using sightline::formats::readRecording;
using sightline::formats::Station;

const Station kSite{52.0 * kDegree, -2.0 * kDegree, 70.0};

ImportOptions atSite() {
  ImportOptions options = withSigma();
  options.stations["9999"] = kSite;
  return options;
}

Eigen::Vector2d expected(double hours, double declination_deg, Equinox equinox, sightline::core::Time time) {
  return *horizontalOf({hours * 15.0 * kDegree, declination_deg * kDegree}, equinox, time, kSite, 0.0);
}

TEST(ObserverReports, IodAnglesAreUnpackedByTheirCode) {
  const auto recording = readRecording(sample("iod.txt"), atSite());
  ASSERT_EQ(recording.scans.size(), 4u);
  EXPECT_EQ(recording.scans[0].sensor, "9999");
  EXPECT_EQ(timeOf(recording.scans[0]), "1710271815250000000");
  EXPECT_EQ(timeOf(recording.scans[1]), "1710271820000000000");  // 19:30:2 is 19:30:20
  const auto angles = [&](std::size_t i) -> Eigen::Vector2d {
    return recording.scans[i].sightings.at(0).angles;
  };
  // 05h12.345m, +45d12.30m, J2000; 2 digits of uncertainty: 1 unit of the 0th power, a minute of arc
  EXPECT_LT(apart(angles(0), expected(5.0 + 12.345 / 60.0, 45.0 + 12.30 / 60.0, Equinox::j2000,
                                      recording.scans[0].time)),
            1e-12);
  EXPECT_NEAR(recording.scans[0].sightings[0].sigma.y(), kDegree / 60.0, 1e-12);
  EXPECT_NEAR(recording.scans[0].sightings[0].sigma.x() * std::cos(angles(0).y()), kDegree / 60.0, 1e-12);
  // azimuth 270 and elevation 45 degrees, to 0.002 degrees
  EXPECT_LT(apart(angles(1), {-180.0 * kDegree, 45.0 * kDegree}), 1e-12);
  EXPECT_NEAR(recording.scans[1].sightings[0].sigma.y(), 0.002 * kDegree, 1e-12);
  // 05h12m30.3s, -05d15'30", to 30 seconds of arc
  EXPECT_LT(apart(angles(2), expected(5.0 + 12.0 / 60.0 + 30.3 / 3600.0, -(5.0 + 15.0 / 60.0 + 30.0 / 3600.0),
                                      Equinox::j2000, recording.scans[2].time)),
            1e-12);
  EXPECT_NEAR(recording.scans[2].sightings[0].sigma.y(), 30.0 * kDegree / 3600.0, 1e-12);
  // 05h12m30.3s, +05.1250d, B1950, no uncertainty: as told
  EXPECT_LT(apart(angles(3), expected(5.0 + 12.0 / 60.0 + 30.3 / 3600.0, 5.1250, Equinox::b1950,
                                      recording.scans[3].time)),
            1e-12);
  EXPECT_EQ(recording.scans[3].sightings[0].sigma.y(), 0.002);
  EXPECT_TRUE(
      contains(remarksOf(recording),
               "reports without angles (brightness, or the state of the station) are left out (2 lines"));
  EXPECT_TRUE(contains(remarksOf(recording), "lines of other text are left out (2 lines, first line 1)"));
}

TEST(ObserverReports, UkAnglesAreUnpackedByTheirCode) {
  const auto recording = readRecording(sample("uk.txt"), atSite());
  ASSERT_EQ(recording.scans.size(), 4u);
  const auto angles = [&](std::size_t i) -> Eigen::Vector2d {
    return recording.scans[i].sightings.at(0).angles;
  };
  // the report of 1997 is the first
  EXPECT_EQ(timeOf(recording.scans[0]), "858195030000000000");
  EXPECT_LT(apart(angles(0), expected(5.0 + 12.0 / 60.0 + 30.3 / 3600.0, -(5.0 + 15.0 / 60.0 + 30.0 / 3600.0),
                                      Equinox::b1950, recording.scans[0].time)),
            1e-12);
  EXPECT_NEAR(recording.scans[0].sightings[0].sigma.y(), 120.0 * kDegree / 3600.0, 1e-12);
  EXPECT_EQ(timeOf(recording.scans[1]), "1710271815250000000");
  EXPECT_LT(apart(angles(1),
                  expected(5.0 + 12.34 / 60.0, 45.0 + 12.3 / 60.0, Equinox::j2000, recording.scans[1].time)),
            1e-12);
  EXPECT_NEAR(recording.scans[1].sightings[0].sigma.y(), kDegree / 60.0, 1e-12);
  EXPECT_LT(apart(angles(2), {-180.0 * kDegree, 45.0 * kDegree}), 1e-12);
  EXPECT_NEAR(recording.scans[2].sightings[0].sigma.y(), 0.2 * kDegree, 1e-12);
  EXPECT_LT(apart(angles(3), {0.0, 45.0 * kDegree}), 1e-12);
  EXPECT_TRUE(contains(remarksOf(recording), "as refracted by the air (1 line, first line 4)"));
}

TEST(ObserverReports, PositionsAndSigmasAreAskedFor) {
  EXPECT_TRUE(contains(refusal([] { readRecording(sample("iod.txt"), withSigma()); }), "--station 9999="));
  ImportOptions options = atSite();
  options.sigma.reset();
  EXPECT_TRUE(contains(refusal([&] { readRecording(sample("iod.txt"), options); }), "--sigma"));
}

TEST(ObserverReports, MistakesAreNamed) {
  EXPECT_TRUE(contains(refusalOf(changed("iod.txt", "0512345+451230", "0575345+451230"), atSite()),
                       "file:3: angles of code 2 cannot be \"0575345\" and \"+451230\""));
  EXPECT_TRUE(contains(refusalOf(changed("iod.txt", "17 25 0512345", "17 23 0512345"), atSite()),
                       "code of the equinox is \"3\""));
  EXPECT_TRUE(contains(refusalOf(changed("iod.txt", "17 25 0512345", "17 95 0512345"), atSite()),
                       "code of the angles is \"9\""));
  EXPECT_TRUE(contains(refusalOf(changed("iod.txt", "20240312193015250", "20241312193015250"), atSite()),
                       "expected a time YYYYMMDDHHMMSSsss, got \"20241312193015250\""));
}

}  // namespace
