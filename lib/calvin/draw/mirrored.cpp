// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Turns places and words left to right.

#include "calvin/draw/mirrored.hpp"

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace calvin {

namespace {

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

// Whether the word stands there by itself.
bool is_word(std::string_view text, std::size_t at, std::string_view word) {
  if (text.substr(at, word.size()) != word) return false;
  const std::size_t end = at + word.size();
  return (at == 0 || !is_letter(text[at - 1])) && (end == text.size() || !is_letter(text[end]));
}

std::string with_sides_exchanged(std::string_view text) {
  constexpr std::string_view kLeft = "left";
  constexpr std::string_view kRight = "right";
  std::string turned;
  bool is_name = false;  // between quotes, as of a file
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] == '\'') is_name = !is_name;
    const bool left = !is_name && is_word(text, i, kLeft);
    const bool right = !is_name && is_word(text, i, kRight);
    if (left || right) {
      turned += left ? kRight : kLeft;
      i += left ? kLeft.size() : kRight.size();
    } else {
      turned += text[i++];
    }
  }
  return turned;
}

}  // namespace

Observation mirrored(Observation seen, ImageSize frame) {
  const int width = seen.image_size.width > 0 ? seen.image_size.width : frame.width;
  for (Pixel& at : seen.uv) at.u = width - 1 - at.u;
  return seen;
}

Progress mirrored(Progress progress) {
  for (Pixel& at : progress.ghost) at.u = 1 - at.u;
  for (PlacedPoint& point : progress.points) point.at.u = 1 - point.at.u;
  CoverageMap& map = progress.coverage_map;
  for (int row = 0; row < map.rows(); ++row) {
    const auto first = map.covered.begin() + static_cast<std::ptrdiff_t>(row) * map.columns;
    std::reverse(first, first + map.columns);
  }
  progress.hint = with_sides_exchanged(progress.hint);
  return progress;
}

}  // namespace calvin
