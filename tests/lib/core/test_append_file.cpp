// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A file that only grows: all of what is appended or nothing, and one writer.
#include <sys/stat.h>

#include <filesystem>

#include <gtest/gtest.h>

#include "calvin/core/append_file.hpp"
#include "calvin/core/file.hpp"
#include "file_size_limit.hpp"
#include "temporary_folder.hpp"

namespace calvin {
namespace {

class AppendFiles : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  std::string path_ = folder_.path("journal");
};

TEST_F(AppendFiles, KeepWhatWasThereAndGrow) {
  ASSERT_TRUE(write_file(path_, "one\n"));
  auto file = AppendFile::open(path_);
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->read(100), "one\n");
  EXPECT_TRUE(file->append("two\n"));
  EXPECT_TRUE(file->append("three\n"));
  EXPECT_TRUE(file->sync());
  EXPECT_EQ(read_file(path_), "one\ntwo\nthree\n");
  EXPECT_TRUE(file->cut(8));
  EXPECT_TRUE(file->append("four\n"));
  EXPECT_EQ(file->read(100), "one\ntwo\nfour\n");
  EXPECT_EQ(file->read(8).error().code, ErrorCode::kIo);
}

TEST_F(AppendFiles, HaveOneWriter) {
  auto first = AppendFile::open(path_);
  ASSERT_TRUE(first);
  const auto second = AppendFile::open(path_);
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().message.find("another one"), std::string::npos);
  AppendFile moved = *std::move(first);
  EXPECT_FALSE(AppendFile::open(path_)) << "it is still open";
  EXPECT_TRUE(moved.append("x"));
}

TEST_F(AppendFiles, AreFreeOnceTheirWriterIsGoneOrDone) {
  { const auto first = AppendFile::open(path_); }
  const auto second = AppendFile::open(path_);
  ASSERT_TRUE(second);
  second->unlock();
  EXPECT_TRUE(AppendFile::open(path_));
  EXPECT_TRUE(second->sync());
}

// A journal must not end with half a line.
TEST_F(AppendFiles, HoldAllThatWasAppendedOrNothingOfIt) {
  auto file = AppendFile::open(path_);
  ASSERT_TRUE(file);
  ASSERT_TRUE(file->append("whole\n"));
  {
    const FileSizeLimit limit(10);
    const Status half = file->append("twice as much\n");
    ASSERT_FALSE(half);
    EXPECT_NE(half.error().message.find("ulimit"), std::string::npos) << half.error().message;
  }
  EXPECT_EQ(read_file(path_), "whole\n");
  EXPECT_TRUE(file->append("twice as much\n"));
  EXPECT_EQ(read_file(path_), "whole\ntwice as much\n");
}

TEST_F(AppendFiles, ThatAreRemovedTakeNothingMore) {
  auto file = AppendFile::open(path_);
  ASSERT_TRUE(file);
  std::filesystem::remove(path_);
  EXPECT_FALSE(file->append("to nobody"));
}

TEST_F(AppendFiles, AreRegularFiles) {
  EXPECT_FALSE(AppendFile::open(folder_.path()));
  EXPECT_FALSE(AppendFile::open(folder_.path("none/journal")));
  EXPECT_FALSE(AppendFile::open(""));
  ASSERT_EQ(mkfifo(path_.c_str(), 0600), 0);
  const auto pipe = AppendFile::open(path_);
  ASSERT_FALSE(pipe);
  EXPECT_NE(pipe.error().message.find("not a regular file"), std::string::npos);
  EXPECT_FALSE(AppendFile::open("/dev/null"));
}

}  // namespace
}  // namespace calvin
