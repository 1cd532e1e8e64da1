#include "sightline/ros/recordings/bags.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <topic_tools/shape_shifter.h>
#include <vector>

#include <gtest/gtest.h>

#include <rosbag/view.h>
#include <std_msgs/Header.h>
#include <std_msgs/String.h>

#include "support/complaint.h"
#include "support/file_size_limit.h"
#include "support/scratch_folder.h"

using namespace sightline_ros;
using sightline::test::complaintOf;

namespace {

TEST(Bags, AFileThatIsMissingOrNoBagIsRefusedByName) {
  const ScratchFolder folder;
  const std::string missing = folder.file("missing.bag"), text = folder.write("text.bag", "no bag");
  EXPECT_EQ(complaintOf<std::runtime_error>([&] { openBag(missing); }), missing + ": there is no such file");
  EXPECT_EQ(complaintOf<std::runtime_error>([&] { openBag(text); }).find(text + ": is no readable bag"), 0u);
}

TEST(Bags, AWriterPutsTheFileInPlaceOnlyWhenItIsFinished) {
  const ScratchFolder folder;
  const std::string file = folder.file("out.bag");
  {
    BagWriter writer(file);
    writer->write("/text", ros::Time(1.0), std_msgs::String());
  }
  EXPECT_TRUE(std::filesystem::is_empty(std::filesystem::path(file).parent_path()));
  {
    BagWriter writer(file);
    writer->write("/text", ros::Time(1.0), std_msgs::String());
    EXPECT_FALSE(std::filesystem::exists(file));
    writer.finish();
  }
  EXPECT_EQ(rosbag::View(*openBag(file)).size(), 1u);
}

TEST(Bags, AFileThatCannotBeWrittenIsRefusedByName) {
  const std::string file = "/no/such/folder/out.bag";
  EXPECT_EQ(
      complaintOf<std::runtime_error>([&] { BagWriter writer(file); }).find(file + ": cannot be written"),
      0u);
}

/// Ten megabytes, which do not stay in buffers.
void writeMuch(rosbag::Bag& bag) {
  std_msgs::String text;
  text.data.assign(100000, 'x');
  for (int i = 1; i <= 100; ++i) bag.write("/text", ros::Time(i), text);
}

TEST(Bags, AFullDiskIsAnErrorWithTheReasonAndLeavesNothing) {
  for (const rlim_t limit : {1000, 6000000}) {  // at once, and in the midst of it
    const ScratchFolder folder;
    const std::string file = folder.file("out.bag");
    const std::string said = complaintOf<std::runtime_error>([&] {
      const FileSizeLimit full(limit);
      writeBag(file, {}, writeMuch);
    });
    EXPECT_EQ(said, file + ": cannot be written: File too large");
    EXPECT_TRUE(std::filesystem::is_empty(std::filesystem::path(file).parent_path()));
  }
  EXPECT_EQ(complaintOf<std::runtime_error>([] { writeBag("/dev/full", {}, writeMuch); }),
            "/dev/full: cannot be written: No space left on device");
}

TEST(Bags, AnInputIsNotOverwritten) {
  const ScratchFolder folder;
  const std::string input = folder.write("in.csv", "data");
  EXPECT_EQ(complaintOf<std::runtime_error>([&] { writeBag(input, {input}, writeMuch); }),
            input + " cannot be read and written at once: name another output");
  EXPECT_EQ(std::filesystem::file_size(input), 4u);
}

TEST(Bags, WhatTheFillerThrowsIsPassedOnAndNothingIsLeft) {
  const ScratchFolder folder;
  const std::string file = folder.file("out.bag");
  EXPECT_EQ(complaintOf<std::runtime_error>(
                [&] { writeBag(file, {}, [](rosbag::Bag&) { throw std::runtime_error("no"); }); }),
            "no");
  EXPECT_TRUE(std::filesystem::is_empty(std::filesystem::path(file).parent_path()));
}

TEST(Bags, AMessageThatWasCutIsNamedWithItsTopicAndTime) {
  const ScratchFolder folder;
  const std::string file = folder.file("cut.bag");
  {
    rosbag::Bag bag(file, rosbag::bagmode::Write);
    topic_tools::ShapeShifter message;
    message.morph(ros::message_traits::md5sum<std_msgs::String>(),
                  ros::message_traits::datatype<std_msgs::String>(),
                  ros::message_traits::definition<std_msgs::String>(), "");
    std::vector<std::uint8_t> bytes = {5, 0, 0, 0, 'a', 'b'};  // a text of five letters
    ros::serialization::IStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
    message.read(stream);
    bag.write("/text", ros::Time(12.5), message);
  }
  const auto bag = openBag(file);
  rosbag::View view(*bag);
  EXPECT_FALSE(messageIn<std_msgs::Header>(*view.begin())) << "of another type";
  const std::string said =
      complaintOf<std::runtime_error>([&] { messageIn<std_msgs::String>(*view.begin()); });
  EXPECT_EQ(said.find("the message on /text that was recorded at 12.500 s is shorter than its type "
                      "std_msgs/String says"),
            0u)
      << said;
}

TEST(Bags, TopicPartsAreLettersDigitsAndUnderscores) {
  EXPECT_TRUE(isTopicPart("eye_2"));
  for (const char* name : {"", "eye 2", "eye/2", "\xC3\xA4"}) EXPECT_FALSE(isTopicPart(name)) << name;
  EXPECT_EQ(sensorTopic("eye", "tracks"), "/sensors/eye/tracks");
}

TEST(Bags, EverySensorHasATopicPartOfItsOwn) {
  const auto parts = topicPartsOf({"eye 1", "eye-1", "eye_1", "left"});
  EXPECT_EQ(parts.at("left"), "left");
  EXPECT_EQ(parts.at("eye_1"), "eye_1");
  std::set<std::string> distinct;
  for (const auto& [sensor, part] : parts) {
    EXPECT_TRUE(isTopicPart(part)) << part;
    distinct.insert(part);
  }
  EXPECT_EQ(distinct.size(), 4u);
}

}  // namespace
