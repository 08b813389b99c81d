// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Places for files that are not like others: pipes, file systems that cannot do everything, names
// that leave no room for more. And what is said where a file cannot be written.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "calvin/core/file.hpp"
#include "temporary_folder.hpp"

// ---- In the place of the C library's: they fail with what is asked for
// ---------------------------

static int fsync_error = 0;
static int fchmod_error = 0;
static int faccessat_error = 0;
static int fsync_failures = -1;  // how often it fails; below 0 always
static int write_error = 0;
static int writes = 0;

static int done_or(int error, long call, int fd, mode_t mode = 0) {
  if (error == 0) return static_cast<int>(::syscall(call, fd, mode));
  errno = error;
  return -1;
}

extern "C" {
int failing_fsync(int fd) asm("fsync");
int failing_fsync(int fd) {
  return done_or(fsync_failures-- == 0 ? 0 : fsync_error, SYS_fsync, fd);
}
// Of one that fails without end a loop would have none: it comes to another error.
ssize_t failing_write(int fd, const void* bytes, size_t size) asm("write");
ssize_t failing_write(int fd, const void* bytes, size_t size) {
  if (write_error == 0) return ::syscall(SYS_write, fd, bytes, size);
  errno = ++writes < 10000 ? write_error : ENOTTY;
  return -1;
}
int failing_fchmod(int fd, mode_t mode) asm("fchmod");
int failing_fchmod(int fd, mode_t mode) { return done_or(fchmod_error, SYS_fchmod, fd, mode); }
int failing_faccessat(int folder, const char* path, int mode, int flags) asm("faccessat");
int failing_faccessat(int folder, const char* path, int mode, int flags) {
  if (faccessat_error == 0)
    return ::syscall(SYS_faccessat2, folder, path, mode, flags) == 0 ? 0 : -1;
  errno = faccessat_error;
  return -1;
}
}

namespace calvin {
namespace {

namespace fs = std::filesystem;

class Place : public testing::Test {
 protected:
  ~Place() override {
    fsync_error = fchmod_error = faccessat_error = write_error = writes = 0;
    fsync_failures = -1;
  }
  [[nodiscard]] std::string path(const std::string& name) const {
    return folder_.path(name.c_str());
  }

  TemporaryFolder folder_;
};

// ---- Pipes and what else a program has open -----------------------------------------------------

struct Pipe {
  Pipe() { opened = ::pipe(ends.data()) == 0; }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  void close_end(std::size_t end) {
    if (ends[end] >= 0) ::close(ends[end]);
    ends[end] = -1;
  }
  [[nodiscard]] std::string name() const { return "/dev/fd/" + std::to_string(ends[1]); }

  std::array<int, 2> ends{-1, -1};
  bool opened = false;
};

// As /dev/stdout | jq, or >(program). More than the pipe holds at once.
TEST_F(Place, APipeGetsAllThatIsWritten) {
  Pipe pipe;
  ASSERT_TRUE(pipe.opened);
  const std::string bytes(300000, 'x');
  std::string read;
  std::thread reader([&] {
    std::array<char, 4096> block;
    while (read.size() < bytes.size()) {
      const ssize_t n = ::read(pipe.ends[0], block.data(), block.size());
      if (n <= 0) break;
      read.append(block.data(), static_cast<std::size_t>(n));
    }
  });
  EXPECT_TRUE(check_writable(pipe.name()).has_value());
  const auto written = write_file(pipe.name(), bytes);
  EXPECT_TRUE(written.has_value()) << written.error().message;
  pipe.close_end(1);
  reader.join();
  EXPECT_TRUE(read == bytes);
}

TEST_F(Place, APipeThatNobodyReadsEndsNoProgram) {
  const std::string fifo = path("fifo");
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  const auto alone = write_file(fifo, "x");
  ASSERT_FALSE(alone.has_value());
  EXPECT_NE(alone.error().message.find("Start the program that is to read"), std::string::npos);
  // A reader that takes nothing but the beginning: by default the signal ends a program.
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGPIPE, SIG_DFL);
    const int reader = ::open(fifo.c_str(), O_RDONLY | O_NONBLOCK);
    std::thread leaves([reader] {
      char byte = 0;
      while (::read(reader, &byte, 1) <= 0) std::this_thread::yield();
      ::close(reader);
    });
    const auto written = write_file(fifo, std::string(1000000, 'x'));
    leaves.join();
    const bool told = !written && written.error().message.find("Start the") != std::string::npos;
    ::_exit(told ? 7 : 8);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status)) << "signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 7);
}

