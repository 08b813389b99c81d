// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whole files, in a folder of the test's own.
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
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

TEST_F(File, LinksInACircleAreRefused) {
  fs::create_symlink("b", path("a"));
  fs::create_symlink("a", path("b"));
  EXPECT_FALSE(check_writable(path("a")).has_value());
  const auto written = write_file(path("a"), "x");
  ASSERT_FALSE(written.has_value());
  EXPECT_NE(written.error().message.find(path("a")), std::string::npos);
  EXPECT_TRUE(fs::is_symlink(path("a")));
  EXPECT_EQ(folder_.entries(), 2u);
}

TEST_F(File, ALinkToNothingYetGetsItsFile) {
  fs::create_symlink("later", path("link"));
  ASSERT_TRUE(write_file(path("link"), "x").has_value());
  EXPECT_TRUE(fs::is_symlink(path("link")));
  EXPECT_EQ(*read_file(path("later")), "x");
}

// In a container every run has the same process number.
TEST_F(File, WhatAKilledProcessLeftBehindIsNotInTheWay) {
  for (unsigned n = 0; n < 200; ++n) {
    const std::string left =
        path("a.json") + "." + std::to_string(getpid()) + "-" + std::to_string(n) + ".tmp";
    std::ofstream(left) << "half of";
  }
  const auto written = write_file(path("a.json"), "x");
  ASSERT_TRUE(written.has_value()) << written.error().message;
  EXPECT_EQ(*read_file(path("a.json")), "x");
  EXPECT_EQ(folder_.entries(), 201u);
}

TEST_F(File, TwoNamesOfOneFileAreKnown) {
  fs::create_directory(path("sub"));
  fs::create_symlink(folder_.path(), path("folder"));
  fs::create_symlink("new", path("link"));
  const std::string file = path("new");
  const auto one = [&](const char* other) { return is_same_file(file, path(other)); };
  const fs::path before = fs::current_path();
  fs::current_path(folder_.path());
  // Before it is there, and afterwards.
  for (const bool there : {false, true}) {
    SCOPED_TRACE(there ? "there" : "not there yet");
    if (there) {
      ASSERT_TRUE(write_file(file, "x").has_value());
    }
    EXPECT_TRUE(one("new"));
    EXPECT_TRUE(one("./sub/../new"));
    EXPECT_TRUE(one("folder/new"));
    EXPECT_TRUE(one("link"));
    EXPECT_TRUE(is_same_file("new", file));
    EXPECT_FALSE(one("other"));
    EXPECT_FALSE(one("sub/new"));
    EXPECT_FALSE(one("no/such/new"));
  }
  fs::current_path(before);
  EXPECT_TRUE(is_same_file("/no/such/new", "/no/./such/new"));
  fs::create_hard_link(file, path("hard"));
  EXPECT_TRUE(one("hard"));
}

// A file that cannot be replaced, as one that a container was given alone, on a disk of one page.
class MountedFile : public File {
 protected:
  void SetUp() override {
    fs::create_directory(path("disk"));
    disk_ = mount("none", path("disk").c_str(), "tmpfs", 0, "size=4096") == 0;
    if (!disk_) GTEST_SKIP() << "a mount takes the rights of root";
    ASSERT_TRUE(write_file(path("a.json"), "").has_value());
    ASSERT_TRUE(write_file(path("disk/file"), "old content").has_value());
    file_ =
        mount(path("disk/file").c_str(), path("a.json").c_str(), nullptr, MS_BIND, nullptr) == 0;
    ASSERT_TRUE(file_);
  }
  void TearDown() override {
    if (file_) umount(path("a.json").c_str());
    if (disk_) umount(path("disk").c_str());
  }

  bool disk_ = false;
  bool file_ = false;
};

TEST_F(MountedFile, IsOverwritten) {
  for (const std::string bytes : {"longer than what was there before", "short", ""}) {
    ASSERT_TRUE(check_writable(path("a.json")).has_value());
    const auto written = write_file(path("a.json"), bytes);
    ASSERT_TRUE(written.has_value()) << written.error().message;
    EXPECT_EQ(*read_file(path("a.json")), bytes);
    EXPECT_EQ(*read_file(path("disk/file")), bytes);
    EXPECT_EQ(folder_.entries(), 2u) << "a temporary file stayed behind";
  }
  EXPECT_TRUE(is_same_file(path("a.json"), path("disk/file")));
}

