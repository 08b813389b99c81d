// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// TagGrid: square tags in columns and rows with nothing between them, such as the GridBoard of
// OpenCV's aruco module. An AprilGrid has small dark squares between its tags.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calvin/core/observation.hpp"
#include "calvin/core/result.hpp"
#include "calvin/target/grid.hpp"
#include "calvin/target/marker_dictionary.hpp"

namespace calvin {

// Control points are the corners of all tags, numbered in rows from the upper left as those of all
// boards are. Tags are numbered in rows from the upper left, too. What the functions answer is said
// of Board, in target/board.hpp.
struct TagGrid {
  static constexpr int kUsualBorder = 1;  // cells

  int cols = 0;    // tags along x
  int rows = 0;    // along y
  double tag = 0;  // m, side of a tag with its border
  double gap = 0;  // m, from the border of one tag to that of the next
  const MarkerDictionary* dictionary = nullptr;
  bool april = false;         // tags stand as AprilTag prints them, the other way up than OpenCV's
  int first = 0;              // the id of the tag at the upper left
  int border = kUsualBorder;  // cells, of the dark border around the bits of a tag
  bool inverted = false;      // all colours are exchanged, on a dark sheet

  // The id of a tag by its place from the upper left.
  [[nodiscard]] int tag_in(int col, int row) const noexcept {
    return first + Grid{cols, rows, tag}.id({col, row});
  }
  // The inverse; absent for a tag that is not on the board.
  [[nodiscard]] std::optional<GridPlace> place_of(int id) const noexcept;
  // A bit of a tag, from the upper left within its border, before colours are exchanged.
  [[nodiscard]] bool is_light(int id, int col, int row) const {
    const int last = dictionary->side - 1;
    return april ? dictionary->is_light(id, last - col, last - row)
                 : dictionary->is_light(id, col, row);
  }
  // Along a side of a tag, with its border; outside of it a tag may have further ones.
  [[nodiscard]] int cells() const noexcept { return dictionary->side + 2 * border; }
  // What is printed in a cell of a tag, in columns and rows from the upper left corner of its
  // border, and around it; before colours are exchanged.
  [[nodiscard]] bool is_dark(int id, int col, int row) const;

  // Whether nothing lies between the cells outside of borders; texts have lengths to a nanometre.
  [[nodiscard]] bool are_touching() const noexcept {
    constexpr double kRounded = 1e-6;  // of a tag
    return gap < (least_gap_share() + kRounded) * tag;
  }
  // Of a tag's side, so much gap that the cells outside of borders do not meet.
  [[nodiscard]] double least_gap_share() const noexcept {
    return 2.0 * dictionary->outside / cells();
  }

  [[nodiscard]] std::string text() const;
  [[nodiscard]] Status check() const;
  [[nodiscard]] Grid grid() const noexcept { return {2 * cols, 2 * rows, tag, gap}; }
  // As much as lies between tags belongs to the board around them, a cell at least.
  [[nodiscard]] BoardArea outline() const noexcept;
  [[nodiscard]] std::vector<Relabelling> symmetries() const { return {}; }
  [[nodiscard]] bool looks_like(const TagGrid& other) const noexcept;

  // The gaps keep their share of a tag.
  [[nodiscard]] TagGrid with_cells_of(double side) const noexcept;

  friend bool operator==(const TagGrid&, const TagGrid&) = default;
};

}  // namespace calvin
