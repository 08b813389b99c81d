// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Appends to a file that nobody else appends to.

#include "calvin/core/append_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include <fmt/format.h>

#include "calvin/core/file_errors.hpp"

namespace calvin {

namespace {

// False where somebody else has it. A file system without locks lets everybody in.
bool lock(const Descriptor& file) noexcept {
  return ::flock(file.get(), LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
}

}  // namespace

Result<AppendFile> AppendFile::open(const std::string& path) {
  // O_NONBLOCK: opening a pipe must not wait for its reader.
  constexpr int kHow = O_RDWR | O_APPEND | O_CREAT | O_CLOEXEC | O_NONBLOCK;
  auto file = std::make_unique<Descriptor>(::open(path.c_str(), kHow, 0666));
  struct stat info {};
  if (!*file || ::fstat(file->get(), &info) != 0) return not_written(path, errno);
  if (!S_ISREG(info.st_mode)) {
    return make_error(
        ErrorCode::kIo,
        fmt::format("Cannot append to '{}': it is not a regular file. Choose the name "
                    "of a file on a disk.",
                    path));
  }
  if (!lock(*file)) {
    return make_error(ErrorCode::kIo,
                      fmt::format("Cannot append to '{}': another one is doing so. Give each of "
                                  "them a file of its own, or end the other one first.",
                                  path));
  }
  return AppendFile(path, std::move(file));
}

Result<std::string> AppendFile::read(std::size_t max_bytes) const {
  if (::lseek(file_->get(), 0, SEEK_SET) < 0) return refused("read", path_, errno);
  return read_all(*file_, path_, max_bytes);
}

Status AppendFile::cut(std::size_t size) const {
  if (!file_->cut(size)) return not_written(path_, errno);
  return {};
}

Status AppendFile::append(std::string_view bytes) {
  const WriteSignalsBlocked blocked;
  if (torn_at_ && !file_->cut(*torn_at_)) return not_written(path_, errno);
  torn_at_.reset();
  struct stat info {};
  if (::fstat(file_->get(), &info) != 0) return not_written(path_, errno);
  if (info.st_nlink == 0) return not_written(path_, ENOENT);
  if (file_->write(bytes)) return {};
  const int error = errno;
  const auto before = static_cast<std::size_t>(info.st_size);
  if (!file_->cut(before)) torn_at_ = before;
  return not_written(path_, error);
}

void AppendFile::unlock() const noexcept { ::flock(file_->get(), LOCK_UN); }

Status AppendFile::sync() const {
  if (!file_->sync()) return not_written(path_, errno);
  return {};
}

}  // namespace calvin