TEST_F(Place, AnOpenFileIsReachedByItsNumber) {
  const std::string file = path("a.json");
  const int fd = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  ASSERT_GE(fd, 0);
  const std::string name = "/dev/fd/" + std::to_string(fd);
  ASSERT_TRUE(write_file(name, "by number").has_value());
  EXPECT_EQ(*read_file(file), "by number");
  EXPECT_TRUE(is_same_file(name, file));
  ::close(fd);

  const int gone = ::open(file.c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_GE(gone, 0);
  fs::remove(file);
  const std::string nameless = "/dev/fd/" + std::to_string(gone);
  EXPECT_TRUE(write_file(nameless, "nameless").has_value());
  EXPECT_EQ(*read_file(nameless), "nameless");
  EXPECT_EQ(folder_.entries(), 0U) << "it has got a name";
  ::close(gone);
}

TEST_F(Place, WhatIsWrittenToAStreamStays) {
  const Pipe pipe;
  const std::string fifo = path("fifo");
  const std::string file = path("a.json");
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  ASSERT_TRUE(write_file(file, "x"));
  const int fd = ::open(file.c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_GE(fd, 0);
  for (const std::string& name : {fifo, pipe.name(), std::string("/dev/null")}) {
    EXPECT_TRUE(is_stream(name)) << name;
  }
  // A folder is none of them, and what is not there becomes a file.
  for (const std::string& name :
       {file, path("none.json"), path("."), "/dev/fd/" + std::to_string(fd)}) {
    EXPECT_FALSE(is_stream(name)) << name;
  }
  ::close(fd);
}

// ---- File systems -------------------------------------------------------------------------------

class CannotSync : public Place, public testing::WithParamInterface<int> {};

// Of them only that it cannot be made to last is known, not that anything is lost.
TEST_P(CannotSync, IsNoReasonNotToWrite) {
  ASSERT_TRUE(write_file(path("a.json"), "old").has_value());
  fsync_error = GetParam();
  for (const char* name : {"a.json", "new.json"}) {
    const auto written = write_file(path(name), "content");
    ASSERT_TRUE(written.has_value()) << written.error().message;
    EXPECT_EQ(*read_file(path(name)), "content");
  }
  EXPECT_EQ(folder_.entries(), 2U);
}

INSTANTIATE_TEST_SUITE_P(Errors, CannotSync, testing::Values(EINVAL, ENOSYS, ENOTSUP));

TEST_F(Place, AnInterruptedSyncIsTriedAgain) {
  fsync_error = EINTR;
  fsync_failures = 2;
  const auto written = write_file(path("a.json"), "content");
  ASSERT_TRUE(written.has_value()) << written.error().message;
  EXPECT_LT(fsync_failures, 0);
}

// A file that always says "try again", as some on networks, is no pipe that has a reader.
TEST_F(Place, AFileThatPutsOffForEverIsGivenUp) {
  write_error = EAGAIN;
  const auto written = write_file(path("a.json"), "content");
  write_error = 0;
  ASSERT_FALSE(written.has_value());
  EXPECT_LT(writes, 1000);
  EXPECT_NE(written.error().message.find("Try again"), std::string::npos)
      << written.error().message;
  EXPECT_EQ(folder_.entries(), 0U) << "a temporary file stayed behind";
}

// As under `ulimit -f`: by default the signal ends a program.
TEST_F(Place, TheLimitOfAFilesSizeEndsNoProgram) {
  ASSERT_TRUE(write_file(path("a.json"), "old").has_value());
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_DFL);
    const rlimit limit = {4096, 4096};
    if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) ::_exit(9);
    const auto written = write_file(path("a.json"), std::string(10000, 'x'));
    ::_exit(!written && written.error().message.find("ulimit -f") != std::string::npos ? 7 : 8);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status)) << "signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 7);
  EXPECT_EQ(*read_file(path("a.json")), "old");
  EXPECT_EQ(folder_.entries(), 1U) << "a temporary file stayed behind";
}

