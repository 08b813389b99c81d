// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The mark in the pictures that this program makes, by which they are told from those of the user:
// they may lie in the folder of pictures of the next run.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <ios>
#include <string>
#include <string_view>

namespace calibrate_images {

// The signature of a PNG file and its IHDR chunk, which comes first and always has this length.
inline constexpr std::size_t kEndOfHeader = 8 + 4 + 4 + 13 + 4;

// A whole tEXt chunk: length, type, keyword "Software", text and their CRC (PNG specification,
// 5.3 and 11.3.4.3).
inline constexpr std::string_view kOwnMark(
    "\0\0\0\x20"
    "tEXtSoftware\0calvin-calibrate-images"
    "\xb1\xdc\x99\xf2",
    44);

// Puts the mark behind the header of a PNG file.
inline void mark_as_own(std::string& png) {
  if (png.size() >= kEndOfHeader) png.insert(kEndOfHeader, kOwnMark);
}

inline bool is_own(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string head(kEndOfHeader + kOwnMark.size(), '\0');
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  return stream && head.substr(kEndOfHeader) == kOwnMark;
}

}  // namespace calibrate_images
