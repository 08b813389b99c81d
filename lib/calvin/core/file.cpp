// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads and writes whole files: through links and mount points, with a temporary file that is
// renamed, and with an error message that says what a user can do.

#include "calvin/core/file.hpp"

#include <fcntl.h>
#include <linux/magic.h>
#include <sys/stat.h>
#include <sys/statfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "calvin/core/descriptor.hpp"
#include "calvin/core/file_errors.hpp"

namespace calvin {

namespace {

namespace fs = std::filesystem;

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

constexpr int kMostLinks = 40;  // as the system

// Puts what a symbolic link points to in its place; false where it is none.
bool follow_link(fs::path& target) {
  std::error_code error;
  if (!fs::is_symlink(target, error)) return false;
  const fs::path next = fs::read_symlink(target, error);
  if (error) return false;
  target = next.is_absolute() ? next : target.parent_path() / next;
  return true;
}

// Follows symbolic links, so that the rename replaces the file and not the link. Of links that go
// in a circle one is left over, and stat() refuses it.
fs::path resolved(const std::string& path) {
  fs::path target(path);
  for (int i = 0; i < kMostLinks; ++i) {
    if (!follow_link(target)) break;
  }
  return target;
}

// Whether the name is one that /proc gives to what a program has open, as /dev/stdout and
// /dev/fd/3.
bool is_open_file(const std::string& path) {
  fs::path target(path);
  std::error_code error;
  for (int i = 0; i < kMostLinks; ++i) {
    struct statfs system {};
    const bool of_proc =
        ::statfs(folder_of(target).c_str(), &system) == 0 && system.f_type == PROC_SUPER_MAGIC;
    if (of_proc && fs::is_symlink(target, error)) return true;
    if (!follow_link(target)) return false;
  }
  return false;
}

// Absent where one of them is not there.
std::optional<bool> are_one(const fs::path& a, const fs::path& b) {
  struct stat info_a {};
  struct stat info_b {};
  if (::stat(a.c_str(), &info_a) != 0 || ::stat(b.c_str(), &info_b) != 0) return std::nullopt;
  return info_a.st_dev == info_b.st_dev && info_a.st_ino == info_b.st_ino;
}

// Why it may not be written, as far as the system tells without a try; 0 where it cannot tell, as
// under a filter of system calls that does not know this one.
int refusal_foretold(const fs::path& path, int more = 0) noexcept {
  if (::faccessat(AT_FDCWD, path.c_str(), W_OK | more, AT_EACCESS) == 0) return 0;
  return errno == EACCES || errno == EROFS ? errno : 0;
}

// Whoever may not write a file does not replace it either, though its folder would let him.
int refusal(const std::string& path) noexcept {
  const Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  return file ? 0 : errno;
}

Status write_directly(const std::string& path, std::string_view bytes) {
  // O_NONBLOCK: opening a pipe must not wait for its reader.
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK));
  if (!file || !file.write(bytes) || !file.close()) return not_written(path, errno);
  return {};
}

// What is longer than before goes first: a full disk then refuses it before anything is lost.
bool overwrite(const Descriptor& file, std::string_view bytes, std::size_t old_size) noexcept {
  const std::size_t head = std::min(bytes.size(), old_size);
  return file.write_at(bytes.substr(head), head) && file.write_at(bytes.substr(0, head), 0) &&
         file.cut(bytes.size()) && file.sync();
}

// For a file that no other may take the place of. Where writing fails the old content comes back.
Status write_in_place(const fs::path& target, std::string_view bytes) {
  Descriptor file(::open(target.c_str(), O_WRONLY | O_CLOEXEC));
  if (!file) return not_written(target.string(), errno);
  const auto old = read_file(target.string());
  struct stat info {};
  if (::fstat(file.get(), &info) != 0) return not_written(target.string(), errno);
  const auto old_size = static_cast<std::size_t>(info.st_size);
  if (!overwrite(file, bytes, old_size)) {
    const int error = errno;
    if (file.cut(old_size) && old && file.write_at(*old, 0)) ::fsync(file.get());
    return not_written(target.string(), error);
  }
  if (!file.close()) return not_written(target.string(), errno);
  return {};
}

// A new file beside the target, with a name of its own: a process with the same number may have
// left one behind, as the first process of every container has. Where the target's name leaves no
// room for more, another one does.
Descriptor create_temporary(const fs::path& target, std::string& name) {
  static std::atomic<unsigned> counter{0};
  constexpr int kMostLeftBehind = 1000;
  const std::string other = (folder_of(target) / "calvin").string();
  std::string stem = target.string();
  int fd = -1;
  for (int i = 0; i < kMostLeftBehind; ++i) {
    name = fmt::format("{}.{}-{}.tmp", stem, ::getpid(), counter.fetch_add(1));
    fd = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0 && errno == ENAMETOOLONG && std::exchange(stem, other) != other) continue;
    if (fd >= 0 || errno != EEXIST) break;
  }
  return Descriptor(fd);
}