class CannotSetModes : public Place, public testing::WithParamInterface<int> {};

TEST_P(CannotSetModes, IsNoReasonNotToWrite) {
  ASSERT_TRUE(write_file(path("a.json"), "old").has_value());
  fchmod_error = GetParam();
  const auto written = write_file(path("a.json"), "content");
  ASSERT_TRUE(written.has_value()) << written.error().message;
  EXPECT_EQ(*read_file(path("a.json")), "content");
}

INSTANTIATE_TEST_SUITE_P(Errors, CannotSetModes, testing::Values(ENOSYS, ENOTSUP, EPERM));

class CannotTellRights : public Place, public testing::WithParamInterface<int> {};

// As in a container whose filter of system calls is older than the C library.
TEST_P(CannotTellRights, IsNoReasonNotToWrite) {
  faccessat_error = GetParam();
  for (const char* content : {"new", "again"}) {
    EXPECT_TRUE(check_writable(path("a.json")).has_value());
    const auto written = write_file(path("a.json"), content);
    ASSERT_TRUE(written.has_value()) << written.error().message;
    EXPECT_EQ(*read_file(path("a.json")), content);
  }
}

INSTANTIATE_TEST_SUITE_P(Errors, CannotTellRights, testing::Values(EPERM, ENOSYS, EINVAL));

// ---- Names --------------------------------------------------------------------------------------

TEST_F(Place, ANameMayBeAsLongAsTheSystemTakes) {
  for (const std::size_t length : {240U, 250U, 255U}) {
    const std::string file = path(std::string(length, 'a'));
    for (const std::string content : {"new", "again"}) {
      const auto written = write_file(file, content);
      ASSERT_TRUE(written.has_value()) << length << ": " << written.error().message;
      EXPECT_EQ(*read_file(file), content);
    }
  }
  EXPECT_EQ(folder_.entries(), 3U) << "a temporary file stayed behind";
  const auto longer = write_file(path(std::string(256, 'a')), "x");
  ASSERT_FALSE(longer.has_value());
  EXPECT_NE(longer.error().message.find("Choose a shorter name"), std::string::npos);
}

// ---- Words --------------------------------------------------------------------------------------

struct Advice {
  int error;
  const char* words;
};

class Refusal : public Place, public testing::WithParamInterface<Advice> {};

TEST_P(Refusal, SaysWhatToDo) {
  fsync_error = GetParam().error;
  const auto written = write_file(path("a.json"), "x");
  ASSERT_FALSE(written.has_value());
  EXPECT_NE(written.error().message.find(GetParam().words), std::string::npos)
      << written.error().message;
  EXPECT_EQ(written.error().message.find("in a folder that exists"), std::string::npos);
  EXPECT_EQ(folder_.entries(), 0U) << "a temporary file stayed behind";
}

INSTANTIATE_TEST_SUITE_P(Errors, Refusal,
                         testing::Values(Advice{ENOSPC, "Make room on the disk"},
                                         Advice{EDQUOT, "Make room on the disk"},
                                         Advice{EMFILE, "ulimit -n"}, Advice{EFBIG, "ulimit -f"},
                                         Advice{EROFS, "Nothing can be changed there"},
                                         Advice{EIO, "The disk or the network fails"}));

TEST_F(Place, AFolderThatIsNotThereIsSaid) {
  const auto written = write_file(path("none/a.json"), "x");
  ASSERT_FALSE(written.has_value());
  EXPECT_NE(written.error().message.find("Choose a place in a folder that exists"),
            std::string::npos);
}

}  // namespace
}  // namespace calvin
