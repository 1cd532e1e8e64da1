#include "sightline/formats/ccsds_tdm.h"

#include <string>

#include <gtest/gtest.h>

#include "format_files.h"

namespace {

using namespace sightline::test;
using sightline::formats::readRecording;

/// The azimuth example in the other syntax of numbers: a text TDM with metadata of its own.
std::string tdm(const std::string& metadata, const std::string& data) {
  return "CCSDS_TDM_VERS = 2.0\nCREATION_DATE = 2024-01-01T00:00:00\nORIGINATOR = "
         "TEST\nMETA_START\nTIME_SYSTEM = "
         "UTC\nPARTICIPANT_1 = SITE\nPARTICIPANT_2 = SAT\nMODE = SEQUENTIAL\nPATH = 2,1\n" +
         metadata + "META_STOP\nDATA_START\n" + data + "DATA_STOP\n";
}

const std::string kPair = "ANGLE_1 = 2024-03-12T19:30:15.25 100.0\nANGLE_2 = 2024-03-12T19:30:15.25 20.0\n";

TEST(CcsdsTdm, AnglesOfTheStandardsExampleAreReadFromTextAndXmlAlike) {
  const auto text = readRecording(sample("tdm_azel.txt"), withSigma());
  const auto xml = readRecording(sample("tdm_azel.xml"), withSigma());
  ASSERT_EQ(text.scans.size(), 4u);
  ASSERT_EQ(xml.scans.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(text.scans[i].sensor, "NORTH");
    EXPECT_EQ(xml.scans[i].time, text.scans[i].time);
    EXPECT_EQ(xml.scans[i].sightings.at(0).angles, text.scans[i].sightings.at(0).angles);
  }
  EXPECT_EQ(timeOf(text.scans[0]), "897440257000000000");
  EXPECT_NEAR(text.scans[0].sightings[0].angles.x(), (90.0 - 256.64002393) * kDegree, 1e-12);
  EXPECT_NEAR(text.scans[0].sightings[0].angles.y(), 13.38100016 * kDegree, 1e-12);
  EXPECT_EQ(text.scans[0].sightings[0].target, "F07R07");
  EXPECT_TRUE(contains(remarksOf(text), "data of RANGE are not used"));
}

TEST(CcsdsTdm, AnglesOfMountsWithAxesInTheHorizonAreRefused) {
  for (const char* file : {"tdm_xsye.txt", "tdm_xsye.xml"}) {
    const std::string why = refusal([&] { readRecording(sample(file), withSigma()); });
    EXPECT_TRUE(contains(why, "ANGLE_TYPE XSYE") && contains(why, "export them as AZEL")) << why;
  }
  EXPECT_TRUE(
      contains(refusalOf(tdm("ANGLE_TYPE = XEYN\n", kPair), withSigma()), "file:10: ANGLE_TYPE XEYN"));
}

TEST(CcsdsTdm, CorrectionsAreAddedOnlyWhereTheFileSaysThatTheyAreNotApplied) {
  const std::string corrections = "ANGLE_TYPE = AZEL\nCORRECTION_ANGLE_1 = 1.5\nCORRECTION_ANGLE_2 = -0.5\n";
  const auto angles = [&](const std::string& applied) -> Eigen::Vector2d {
    return read(tdm(corrections + applied, kPair), withSigma()).scans.at(0).sightings.at(0).angles / kDegree;
  };
  EXPECT_LT((angles("CORRECTIONS_APPLIED = NO\n") - Eigen::Vector2d(-11.5, 19.5)).norm(), 1e-9);
  EXPECT_LT((angles("CORRECTIONS_APPLIED = YES\n") - Eigen::Vector2d(-10.0, 20.0)).norm(), 1e-9);
  EXPECT_TRUE(contains(refusalOf(tdm(corrections, kPair), withSigma()),
                       "CORRECTIONS_APPLIED is \"\": say YES or NO"));
}

TEST(CcsdsTdm, TimesOfOtherSystemsBecomeUtc) {
  const std::string utc = timeOf(read(tdm("ANGLE_TYPE = AZEL\n", kPair), withSigma()).scans.at(0));
  EXPECT_EQ(utc, "1710271815250000000");
  const auto in = [](const std::string& system) {
    std::string text = tdm("ANGLE_TYPE = AZEL\n", kPair);
    return text.replace(text.find("UTC"), 3, system);
  };
  EXPECT_EQ(timeOf(read(in("TAI"), withSigma()).scans.at(0)), "1710271778250000000");
  EXPECT_EQ(timeOf(read(in("GPS"), withSigma()).scans.at(0)), "1710271797250000000");
  EXPECT_TRUE(contains(refusalOf(in("MET"), withSigma()),
                       "file:5: TIME_SYSTEM: expected UTC, TAI, GPS or TT, got \"MET\""));
}

TEST(CcsdsTdm, RightAscensionsNeedAFrameAndAStation) {
  EXPECT_TRUE(contains(refusalOf(tdm("ANGLE_TYPE = RADEC\n", kPair), withSigma()), "REFERENCE_FRAME"));
  const std::string text = tdm("ANGLE_TYPE = RADEC\nREFERENCE_FRAME = EME2000\n", kPair);
  EXPECT_TRUE(contains(refusalOf(text, withSigma()), "--station SITE=LATITUDE,LONGITUDE,HEIGHT"));
  auto options = withSigma();
  options.stations["SITE"] = {48.0 * kDegree, 11.0 * kDegree, 500.0};
  const auto recording = read(text, options);
  EXPECT_EQ(sightingsOf(recording), 1u);
  EXPECT_EQ(recording.stations.count("SITE"), 1u);
}

TEST(CcsdsTdm, ACombinedMessageHoldsSeveral) {
  std::string xml = sightline::formats::TextFile::fromFile(sample("tdm_azel.xml")).text();
  const std::size_t begin = xml.find("<tdm"), end = xml.find("</tdm>") + 6;
  std::string second = xml.substr(begin, end - begin);
  for (std::size_t at = second.find("T00:57"); at != std::string::npos; at = second.find("T00:57"))
    second.replace(at, 6, "T00:58");
  EXPECT_EQ(sightingsOf(read("<ndm>" + xml.substr(begin, end - begin) + second + "</ndm>", withSigma())), 8u);
}

TEST(CcsdsTdm, MistakesAreNamed) {
  EXPECT_TRUE(contains(refusal([] { readRecording(sample("tdm_azel.txt"), {}); }), "--sigma"));
  EXPECT_TRUE(contains(refusalOf(tdm("", kPair), withSigma()), "ANGLE_TYPE is missing"));
  EXPECT_TRUE(contains(refusalOf(tdm("ANGLE_TYPE = AZEL\n", "ANGLE_1 = today 1\n"), withSigma()),
                       "file:13: ANGLE_1: expected an epoch"));
  EXPECT_TRUE(
      contains(refusalOf(tdm("ANGLE_TYPE = AZEL\n", "ANGLE_1 = 2024-03-12T19:30:15 1e3\n"), withSigma()),
               "expected degrees, -180 to 360, got \"1e3\""));
  EXPECT_TRUE(contains(refusalOf(tdm("ANGLE_TYPE = AZEL\n", kPair + kPair), withSigma()), "stands twice"));
  const std::string text = tdm("ANGLE_TYPE = AZEL\n", kPair);
  EXPECT_TRUE(
      contains(refusalOf(text.substr(0, text.find("DATA_STOP")), withSigma()), "ends without DATA_STOP"));
  const std::string xml = sightline::formats::TextFile::fromFile(sample("tdm_azel.xml")).text();
  EXPECT_TRUE(contains(refusalOf(xml.substr(0, 2000), withSigma()), "is no complete XML"));
  const auto lone =
      read(tdm("ANGLE_TYPE = AZEL\n", kPair + "ANGLE_1 = 2024-03-12T19:31:00 1\n"), withSigma());
  EXPECT_EQ(lone.scans.size(), 1u);
  EXPECT_TRUE(contains(remarksOf(lone), "angles without the other one"));
}

}  // namespace
