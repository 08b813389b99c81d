// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// MarkerDictionary: the codes of square markers, by the names that OpenCV and AprilTag gave them.
// The tables are written when the library is built, from those of OpenCV's aruco module and of
// libapriltag. Internal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "calvin/target/grid.hpp"

namespace calvin {

// A marker has a rim of one cell around side x side cells, dark on light paper. The families of
// AprilTag 3 have bits outside of the rim as well: around the rim, which is light, there is a dark
// ring of one cell, and bits lie around that. Their codes are kept the other way up than AprilTag
// prints them, as OpenCV has all families of AprilTags.
struct MarkerDictionary {
  std::string_view name;                 // "DICT_6X6_250", "tagStandard41h12"
  int side = 0;                          // cells along one side, without the rim
  std::span<const std::uint64_t> codes;  // by id
  int distance = 0;  // bits of which two markers differ at least; 0 where nobody said it

  // Of the families of AprilTag 3 alone.
  int outside = 0;                    // cells around the rim that belong to a marker
  std::span<const GridPlace> places;  // of the bits, from the highest one on; else in rows
  // What the border of a tag has and what is around it are exchanged.
  [[nodiscard]] bool has_light_rim() const noexcept { return outside > 0; }

  [[nodiscard]] int bit_count() const noexcept {
    return places.empty() ? side * side : static_cast<int>(places.size());
  }
  // Of the bits from the highest one on, where one lies: in a column and row from the upper left
  // within the rim.
  [[nodiscard]] GridPlace place_of(int bit) const {
    if (places.empty()) return {bit % side, bit / side};
    return places[static_cast<std::size_t>(bit)];
  }
  // The inverse; -1 for a cell that is no bit.
  [[nodiscard]] int bit_at(int col, int row) const noexcept {
    if (places.empty()) {
      return col < 0 || row < 0 || col >= side || row >= side ? -1 : row * side + col;
    }
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (places[i] == GridPlace{col, row}) return static_cast<int>(i);
    }
    return -1;
  }

  // The bit in a column and row of a marker is light.
  [[nodiscard]] bool is_light(int id, int col, int row) const {
    const int bit = bit_count() - 1 - bit_at(col, row);
    return (codes[static_cast<std::size_t>(id)] >> bit & 1) != 0;
  }
};

// Null for a name that this build does not know.
[[nodiscard]] const MarkerDictionary* find_dictionary(std::string_view name) noexcept;

// What AprilTag calls one of its families, "tag25h9" for "DICT_APRILTAG_25h9"; the name of any
// other dictionary.
[[nodiscard]] std::string family_name(std::string_view dictionary);
// The inverse, which takes "25h9", "t25h9" and "Standard41h12", too.
[[nodiscard]] const MarkerDictionary* find_family(std::string_view name) noexcept;

// Whether this build knows those of OpenCV, and the families of AprilTag 3.
[[nodiscard]] bool has_opencv_dictionaries() noexcept;
[[nodiscard]] bool has_april_tag_3() noexcept;

// All that this build knows; none where it was made without OpenCV and libapriltag.
[[nodiscard]] std::span<const MarkerDictionary> marker_dictionaries() noexcept;

}  // namespace calvin
