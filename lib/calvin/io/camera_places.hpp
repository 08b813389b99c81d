// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where cameras stand by other means: a text file with a line for each. docs/formats.md.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "calvin/core/result.hpp"
#include "calvin/core/rig.hpp"

namespace calvin {

// A line is `name x y z`, m, between blanks or tabs; `#` begins a comment. kMalformed where a line
// is something else or a name is there twice; the message names `name` and the line.
[[nodiscard]] Result<std::vector<CameraPlace>> parse_camera_places(std::string_view content,
                                                                   std::string_view name = "");

// parse_camera_places() of a file, or where the cameras of a rig's file or folder stand; errors as
// of read_file() and read_rig().
[[nodiscard]] Result<std::vector<CameraPlace>> read_camera_places(
    const std::filesystem::path& path);

}  // namespace calvin
