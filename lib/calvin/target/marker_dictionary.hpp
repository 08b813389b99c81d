// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// MarkerDictionary: the codes of square markers, by the names that OpenCV gave them. The tables are
// written when the library is built, from those of OpenCV's aruco module. Internal.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace calvin {

// A marker has a dark rim of one cell around side x side cells.
struct MarkerDictionary {
  std::string_view name;                 // "DICT_6X6_250"
  int side = 0;                          // cells along one side, without the rim
  std::span<const std::uint64_t> codes;  // by id

  // The cell in a column and row of a marker, from its upper left, is light. Rows follow each other
  // from the highest of side x side bits on.
  [[nodiscard]] bool is_light(int id, int col, int row) const {
    const int bit = side * side - 1 - (row * side + col);
    return (codes[static_cast<std::size_t>(id)] >> bit & 1) != 0;
  }
};

// Null for a name that this build does not know.
[[nodiscard]] const MarkerDictionary* find_dictionary(std::string_view name) noexcept;

// What AprilTag calls one of its families, "tag25h9" for "DICT_APRILTAG_25h9"; the name of any
// other dictionary.
[[nodiscard]] std::string family_name(std::string_view dictionary);
// The inverse, which takes "25h9" and "t25h9", too.
[[nodiscard]] const MarkerDictionary* find_family(std::string_view name) noexcept;

// All that this build knows; none where it was made without OpenCV.
[[nodiscard]] std::span<const MarkerDictionary> marker_dictionaries() noexcept;

}  // namespace calvin
