// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whole files, in a folder of the test's own.
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "calvin/core/file.hpp"
#include "temporary_folder.hpp"

namespace calvin {
namespace {

namespace fs = std::filesystem;

class File : public testing::Test {
 protected:
  [[nodiscard]] std::string path(const char* name) const { return folder_.path(name); }

  TemporaryFolder folder_;
};

TEST_F(File, WhatIsWrittenIsRead) {
  const std::string bytes("a\0b\r\n\xff", 6);
  ASSERT_TRUE(write_file(path("a.bin"), "longer than what follows").has_value());
  ASSERT_TRUE(write_file(path("a.bin"), bytes).has_value());
  const auto read = read_file(path("a.bin"));
  ASSERT_TRUE(read.has_value()) << read.error().message;
  EXPECT_EQ(*read, bytes);
  EXPECT_EQ(folder_.entries(), 1u) << "a temporary file stayed behind";
}

TEST_F(File, KeepsModeAndLink) {
  ASSERT_TRUE(write_file(path("real"), "old").has_value());
  ASSERT_EQ(chmod(path("real").c_str(), 0640), 0);
  fs::create_symlink("real", path("link"));
  ASSERT_TRUE(write_file(path("link"), "new").has_value());
  EXPECT_TRUE(fs::is_symlink(path("link")));
  EXPECT_EQ(*read_file(path("real")), "new");
  struct stat info {};
  ASSERT_EQ(stat(path("real").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0640u);
}

TEST_F(File, NewFilesFollowTheUmask) {
  const mode_t before = umask(027);
  EXPECT_TRUE(write_file(path("new"), "x").has_value());
  umask(before);
  struct stat info {};
  ASSERT_EQ(stat(path("new").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0640u);
}

TEST_F(File, ReadErrorsSayWhich) {
  EXPECT_EQ(read_file(path("none")).error().code, ErrorCode::kNotFound);
  EXPECT_NE(read_file(path("none")).error().message.find(path("none")), std::string::npos);
  EXPECT_EQ(read_file(folder_.path()).error().code, ErrorCode::kIo);
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  EXPECT_EQ(read_file(path("pipe")).error().code, ErrorCode::kIo);
  ASSERT_TRUE(write_file(path("big"), std::string(1001, 'x')).has_value());
  EXPECT_EQ(read_file(path("big"), 1000).error().code, ErrorCode::kIo);
  EXPECT_TRUE(read_file(path("big"), 1001).has_value());
}

TEST_F(File, WriteErrorsLeaveNothing) {
  for (const std::string& wrong :
       {std::string(), path("none/a.json"), folder_.path(), folder_.path() + "/"}) {
    const auto written = write_file(wrong, "x");
    ASSERT_FALSE(written.has_value()) << wrong;
    EXPECT_EQ(written.error().code, ErrorCode::kIo) << wrong;
    EXPECT_FALSE(check_writable(wrong).has_value()) << wrong;
  }
  EXPECT_EQ(folder_.entries(), 0u);
  EXPECT_TRUE(check_writable(path("a.json")).has_value());
  EXPECT_EQ(folder_.entries(), 0u) << "check_writable() touched the folder";
}

TEST_F(File, DevicesAreWrittenNotReplaced) {
  EXPECT_TRUE(write_file("/dev/null", "x").has_value());
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_FALSE(write_file("/dev/full", "x").has_value());
}

}  // namespace
}  // namespace calvin
