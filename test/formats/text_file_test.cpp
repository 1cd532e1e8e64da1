#include "sightline/formats/text_file.h"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "format_files.h"
#include "support/scratch_folder.h"

namespace {

using namespace sightline::test;
using namespace sightline::formats;

TEST(TextFile, LinesOfAllSystemsAndTheByteOrderMark) {
  const TextFile file("f", "\xEF\xBB\xBF  a\r\nb \n\nc");
  ASSERT_EQ(file.lines(), 4u);
  EXPECT_EQ(file.line(1), "a");
  EXPECT_EQ(file.wholeLine(1), "  a");
  EXPECT_EQ(file.line(2), "b");
  EXPECT_EQ(file.line(3), "");
  EXPECT_EQ(file.line(4), "c");
  EXPECT_EQ(file.lineOf(0), 1u);
  EXPECT_EQ(file.lineOf(file.text().size() - 1), 4u);
  EXPECT_STREQ(file.error(2, "wrong").what(), "f:2: wrong");
}

TEST(TextFile, WhatIsNoTextIsRefused) {
  const ScratchFolder folder;
  EXPECT_TRUE(contains(refusal([&] { TextFile::fromFile(folder.file("none")); }), "none: cannot be opened"));
  EXPECT_TRUE(contains(refusal([&] { TextFile::fromFile(folder.file("")); }), "is a folder"));
  EXPECT_TRUE(
      contains(refusal([] { TextFile("f", std::string("a\0b", 3)); }), "is no text file: byte 1 is zero"));
  EXPECT_TRUE(contains(refusal([] { TextFile("f", "\xFF\xFE"); }), "UTF-16"));
  EXPECT_TRUE(contains(refusal([] { TextFile("f", "#ROSBAG V2.0\n"); }), "is a bag already"));
  EXPECT_TRUE(contains(refusal([] { TextFile("f", std::string(kLongestLine + 1, 'x')).line(1); }),
                       "f:1: has 65537 bytes"));
  const std::string large = folder.write("large", "x");
  std::filesystem::resize_file(large, kLargestFile + (1 << 20));
  EXPECT_TRUE(contains(refusal([&] { TextFile::fromFile(large); }), "has 257 MiB, more than the 256 MiB"));
}

}  // namespace
