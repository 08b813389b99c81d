// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What file.cpp and append_file.cpp have in common: reading, and words for what the system refuses.
// Private to core/.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "calvin/core/descriptor.hpp"
#include "calvin/core/result.hpp"

namespace calvin {

// For `error` of errno: "Cannot read 'camera.json': Permission denied." `verb` is what was tried.
[[nodiscard]] tl::unexpected<Error> refused(std::string_view verb, const std::string& path,
                                            int error);

// Likewise of a file that cannot be written, with what to do. kIo.
[[nodiscard]] tl::unexpected<Error> not_written(const std::string& path, int error);

// From where the file is read now to its end; kIo for more than `max_bytes`. `path` is for the
// error.
[[nodiscard]] Result<std::string> read_all(const Descriptor& file, const std::string& path,
                                           std::size_t max_bytes);

}  // namespace calvin
