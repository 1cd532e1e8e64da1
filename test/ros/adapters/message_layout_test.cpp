#include "sightline/ros/adapters/message_layout.h"

#include <algorithm>
#include <nav_msgs/Odometry.h>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <ros/message_traits.h>
#include <ros/serialization.h>
#include <sightline/SightingArray.h>

#include "support/complaint.h"

namespace sightline_ros {
namespace {

using sightline::test::complaintOf;

template <typename Message>
std::vector<std::uint8_t> bytesOf(const Message& message) {
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  return bytes;
}

template <typename Message>
MessageLayout layoutOf() {
  return {ros::message_traits::datatype<Message>(), ros::message_traits::definition<Message>()};
}

Bytes view(const std::vector<std::uint8_t>& bytes) {
  return {bytes.data(), bytes.size()};
}

nav_msgs::Odometry odometry() {
  nav_msgs::Odometry message;
  message.header.stamp = ros::Time(12, 345);
  message.header.frame_id = "map";
  message.child_frame_id = "a longer name than that";
  message.pose.pose.position.y = -7.5;
  message.pose.covariance[14] = 0.25;
  message.twist.twist.angular.z = 3.0;
  return message;
}

TEST(MessageLayout, FieldsBehindStringsAndNestedTypesAreFound) {
  const auto layout = layoutOf<nav_msgs::Odometry>();
  const auto bytes = bytesOf(odometry());
  const auto whole = layout.whole();
  EXPECT_EQ(layout.number(view(bytes), whole, "pose.pose.position.y"), -7.5);
  EXPECT_EQ(layout.number(view(bytes), whole, "pose.covariance[14]"), 0.25);
  EXPECT_EQ(layout.number(view(bytes), whole, "twist.twist.angular.z"), 3.0);
  EXPECT_EQ(layout.text(view(bytes), whole, "header.frame_id"), "map");
  EXPECT_EQ(layout.time(view(bytes), whole, "header.stamp"), ros::Time(12, 345));
}

TEST(MessageLayout, ElementsOfVariableLengthAreWalkedOneByOne) {
  diagnostic_msgs::DiagnosticArray message;
  for (const char* name : {"a", "longer", ""}) {
    diagnostic_msgs::DiagnosticStatus status;
    status.name = name;
    status.level = static_cast<std::int8_t>(message.status.size());
    status.values.resize(message.status.size());
    for (auto& value : status.values) value.key = "key of " + status.name;
    message.status.push_back(status);
  }
  const auto layout = layoutOf<diagnostic_msgs::DiagnosticArray>();
  const auto bytes = bytesOf(message);
  const auto places = layout.elements(view(bytes), layout.find(view(bytes), layout.whole(), "status"));
  ASSERT_EQ(places.size(), 3u);
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_EQ(layout.text(view(bytes), places[i], "name"), message.status[i].name);
    EXPECT_EQ(layout.number(view(bytes), places[i], "level"), static_cast<double>(i));
  }
  EXPECT_EQ(layout.text(view(bytes), layout.whole(), "status[2].values[1].key"), "key of ");
}

TEST(MessageLayout, EveryNumericTypeIsRead) {
  const std::string definition =
      "uint8 ONE=1  # a constant takes no room\nstring NAME = a # b\nbool b\nint8 i8\nuint8 u8\nint16 i16\n"
      "uint16 u16\nint32 i32\nuint32 u32\nint64 i64\nuint64 u64\nfloat32 f32\n  float64   f64 # comment\n"
      "time t\nduration d\nbyte[2] pair\nchar[] list\n";
  const MessageLayout layout("acme/All", definition);
  std::vector<std::uint8_t> bytes(200);
  ros::serialization::OStream out(bytes.data(), 200);
  out.next(std::uint8_t{1});
  out.next(std::int8_t{-2});
  out.next(std::uint8_t{200});
  out.next(std::int16_t{-300});
  out.next(std::uint16_t{60000});
  out.next(std::int32_t{-70000});
  out.next(std::uint32_t{4000000000u});
  out.next(std::int64_t{-5000000000});
  out.next(std::uint64_t{6000000000});
  out.next(1.5F);
  out.next(-2.25);
  out.next(ros::Time(10, 500000000));
  out.next(ros::Duration(-0.5));
  out.next(std::uint8_t{7});
  out.next(std::uint8_t{8});
  out.next(std::uint32_t{2});
  out.next(std::uint8_t{9});
  out.next(std::uint8_t{10});
  const auto number = [&](const std::string& path) {
    return layout.number(view(bytes), layout.whole(), path);
  };
  EXPECT_EQ(number("b"), 1.0);
  EXPECT_EQ(number("i8"), -2.0);
  EXPECT_EQ(number("u8"), 200.0);
  EXPECT_EQ(number("i16"), -300.0);
  EXPECT_EQ(number("u16"), 60000.0);
  EXPECT_EQ(number("i32"), -70000.0);
  EXPECT_EQ(number("u32"), 4e9);
  EXPECT_EQ(number("i64"), -5e9);
  EXPECT_EQ(number("u64"), 6e9);
  EXPECT_EQ(number("f32"), 1.5);
  EXPECT_EQ(number("f64"), -2.25);
  EXPECT_EQ(number("t"), 10.5);
  EXPECT_EQ(number("d"), -0.5);
  EXPECT_EQ(number("pair[1]"), 8.0);
  EXPECT_EQ(number("list[0]"), 9.0);
}

TEST(MessageLayout, TypesOfTheSamePackageNeedNoPackageName) {
  const auto layout = layoutOf<sightline::SightingArray>();
  sightline::SightingArray scan;
  scan.sensor = "s";
  scan.sightings.resize(2);
  scan.sightings[1].covariance[3] = 4.0;
  const auto bytes = bytesOf(scan);
  EXPECT_EQ(layout.number(view(bytes), layout.whole(), "sightings[1].covariance[3]"), 4.0);
  EXPECT_TRUE(layout.has("sightings[1].covariance[3]"));
  EXPECT_TRUE(layout.has("header.stamp"));
  EXPECT_FALSE(layout.has("head.stamp"));
}

TEST(MessageLayout, PathsMayHaveIndicesBehindDotsAndSlashes) {
  const auto layout = layoutOf<sightline::SightingArray>();
  sightline::SightingArray scan;
  scan.sightings.resize(2);
  scan.sightings[1].covariance[3] = 4.0;
  const auto bytes = bytesOf(scan);
  for (const std::string path : {"sightings.1.covariance.3", "sightings[1].covariance.3",
                                 "/sightings/1/covariance/3", "/sightings.1/covariance[3]"}) {
    EXPECT_TRUE(layout.has(path)) << path;
    EXPECT_TRUE(layout.exists(view(bytes), layout.whole(), path)) << path;
    EXPECT_EQ(layout.number(view(bytes), layout.whole(), path), 4.0) << path;
  }
  EXPECT_FALSE(layout.exists(view(bytes), layout.whole(), "sightings.2.covariance.3")) << "there are two";
  EXPECT_TRUE(layout.has("sightings.2.covariance.3")) << "of the type";
  EXPECT_FALSE(layout.exists(view(bytes), layout.whole(), "sighting.0"));
  EXPECT_TRUE(layout.has("/header"));
}

TEST(MessageLayout, WrongPathsAreRefusedWithWhatThereIs) {
  const auto layout = layoutOf<nav_msgs::Odometry>();
  const auto bytes = bytesOf(odometry());
  const auto complaint = [&](const std::string& path) {
    return complaintOf<FieldError>([&] { layout.number(view(bytes), layout.whole(), path); });
  };
  EXPECT_EQ(complaint("pose.pose.position.w"),
            "field \"pose.pose.position.w\" does not exist: geometry_msgs/Point has x, y, z");
  EXPECT_NE(complaint("pose.covariance").find("is an array: give an index"), std::string::npos);
  EXPECT_NE(complaint("pose.covariance[36]").find("covariance has 36 elements"), std::string::npos);
  EXPECT_NE(complaint("pose.pose[0].position").find("is no array"), std::string::npos);
  EXPECT_NE(complaint("pose.pose").find("is of type geometry_msgs/Pose, not a number"), std::string::npos);
  EXPECT_NE(complaint("pose..x").find("malformed"), std::string::npos);
  EXPECT_NE(complaint("pose.covariance[1").find("malformed"), std::string::npos);
  EXPECT_NE(complaint("").find("malformed"), std::string::npos);
  EXPECT_NE(complaint("/").find("malformed"), std::string::npos);
  EXPECT_NE(complaint("3.x").find("does not exist"), std::string::npos);
  EXPECT_NE(complaint("pose.covariance.36").find("covariance has 36 elements"), std::string::npos);
}

TEST(MessageLayout, TruncatedAndLyingMessagesAreRefusedAtEveryLength) {
  const auto layout = layoutOf<diagnostic_msgs::DiagnosticArray>();
  diagnostic_msgs::DiagnosticArray message;
  message.status.resize(2);
  message.status[1].name = "name";
  message.status[1].values.resize(1);
  const auto bytes = bytesOf(message);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_THROW(layout.text({bytes.data(), size}, layout.whole(), "status[1].values[0].value"), FieldError)
        << size;
  }
  auto lying = bytes;
  std::fill(lying.begin() + 12, lying.begin() + 16, std::uint8_t{255});  // the length of header.frame_id
  EXPECT_THROW(layout.text(view(lying), layout.whole(), "status[1].name"), FieldError);
}