// Owner first: it takes bits of the mode away. A file that cannot be given away is not taken
// either.
bool take_over(const Descriptor& file, const struct stat& old) noexcept {
  if (!file.set_owner(old.st_uid, old.st_gid)) {
    errno = EPERM;  // in whatever way the system says it
    return false;
  }
  return file.set_mode(old.st_mode & 07777);
}

// The reason where it fails, else 0. `old` is the file in whose place the new one goes, if any.
int write_and_rename(const fs::path& target, std::string_view bytes, const struct stat* old) {
  std::string temporary;
  Descriptor file = create_temporary(target, temporary);
  if (!file) return errno;
  const bool written = (old == nullptr || take_over(file, *old)) && file.write(bytes) &&
                       file.sync() && file.close() &&
                       ::rename(temporary.c_str(), target.c_str()) == 0;
  if (!written) {
    const int error = errno;
    ::unlink(temporary.c_str());
    return error;
  }
  // Makes the rename itself last; a folder that cannot be opened or synced still holds the file.
  const Descriptor folder(::open(folder_of(target).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder) ::fsync(folder.get());
  return 0;
}

// The file itself may be writable nonetheless: a mount point of its own, another's, or in a folder
// that takes no new files.
bool cannot_be_replaced(int error) noexcept {
  return error == EBUSY || error == EXDEV || error == EACCES || error == EPERM || error == EROFS;
}

}  // namespace

Result<std::string> read_file(const std::string& path, std::size_t max_bytes) {
  // O_NONBLOCK: opening a pipe must not wait for its writer.
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!file) return refused("read", path, errno);
  struct stat info {};
  if (::fstat(file.get(), &info) != 0) return refused("read", path, errno);
  if (S_ISDIR(info.st_mode)) return refused("read", path, EISDIR);
  if (!S_ISREG(info.st_mode)) {
    return make_error(
        ErrorCode::kIo,
        fmt::format("Cannot read '{}': it is not a regular file. Save what is to be read to a "
                    "file first.",
                    path));
  }
  return read_all(file, path, max_bytes);
}

Status write_file(const std::string& path, std::string_view bytes) {
  const WriteSignalsBlocked blocked;
  if (path.empty()) return not_written(path, ENOENT);
  struct stat info {};
  const bool exists = ::stat(path.c_str(), &info) == 0;
  if (!exists && errno != ENOENT) return not_written(path, errno);
  if (exists && S_ISDIR(info.st_mode)) return not_written(path, EISDIR);
  if (exists && !S_ISREG(info.st_mode)) return write_directly(path, bytes);
  if (const int error = exists ? refusal(path) : 0; error != 0) return not_written(path, error);
  const fs::path target = resolved(path);
  // Whoever has opened the file wants it, not another one in its place; it may have no name any
  // more.
  if (exists && is_open_file(path)) return write_in_place(path, bytes);
  const int error = write_and_rename(target, bytes, exists ? &info : nullptr);
  if (error == 0) return {};
  if (exists && cannot_be_replaced(error)) return write_in_place(target, bytes);
  return not_written(target.string(), error);
}

bool is_stream(const std::string& path) {
  struct stat info {};
  return ::stat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode);
}

Status check_writable(const std::string& path) {
  if (path.empty()) return not_written(path, ENOENT);
  struct stat info {};
  if (::stat(path.c_str(), &info) == 0) {
    if (S_ISDIR(info.st_mode)) return not_written(path, EISDIR);
    if (const int error = refusal_foretold(path); error != 0) return not_written(path, error);
    return {};
  }
  if (errno != ENOENT) return not_written(path, errno);
  const fs::path folder = folder_of(resolved(path));
  if (::stat(folder.c_str(), &info) != 0) return not_written(path, errno);
  if (!S_ISDIR(info.st_mode)) return not_written(path, ENOTDIR);
  if (const int error = refusal_foretold(folder, X_OK); error != 0) return not_written(path, error);
  return {};
}

bool is_same_file(const std::string& a, const std::string& b) {
  if (const auto one = are_one(a, b)) return *one;
  const fs::path first = resolved(a);
  const fs::path second = resolved(b);
  // Of a file that is not there yet the folder and the name tell.
  return first.filename() == second.filename() &&
         are_one(folder_of(first), folder_of(second))
             .value_or(first.lexically_normal() == second.lexically_normal());
}

}  // namespace calvin
