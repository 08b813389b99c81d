// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Inserts the chunk pHYs behind a PNG file's header.

#include "calvin/draw/png.hpp"

#include <cmath>
#include <cstdint>
#include <string_view>

namespace calvin {

namespace {

// The signature and the IHDR chunk, which always comes first and always has this length.
constexpr std::size_t kEndOfHeader = 8 + 4 + 4 + 13 + 4;

// ISO 3309, as in the PNG specification, annex D.
std::uint32_t crc32(std::string_view bytes) noexcept {
  std::uint32_t crc = 0xffffffffu;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0xedb88320u : 0u);
  }
  return ~crc;
}

std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>((value >> shift) & 0xffu);
  return bytes;
}

}  // namespace

void set_png_resolution(std::string& png, double pixels_per_metre) {
  if (png.size() < kEndOfHeader) return;
  const std::string density = big_endian(static_cast<std::uint32_t>(std::lround(pixels_per_metre)));
  const char metre = 1;
  const std::string body = "pHYs" + density + density + metre;
  png.insert(kEndOfHeader, big_endian(9) + body + big_endian(crc32(body)));
}

}  // namespace calvin
