// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Writes to files that are open: all of the bytes, through interruptions and full pipes.

#include "calvin/core/descriptor.hpp"

#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

namespace calvin {

namespace {

// Whether a pipe that is full takes more, before a reader is given up.
bool wait_for_reader(int fd) noexcept {
  constexpr int kPatience = 5000;  // ms
  pollfd pipe = {fd, POLLOUT, 0};
  const int ready = ::poll(&pipe, 1, kPatience);
  if (ready == 0) errno = EAGAIN;
  return ready > 0 || (ready < 0 && errno == EINTR);
}

}  // namespace

Descriptor::~Descriptor() {
  if (fd_ >= 0) ::close(fd_);
}

bool Descriptor::write(std::string_view bytes) const noexcept {
  // Of a regular file poll() says that it takes more even where write() never does.
  constexpr int kMostPutOff = 100;  // without a byte between them
  int put_off = 0;
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd_, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno == EAGAIN && ++put_off < kMostPutOff && wait_for_reader(fd_)) continue;
    if (n <= 0) return false;
    put_off = 0;
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

bool Descriptor::write_at(std::string_view bytes, std::size_t offset) const noexcept {
  return ::lseek(fd_, static_cast<off_t>(offset), SEEK_SET) >= 0 && write(bytes);
}

bool Descriptor::cut(std::size_t size) const noexcept {
  return ::ftruncate(fd_, static_cast<off_t>(size)) == 0;
}

bool Descriptor::sync() const noexcept {
  int result = 0;
  do {
    result = ::fsync(fd_);
  } while (result != 0 && errno == EINTR);
  return result == 0 || errno == EINVAL || errno == ENOSYS || errno == ENOTSUP;
}

bool Descriptor::set_mode(mode_t mode) const noexcept {
  return ::fchmod(fd_, mode) == 0 || errno == ENOSYS || errno == ENOTSUP;
}

bool Descriptor::set_owner(uid_t owner, gid_t group) const noexcept {
  struct stat info {};
  if (::fstat(fd_, &info) != 0) return false;
  return (info.st_uid == owner && info.st_gid == group) || ::fchown(fd_, owner, group) == 0;
}

bool Descriptor::close() noexcept {
  const int fd = fd_;
  fd_ = -1;
  return ::close(fd) == 0;
}

WriteSignalsBlocked::WriteSignalsBlocked() noexcept {
  sigset_t pending;
  sigset_t both;
  sigpending(&pending);
  sigemptyset(&both);
  sigemptyset(&ours_);
  for (const int signal : {SIGPIPE, SIGXFSZ}) {
    sigaddset(&both, signal);
    if (sigismember(&pending, signal) != 1) sigaddset(&ours_, signal);
  }
  pthread_sigmask(SIG_BLOCK, &both, &before_);
}

WriteSignalsBlocked::~WriteSignalsBlocked() {
  const timespec at_once = {};
  while (sigtimedwait(&ours_, nullptr, &at_once) > 0) {
  }
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

}  // namespace calvin