TEST_F(MountedFile, KeepsWhatItHadWhereThereIsNoRoom) {
  EXPECT_FALSE(write_file(path("a.json"), std::string(3 * 4096, 'x')).has_value());
  EXPECT_EQ(*read_file(path("a.json")), "old content");
}

// What `job` says in a child that is nobody in particular.
int as_nobody(const std::function<int()>& job) {
  const pid_t child = fork();
  if (child == 0) {
    constexpr uid_t kNobody = 65534;
    const bool changed = geteuid() != 0 || (setgid(kNobody) == 0 && setuid(kNobody) == 0);
    _exit(changed ? job() : 100);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST_F(File, AWritableFileInAReadOnlyFolderIsOverwritten) {
  ASSERT_TRUE(write_file(path("a.json"), "old").has_value());
  fs::permissions(path("a.json"), fs::perms(0666));
  fs::permissions(folder_.path(), fs::perms(0555));
  EXPECT_EQ(as_nobody([&] {
              if (!check_writable(path("a.json"))) return 1;
              if (check_writable(path("new.json")) || write_file(path("new.json"), "x")) return 2;
              return write_file(path("a.json"), "new content") ? 0 : 3;
            }),
            0);
  fs::permissions(folder_.path(), fs::perms(0755));
  EXPECT_EQ(*read_file(path("a.json")), "new content");
  EXPECT_EQ(folder_.entries(), 1u);
}

struct stat info_of(const std::string& path) {
  struct stat info {};
  EXPECT_EQ(stat(path.c_str(), &info), 0) << path;
  return info;
}

// As where root calibrates beside a service that is to read its file.
TEST_F(File, RootLeavesAFileToItsOwner) {
  constexpr uid_t kOwner = 1234;
  constexpr gid_t kGroup = 1235;
  ASSERT_TRUE(write_file(path("a.json"), "old").has_value());
  ASSERT_EQ(chmod(path("a.json").c_str(), 0640), 0);
  if (chown(path("a.json").c_str(), kOwner, kGroup) != 0) GTEST_SKIP() << "takes root";
  const auto written = write_file(path("a.json"), "new content");
  ASSERT_TRUE(written.has_value()) << written.error().message;
  EXPECT_EQ(*read_file(path("a.json")), "new content");
  const struct stat now = info_of(path("a.json"));
  EXPECT_EQ(now.st_uid, kOwner);
  EXPECT_EQ(now.st_gid, kGroup);
  EXPECT_EQ(now.st_mode & 07777, 0640U);
}

// Whoever cannot give a file away does not take it either.
TEST_F(File, AFileOfAnotherStaysHis) {
  ASSERT_TRUE(write_file(path("a.json"), "old").has_value());
  fs::permissions(path("a.json"), fs::perms(0666));
  fs::permissions(folder_.path(), fs::perms(0777));
  const struct stat before = info_of(path("a.json"));
  EXPECT_EQ(as_nobody([&] { return write_file(path("a.json"), "new content") ? 0 : 1; }), 0);
  EXPECT_EQ(*read_file(path("a.json")), "new content");
  EXPECT_EQ(info_of(path("a.json")).st_uid, before.st_uid);
  EXPECT_EQ(folder_.entries(), 1U) << "a temporary file stayed behind";
}

// Whoever may not write a file does not replace it either, though the folder would let him.
TEST_F(File, AReadOnlyFileIsLeftAlone) {
  ASSERT_TRUE(write_file(path("a.json"), "old").has_value());
  fs::permissions(path("a.json"), fs::perms(0444));
  fs::permissions(folder_.path(), fs::perms(0777));
  EXPECT_EQ(as_nobody([&] {
              return !check_writable(path("a.json")) && !write_file(path("a.json"), "new") ? 0 : 1;
            }),
            0);
  EXPECT_EQ(*read_file(path("a.json")), "old");
}

TEST_F(File, DevicesAreWrittenNotReplaced) {
  EXPECT_TRUE(write_file("/dev/null", "x").has_value());
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_FALSE(write_file("/dev/full", "x").has_value());
}

}  // namespace
}  // namespace calvin
