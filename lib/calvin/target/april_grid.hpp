// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// AprilGrid: AprilTags in rows with small dark squares between their corners, as Kalibr prints
// them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "calvin/core/observation.hpp"
#include "calvin/core/result.hpp"
#include "calvin/target/grid.hpp"
#include "calvin/target/marker_dictionary.hpp"

namespace calvin {

// Control points are the corners of all tags, numbered in rows from the upper left as those of all
// boards are. Kalibr counts the same rows from the lowest one on. What the functions answer is said
// of Board, in target/board.hpp.
struct AprilGrid {
  static constexpr std::string_view kUsualFamily = "DICT_APRILTAG_36h11";
  static constexpr int kUsualBorder = 2;  // cells, of the boards that Kalibr prints

  int cols = 0;        // tags along x
  int rows = 0;        // along y
  double tag = 0;      // m, side of a tag with its border: Kalibr's tagSize
  double spacing = 0;  // of a tag's side, from one to the next: Kalibr's tagSpacing
  const MarkerDictionary* dictionary = nullptr;
  int border = kUsualBorder;  // cells, of the dark border around the bits of a tag
  int first = 0;              // the id of the tag at the lower left

  // The id of a tag by its place from the upper left. Tags are numbered in rows from the lower
  // left.
  [[nodiscard]] int tag_in(int col, int row) const noexcept {
    return first + Grid{cols, rows, tag}.id({col, rows - 1 - row});
  }
  // A bit of a tag, from its upper left. Kalibr has tags the other way up than OpenCV.
  [[nodiscard]] bool is_light(int id, int col, int row) const {
    return dictionary->is_light(id, dictionary->side - 1 - col, dictionary->side - 1 - row);
  }

  [[nodiscard]] std::string text() const;
  [[nodiscard]] Status check() const;
  [[nodiscard]] Grid grid() const noexcept { return {2 * cols, 2 * rows, tag, spacing * tag}; }
  // The dark squares outside of the outermost tags' corners belong to it.
  [[nodiscard]] BoardArea outline() const noexcept { return grid().outline(); }
  [[nodiscard]] std::vector<Relabelling> symmetries() const { return {}; }
  [[nodiscard]] bool looks_like(const AprilGrid& other) const noexcept;

  // The gaps keep their share of a tag.
  [[nodiscard]] AprilGrid with_cells_of(double side) const noexcept;

  friend bool operator==(const AprilGrid&, const AprilGrid&) = default;
};

}  // namespace calvin
