#include "sightline/ros/recordings/recorded_truth.h"

#include <functional>
#include <stdexcept>

#include <gtest/gtest.h>

#include <sightline/TrackArray.h>

#include "sightline/ros/messages/conversions.h"

#include "support/complaint.h"
#include "support/scratch_folder.h"
#include "support/times.h"

using namespace sightline_ros;
using sightline::test::at;
using sightline::test::complaintOf;
namespace core = sightline::core;

namespace {

constexpr core::Channels kBoth = core::Channels::azimuth_and_elevation;
constexpr double kGap = 1.0;  // [s]

class RecordedTruthTest : public testing::Test {
 protected:
  RecordedTruth fromCsv(const std::string& text, core::Channels channels = kBoth) const {
    return truthFromCsv(folder_.write("truth.csv", text), channels, kGap);
  }

  /// A bag with a truth of one target on /truth.
  std::string makeBag() const {
    rosbag::Bag bag(folder_.file("in.bag"), rosbag::bagmode::Write);
    sightline::TrackArray truth;
    truth.header.stamp = ros::Time(100.0);
    truth.header.frame_id = "platform_enu";
    truth.tracks.resize(1);
    truth.tracks[0].id = 4;
    truth.tracks[0].azimuth = 0.5;
    truth.tracks[0].elevation_rate = 0.25;
    bag.write("/truth", truth.header.stamp, truth);
    return folder_.file("in.bag");
  }

  ScratchFolder folder_;
};

TEST_F(RecordedTruthTest, OfACsvFileHasTheRatesOfItsMotion) {
  const RecordedTruth truth = fromCsv(
      "time,target,azimuth,elevation\n"
      "100.2,1,0.14,0.0\n100.0,1,0.10,0.0\n100.1,1,0.12,0.0\n100.1,2,1.0,0.5\n");
  ASSERT_EQ(truth.motions.size(), 1u);
  EXPECT_EQ(truth.frame, "");
  const Motions& motions = truth.motions.at("");
  ASSERT_EQ(motions.size(), 3u);
  EXPECT_NEAR(motions.at(at(100.1)).at(1)(0), 0.12, 1e-9);
  EXPECT_NEAR(motions.at(at(100.1)).at(1)(2), 0.2, 1e-6);
  EXPECT_NEAR(motions.at(at(100.1)).at(2)(3), 0.0, 1e-12);  // it has no neighbour
}

TEST_F(RecordedTruthTest, TargetsKeepTheirNumbersOrAreNumberedByTheAlphabet) {
  const auto idsOf = [](const RecordedTruth& truth) {
    std::vector<std::uint32_t> ids;
    for (const auto& [id, motion] : truth.motions.at("").begin()->second) ids.push_back(id);
    return ids;
  };
  const std::string header = "time,target,azimuth,elevation\n";
  EXPECT_EQ(idsOf(fromCsv(header + "100,17,0,0\n100,4,0,0\n")), (std::vector<std::uint32_t>{4, 17}));
  EXPECT_EQ(idsOf(fromCsv(header + "100,gull,0,0\n100,4,0,0\n")), (std::vector<std::uint32_t>{1, 2}));
}

TEST_F(RecordedTruthTest, SensorsMayHaveTruthsOfTheirOwn) {
  const RecordedTruth truth = fromCsv("time,sensor,azimuth,elevation\n100,a,0.1,0\n100,b,0.2,0\n");
  EXPECT_NEAR(truth.motions.at("a").at(at(100.0)).at(1)(0), 0.1, 1e-12);
  EXPECT_NEAR(truth.motions.at("b").at(at(100.0)).at(1)(0), 0.2, 1e-12);
}

TEST_F(RecordedTruthTest, WithoutElevationsOnlyAzimuthsAreCompared) {
  const std::string text = "time,azimuth\n100,0.1\n";
  EXPECT_NE(complaintOf<std::runtime_error>([&] { fromCsv(text); }).find("--azimuth-only"),
            std::string::npos);
  EXPECT_EQ(fromCsv(text, core::Channels::azimuth_only).motions.at("").size(), 1u);
}

TEST_F(RecordedTruthTest, AnglesThatAreRoundedBeyondTheEndOfTheirRangeAreTaken) {
  const RecordedTruth truth = fromCsv("time,azimuth,elevation\n100,6.2831855,1.570796327\n");
  EXPECT_NEAR(truth.motions.at("").at(at(100.0)).at(1)(1), 0.5 * core::kPi, 1e-12);
}

TEST_F(RecordedTruthTest, DegreesAndEmptyFilesAreRefused) {
  EXPECT_NE(complaintOf<std::runtime_error>([&] {
              fromCsv("time,azimuth,elevation\n100,45,0\n");
            }).find("degrees?"),
            std::string::npos);
  EXPECT_NE(complaintOf<std::runtime_error>([&] { fromCsv("time,azimuth,elevation\n"); }).find("no sample"),
            std::string::npos);
}

TEST_F(RecordedTruthTest, OfATopicHasItsFrameAndMotions) {
  const rosbag::Bag bag(makeBag(), rosbag::bagmode::Read);
  const RecordedTruth truth = readTruth("/truth", bag, kBoth, kGap);
  EXPECT_EQ(truth.frame, "platform_enu");
  const Eigen::Vector4d motion = truth.motions.at("").at(at(100.0)).at(4);
  EXPECT_EQ(motion, Eigen::Vector4d(0.5, 0.0, 0.0, 0.25));
}

TEST_F(RecordedTruthTest, WhatIsNeitherATopicNorAFileIsRefusedWithTheTopics) {
  const rosbag::Bag bag(makeBag(), rosbag::bagmode::Read);
  const std::string complaint =
      complaintOf<std::runtime_error>([&] { readTruth("/true", bag, kBoth, kGap); });
  EXPECT_EQ(complaint.find("/true: "), 0u) << complaint;
  EXPECT_NE(complaint.find("/truth"), std::string::npos) << complaint;
}

}  // namespace
