// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a user can do where the system refuses a file.

#include "calvin/core/file_errors.hpp"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "calvin/core/file.hpp"

namespace calvin {

tl::unexpected<Error> refused(std::string_view verb, const std::string& path, int error) {
  // The reason must survive whoever cuts a message short.
  constexpr std::size_t kLongest = 200;
  const ErrorCode code = error == ENOENT ? ErrorCode::kNotFound : ErrorCode::kIo;
  return make_error(code, fmt::format("Cannot {} '{}{}': {}.", verb, path.substr(0, kLongest),
                                      path.size() > kLongest ? "..." : "",
                                      std::generic_category().message(error)));
}

namespace {

const char* advice(int error, bool stream) noexcept {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return "Make room on the disk, or choose a place on another one.";
    case EFBIG:
      return "Raise the limit of a file's size (ulimit -f), or choose a place on another disk.";
    case EMFILE:
    case ENFILE:
      return "Close files that the program has open, or raise their limit (ulimit -n).";
    case EROFS:
      return "Nothing can be changed there: choose a place on another disk.";
    case EIO:
      return "The disk or the network fails: choose a place on another one.";
    case ENAMETOOLONG:
      return "Choose a shorter name.";
    case EAGAIN:
      if (!stream) return "Try again, or choose a place on another disk.";
      [[fallthrough]];
    case ENXIO:
    case EPIPE:
      return "Start the program that is to read from it, and let it read to the end.";
    default:
      return "Choose a place in a folder that exists and may be written to.";
  }
}

}  // namespace

tl::unexpected<Error> not_written(const std::string& path, int error) {
  auto result = refused("write", path, error);
  result.value().code = ErrorCode::kIo;
  result.value().message += fmt::format(" {}", advice(error, is_stream(path)));
  return result;
}

Result<std::string> read_all(const Descriptor& file, const std::string& path,
                             std::size_t max_bytes) {
  std::string bytes;
  std::array<char, 65536> block;
  for (;;) {
    const ssize_t n = ::read(file.get(), block.data(), block.size());
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

}  // namespace calvin