TEST(MessageLayout, ADefinitionThatIsNoneIsRefused) {
  EXPECT_THROW(MessageLayout("acme/Bad", "this is not ! a definition"), FieldError);
}

TEST(MessageLayout, ADefinitionWithoutEndIsRefused) {
  const auto complaint = [](const std::string& definition) {
    return complaintOf<FieldError>([&] { MessageLayout("a/A", definition); });
  };
  EXPECT_NE(complaint("A next\n").find("a/A contains itself"), std::string::npos);
  EXPECT_NE(complaint("B b\n===\nMSG: a/B\nA[] more\n").find("contains itself"), std::string::npos);
  EXPECT_NE(complaint("int8[99999999999999999999] x\n").find("99999999999999999999 elements"),
            std::string::npos);
  std::string nested = "T0 x\n";
  for (int level = 0; level < 100; ++level)
    nested += "===\nMSG: a/T" + std::to_string(level) + "\nT" + std::to_string(level + 1) + " x\n";
  EXPECT_NE(complaint(nested).find("nested deeper than 32"), std::string::npos);
}

TEST(MessageLayout, FieldsThatTakeNoBytesTakeNoTime) {
  // Twice as many at each level: 2^30 of nothing.
  std::string definition = "T0[1000000] many\nfloat64 value\n";
  for (int level = 0; level < 30; ++level) {
    const std::string next = "T" + std::to_string(level + 1);
    definition += "===\nMSG: a/T" + std::to_string(level) + "\n" + next + " x\n" + next + " y\n";
  }
  definition += "===\nMSG: a/T30\n";
  const MessageLayout layout("a/A", definition);
  const double value = 1.5;
  const Bytes message{reinterpret_cast<const std::uint8_t*>(&value), sizeof value};
  EXPECT_EQ(layout.number(message, layout.whole(), "value"), 1.5);
}

}  // namespace
}  // namespace sightline_ros
