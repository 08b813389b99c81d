// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The file of a zoom table (JSON). docs/formats.md.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "calvin/camera/zoom_table.hpp"
#include "calvin/core/result.hpp"

namespace calvin {

// As of a rig: each setting may hold its views.
inline constexpr std::size_t kMaxZoomBytes = std::size_t{64} << 20;

// What make_zoom_table() takes: the settings of the file are checked and put in order by it.
// kMalformed for broken content and for settings that are no table, kUnsupported for what a newer
// version has written; the message names `name` and says what is wrong.
[[nodiscard]] Result<ZoomTable> parse_zoom_table(std::string_view content,
                                                 std::string_view name = "");

// Whether the content says that it is a zoom table and no single camera, sound or not.
[[nodiscard]] bool is_zoom_table(std::string_view content) noexcept;

// parse_zoom_table() of a file; errors as of read_calibration().
[[nodiscard]] Result<ZoomTable> read_zoom_table(const std::filesystem::path& path);

// The inverse of parse_zoom_table(): numbers read back as the same.
[[nodiscard]] Result<std::string> print_zoom_table(const ZoomTable& table);

// The file is written whole, as write_calibration() does.
[[nodiscard]] Status write_zoom_table(const std::filesystem::path& path, const ZoomTable& table);

}  // namespace calvin
