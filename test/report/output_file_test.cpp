#include "sightline/report/output_file.h"

#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <unistd.h>

#include <gtest/gtest.h>

#include "support/complaint.h"
#include "support/file_size_limit.h"
#include "support/scratch_folder.h"

using namespace sightline::report;
using sightline::test::complaintOf;
namespace fs = std::filesystem;

namespace {

TEST(TextFile, IsInItsPlaceOnlyWhenItIsFinished) {
  const ScratchFolder folder;
  const std::string path = folder.write("out.csv", "before");
  {
    TextFile file(path);
    file.stream() << "half of it" << std::flush;
    EXPECT_EQ(textOfFile(path), "before");
  }
  EXPECT_EQ(textOfFile(path), "before");
  TextFile file(path);
  file.stream() << "all of it";
  file.finish();
  EXPECT_EQ(textOfFile(path), "all of it");
  EXPECT_FALSE(fs::exists(path + ".unfinished"));
}

TEST(TextFile, OnAFullDiskIsAnErrorWithTheReasonAndLeavesNothing) {
  const ScratchFolder folder;
  const std::string path = folder.file("out.csv");
  const std::string text(100000, 'x');
  const std::string said = complaintOf<OutputError>([&] {
    TextFile file(path);
    const FileSizeLimit limit(4096);
    file.stream() << text;
    file.finish();
  });
  EXPECT_EQ(said, path + ": cannot be written: File too large");
  EXPECT_TRUE(fs::is_empty(fs::path(path).parent_path()));
}

TEST(TextFile, ADeviceIsWrittenDirectlyAndItsErrorTold) {
  EXPECT_EQ(complaintOf<OutputError>([] {
              TextFile file("/dev/full");
              file.stream() << "text";
              file.finish();
            }),
            "/dev/full: cannot be written: No space left on device");
  TextFile nowhere("/dev/null");
  nowhere.stream() << "text";
  nowhere.finish();
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST(TextFile, WhatCannotBeWrittenIsRefusedByNameAndReason) {
  const ScratchFolder folder;
  const std::string missing = folder.file("no/such/folder.csv");
  EXPECT_EQ(complaintOf<OutputError>([&] { TextFile file(missing); }),
            missing + ": cannot be written: No such file or directory");
  const std::string self = fs::path(folder.file("x")).parent_path();
  EXPECT_EQ(complaintOf<OutputError>([&] { TextFile file(self); }),
            self + ": cannot be written: it is a folder");
  EXPECT_NE(complaintOf<OutputError>([] { TextFile file(""); }), "");
}

TEST(OutputFile, AnInputIsNotOverwrittenUnderWhateverName) {
  const ScratchFolder folder;
  const std::string input = folder.write("in.csv", "data");
  fs::create_symlink(input, folder.file("link.csv"));
  fs::create_hard_link(input, folder.file("hard.csv"));
  const std::string other_way = (fs::path(input).parent_path() / "." / "in.csv").string();
  for (const std::string& name : {input, folder.file("link.csv"), folder.file("hard.csv"), other_way}) {
    EXPECT_EQ(complaintOf<OutputError>([&] {
                OutputFile file(name, {"", input});
              }),
              input + " cannot be read and written at once: name another output")
        << name;
  }
  const std::string unfinished = folder.write("out.csv.unfinished", "an input, too");
  EXPECT_NE(complaintOf<OutputError>([&] { OutputFile file(folder.file("out.csv"), {unfinished}); }), "");
  EXPECT_EQ(textOfFile(input), "data");
  EXPECT_EQ(textOfFile(unfinished), "an input, too");
  EXPECT_EQ(complaintOf<OutputError>([&] { OutputFile file(folder.file("other.csv"), {input}); }), "");
}

TEST(OutputFile, AFileThatMayNotBeWrittenIsNotReplaced) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write everything";
  const ScratchFolder folder;
  const std::string path = folder.write("out.csv", "before");
  fs::permissions(path, fs::perms::owner_read);
  EXPECT_EQ(complaintOf<OutputError>([&] { TextFile file(path); }),
            path + ": cannot be written: Permission denied");
}

TEST(OutputFile, ALinkStaysALinkToWhatIsWritten) {
  const ScratchFolder folder;
  const std::string target = folder.write("target.csv", "before");
  fs::create_symlink(target, folder.file("link.csv"));
  TextFile file(folder.file("link.csv"));
  file.stream() << "after";
  file.finish();
  EXPECT_TRUE(fs::is_symlink(folder.file("link.csv")));
  EXPECT_EQ(textOfFile(target), "after");
}

}  // namespace
