// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The file of a hand-eye calibration: JSON, known by its content. docs/formats.md.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "calvin/core/hand_eye.hpp"
#include "calvin/core/result.hpp"

namespace calvin {

// The calibration of the camera makes a Camera. kMalformed for broken content, kUnsupported for
// what a newer version has written; the message names `name` and says what is wrong.
[[nodiscard]] Result<HandEye> parse_hand_eye(std::string_view content, std::string_view name = "");

// parse_hand_eye() of a file; errors as of read_calibration().
[[nodiscard]] Result<HandEye> read_hand_eye(const std::filesystem::path& path);

// The inverse: numbers read back as the same.
[[nodiscard]] Result<std::string> print_hand_eye(const HandEye& hand_eye);

// The file is written whole, as write_calibration() does.
[[nodiscard]] Status write_hand_eye(const std::filesystem::path& path, const HandEye& hand_eye);

}  // namespace calvin
