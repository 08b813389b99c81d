// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What file.cpp does with a file that is open. For core/, and device/ closes by it.
#pragma once

#include <sys/types.h>

#include <csignal>
#include <cstddef>
#include <string_view>

namespace calvin {

// Closes the file at its end. What answers false leaves the reason in errno.
class Descriptor {
 public:
  explicit Descriptor(int fd) noexcept : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor();
  [[nodiscard]] int get() const noexcept { return fd_; }
  [[nodiscard]] explicit operator bool() const noexcept { return fd_ >= 0; }

  // All of it, or false. A pipe that is full is given time for its reader.
  [[nodiscard]] bool write(std::string_view bytes) const noexcept;
  [[nodiscard]] bool write_at(std::string_view bytes, std::size_t offset) const noexcept;
  [[nodiscard]] bool cut(std::size_t size) const noexcept;
  // True too where the file system has no such thing, as some on networks and in user space.
  [[nodiscard]] bool sync() const noexcept;
  [[nodiscard]] bool set_mode(mode_t mode) const noexcept;
  // Whether the file is that owner's and group's now.
  [[nodiscard]] bool set_owner(uid_t owner, gid_t group) const noexcept;
  // Some file systems report a full disk only here.
  [[nodiscard]] bool close() noexcept;

 private:
  int fd_;
};

// While it lives, neither a reader that is gone nor the limit of a file's size ends the program:
// writing fails with EPIPE or EFBIG instead.
class WriteSignalsBlocked {
 public:
  WriteSignalsBlocked() noexcept;
  WriteSignalsBlocked(const WriteSignalsBlocked&) = delete;
  WriteSignalsBlocked& operator=(const WriteSignalsBlocked&) = delete;
  ~WriteSignalsBlocked();

 private:
  sigset_t ours_{};  // those that did not wait for the thread before
  sigset_t before_{};
};

}  // namespace calvin
