// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/core/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>

namespace calvin {

namespace {

namespace fs = std::filesystem;

class Descriptor {
 public:
  explicit Descriptor(int fd) noexcept : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  [[nodiscard]] int get() const noexcept { return fd_; }
  [[nodiscard]] explicit operator bool() const noexcept { return fd_ >= 0; }

  // Some file systems report a full disk only here.
  [[nodiscard]] bool close() noexcept {
    const int fd = fd_;
    fd_ = -1;
    return ::close(fd) == 0;
  }

 private:
  int fd_;
};

tl::unexpected<Error> refused(std::string_view verb, const std::string& path, int error) {
  // The reason must survive whoever cuts a message short.
  constexpr std::size_t kLongest = 200;
  const ErrorCode code = error == ENOENT ? ErrorCode::kNotFound : ErrorCode::kIo;
  return make_error(code, fmt::format("Cannot {} '{}{}': {}.", verb, path.substr(0, kLongest),
                                      path.size() > kLongest ? "..." : "",
                                      std::generic_category().message(error)));
}

tl::unexpected<Error> not_written(const std::string& path, int error) {
  auto result = refused("write", path, error);
  result.value().code = ErrorCode::kIo;
  return result;
}

bool write_all(int fd, std::string_view bytes) noexcept {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

// Follows symbolic links so that the rename replaces the file and not the link.
fs::path resolved(const std::string& path) {
  std::error_code error;
  fs::path target(path);
  for (int i = 0; i < 40 && fs::is_symlink(target, error); ++i) {
    const fs::path next = fs::read_symlink(target, error);
    if (error) break;
    target = next.is_absolute() ? next : target.parent_path() / next;
  }
  return target;
}

Status write_directly(const std::string& path, std::string_view bytes) {
  // O_NONBLOCK: opening a pipe must not wait for its reader.
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK));
  if (!file || !write_all(file.get(), bytes) || !file.close()) return not_written(path, errno);
  return {};
}

// A name of its own for every call, so that two writers never share a temporary file.
std::string temporary_name(const fs::path& target) {
  static std::atomic<unsigned> counter{0};
  return fmt::format("{}.{}-{}.tmp", target.string(), ::getpid(), counter.fetch_add(1));
}

Status write_and_rename(const fs::path& target, std::string_view bytes, const mode_t* mode) {
  const std::string temporary = temporary_name(target);
  Descriptor file(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (!file) return not_written(target.string(), errno);
  const bool written = (mode == nullptr || ::fchmod(file.get(), *mode) == 0) &&
                       write_all(file.get(), bytes) && ::fsync(file.get()) == 0 && file.close() &&
                       ::rename(temporary.c_str(), target.c_str()) == 0;
  if (!written) {
    const int error = errno;
    ::unlink(temporary.c_str());
    return not_written(target.string(), error);
  }
  // Makes the rename itself last; a folder that cannot be opened or synced still holds the file.
  const Descriptor folder(::open(folder_of(target).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder) ::fsync(folder.get());
  return {};
}

Result<std::string> read_all(int fd, const std::string& path, std::size_t max_bytes) {
  std::string bytes;
  std::array<char, 65536> block;
  for (;;) {
    const ssize_t n = ::read(fd, block.data(), block.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return refused("read", path, errno);
    if (n == 0) return bytes;
    bytes.append(block.data(), static_cast<std::size_t>(n));
    if (bytes.size() > max_bytes) {
      return make_error(ErrorCode::kIo,
                        fmt::format("'{}' is larger than the {} bytes that such a file "
                                    "may have: is it the right file?",
                                    path, max_bytes));
    }
  }
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
    return make_error(ErrorCode::kIo,
                      fmt::format("Cannot read '{}': it is not a regular file.", path));
  }
  return read_all(file.get(), path, max_bytes);
}

Status write_file(const std::string& path, std::string_view bytes) {
  if (path.empty()) return not_written(path, ENOENT);
  const fs::path target = resolved(path);
  struct stat info {};
  if (::stat(target.c_str(), &info) != 0) return write_and_rename(target, bytes, nullptr);
  if (S_ISDIR(info.st_mode)) return not_written(path, EISDIR);
  if (!S_ISREG(info.st_mode)) return write_directly(path, bytes);
  if (::access(target.c_str(), W_OK) != 0) return not_written(path, errno);
  const mode_t mode = info.st_mode & 07777;
  return write_and_rename(target, bytes, &mode);
}

Status check_writable(const std::string& path) {
  if (path.empty()) return not_written(path, ENOENT);
  const fs::path target = resolved(path);
  struct stat info {};
  const bool exists = ::stat(target.c_str(), &info) == 0;
  if (exists && S_ISDIR(info.st_mode)) return not_written(path, EISDIR);
  if (exists && ::access(target.c_str(), W_OK) != 0) return not_written(path, errno);
  if (exists && !S_ISREG(info.st_mode)) return {};
  const fs::path folder = folder_of(target);
  if (::stat(folder.c_str(), &info) != 0) return not_written(path, errno);
  if (!S_ISDIR(info.st_mode)) return not_written(path, ENOTDIR);
  if (::access(folder.c_str(), W_OK | X_OK) != 0) return not_written(path, errno);
  return {};
}

}  // namespace calvin
