// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whole files: read with a bound on the size, written so that no reader ever sees half of one.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "calvin/core/result.hpp"

namespace calvin {

inline constexpr std::size_t kMaxFileBytes = std::size_t{64} << 20;

// The bytes of a regular file. kNotFound where there is none; kIo for a folder, a device, a file
// that may not be read or one of more than `max_bytes`.
[[nodiscard]] Result<std::string> read_file(const std::string& path,
                                            std::size_t max_bytes = kMaxFileBytes);

// Replaces the content of `path`, or creates it: a temporary file beside it is written, fsynced and
// renamed, so that a crash leaves the old content or the new. A file that no other can take the
// place of, as a mount point, one in a folder that takes no new files or one of an owner to whom no
// other can be given, is overwritten and fsynced instead; where that fails its old content is put
// back. A symbolic link stays one and what it points to is replaced; owner, group and mode of an
// existing file are kept; a device or a pipe, /dev/stdout too, is written directly. kIo where the
// system refuses, with what to do. The inverse of read_file().
[[nodiscard]] Status write_file(const std::string& path, std::string_view bytes);

// Whether it is there and what is written goes behind what was written before, not in its place: a
// pipe, a terminal or a device. /dev/stdout is one unless it leads to a file.
[[nodiscard]] bool is_stream(const std::string& path);

// An error that write_file() would give at once (no such folder, no permission), without touching
// the file: for a warning before long work.
[[nodiscard]] Status check_writable(const std::string& path);

// Whether both paths lead to one file, be it there already or not: through relative paths, symbolic
// links, hard links and mounts.
[[nodiscard]] bool is_same_file(const std::string& a, const std::string& b);

}  // namespace calvin
