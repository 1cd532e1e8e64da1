#include "sightline/ros/recordings/message_ring.h"

#include <boost/make_shared.hpp>

#include <gtest/gtest.h>

#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <std_msgs/String.h>

#include "sightline/ros/recordings/bags.h"

#include "support/scratch_folder.h"

namespace {

using sightline_ros::MessageRing;
using sightline_ros::RecordedMessage;

constexpr std::size_t kPlenty = 1000000;  // [bytes]

RecordedMessage messageAt(double t, const std::string& text, const std::string& topic = "/a",
                          bool latched = false, const std::string& publisher = "/node") {
  std_msgs::String content;
  content.data = text;
  const std::uint32_t size = ros::serialization::serializationLength(content);
  std::vector<std::uint8_t> buffer(size);
  ros::serialization::OStream out(buffer.data(), size);
  ros::serialization::serialize(out, content);
  const auto shifter = boost::make_shared<topic_tools::ShapeShifter>();
  shifter->morph(ros::message_traits::md5sum<std_msgs::String>(),
                 ros::message_traits::datatype<std_msgs::String>(),
                 ros::message_traits::definition<std_msgs::String>(), latched ? "1" : "0");
  ros::serialization::IStream in(buffer.data(), size);
  shifter->read(in);
  auto header = sightline_ros::latchedHeader<std_msgs::String>();
  (*header)["latching"] = latched ? "1" : "0";
  (*header)["callerid"] = publisher;
  return {topic, ros::Time(t), shifter, header};
}

std::string textOf(const RecordedMessage& message) {
  return message.message->instantiate<std_msgs::String>()->data;
}

std::vector<std::string> textsOf(const MessageRing& ring) {
  std::vector<std::string> texts;
  for (const RecordedMessage& message : ring.messages()) texts.push_back(textOf(message));
  return texts;
}

using Texts = std::vector<std::string>;

TEST(MessageRing, HoldsTheLastSeconds) {
  MessageRing ring(10.0, kPlenty);
  for (int t = 100; t <= 125; ++t) ring.add(messageAt(t, std::to_string(t)));
  EXPECT_EQ(ring.size(), 11u);
  EXPECT_EQ(textsOf(ring).front(), "115");
  EXPECT_EQ(textsOf(ring).back(), "125");
  EXPECT_DOUBLE_EQ(ring.span(), 10.0);
  EXPECT_EQ(ring.crowdedOut(), 0u);
}

TEST(MessageRing, StaysWithinItsMemoryWhateverComes) {
  MessageRing ring(1e6, 20000);
  for (int i = 0; i < 5000; ++i) {
    ring.add(messageAt(100.0 + i, std::string(static_cast<std::size_t>(i) % 3000, 'x'), "/a", i % 7 == 0,
                       "/node" + std::to_string(i)));
    ASSERT_LE(ring.bytes(), 20000u);
  }
  EXPECT_GT(ring.size(), 1u);
  EXPECT_GT(ring.crowdedOut(), 0u);
}

TEST(MessageRing, MessageLargerThanAllMemoryCostsNothingElse) {
  MessageRing ring(10.0, 5000);
  ring.add(messageAt(100.0, "small"));
  ring.add(messageAt(101.0, std::string(6000, 'x')));
  EXPECT_EQ(textsOf(ring), Texts{"small"});
  EXPECT_EQ(ring.crowdedOut(), 1u);
}

TEST(MessageRing, LatchedMessagesOutliveTheWindowAndComeFirst) {
  MessageRing ring(10.0, kPlenty);
  ring.add(messageAt(100.0, "of left, old", "/tf_static", true, "/left"));
  ring.add(messageAt(101.0, "of left", "/tf_static", true, "/left"));
  ring.add(messageAt(102.0, "of right", "/tf_static", true, "/right"));
  for (int t = 103; t <= 150; ++t) ring.add(messageAt(t, std::to_string(t)));
  const auto messages = ring.messages();
  ASSERT_EQ(messages.size(), 13u);
  EXPECT_EQ(textOf(messages[0]), "of left");
  EXPECT_EQ(textOf(messages[1]), "of right");
  EXPECT_EQ(messages[0].received, ros::Time(139, 999999999));
  EXPECT_EQ(messages[2].received, ros::Time(140.0));
}

TEST(MessageRing, TimeThatGoesBackForgetsWhatCameAfterIt) {
  MessageRing ring(100.0, kPlenty);
  for (const double t : {100.0, 101.0, 102.0}) ring.add(messageAt(t, std::to_string(int(t))));
  ring.add(messageAt(100.5, "again"));
  EXPECT_EQ(textsOf(ring), (Texts{"100", "again"}));
}

TEST(MessageRing, IsWrittenAsItWasReceived) {
  MessageRing ring(10.0, kPlenty);
  ring.add(messageAt(90.0, "fixed", "/tf_static", true));
  ring.add(messageAt(100.0, "first"));
  ring.add(messageAt(105.0, "second", "/b"));
  const ScratchFolder folder;
  sightline_ros::writeBag(folder.file("ring.bag"), {},
                          [&](rosbag::Bag& bag) { write(bag, ring.messages()); });

  rosbag::Bag bag(folder.file("ring.bag"));
  rosbag::View view(bag);
  std::vector<std::string> seen;
  for (const rosbag::MessageInstance& message : view) {
    seen.push_back(message.getTopic() + " " + std::to_string(message.getTime().sec) + " " +
                   message.instantiate<std_msgs::String>()->data + (message.isLatching() ? " latched" : ""));
  }
  EXPECT_EQ(seen, (Texts{"/tf_static 99 fixed latched", "/a 100 first", "/b 105 second"}));
}

}  // namespace
