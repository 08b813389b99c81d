// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// TagList: single square tags at known places, on a plane or in space, such as those on walls.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/observation.hpp"
#include "calvin/core/result.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/target/grid.hpp"
#include "calvin/target/tag_grid.hpp"

namespace calvin {

// Tags of one dictionary. Control points are their corners: those of the tag i are 4 i, at its
// upper left, to 4 i + 3, clockwise as it is seen. What the functions answer is said of Board, in
// target/board.hpp.
struct TagList {
  static constexpr std::size_t kMost = 500;

  struct Tag {
    int id = 0;
    double size = 0;                 // m, side of the tag with its border
    std::array<double, 3> middle{};  // m, board frame
    // Degrees, a Rodrigues vector in the board frame: 0 0 0 lies in the plane of the board with its
    // upper side towards -y, 0 0 90 is turned by a quarter, clockwise as it is seen.
    std::array<double, 3> turn{};

    friend bool operator==(const Tag&, const Tag&) = default;
  };

  double size = 0;  // m, of the tags of which the text gives none
  const MarkerDictionary* dictionary = nullptr;
  bool april = false;     // see TagGrid
  int border = 1;         // cells
  bool inverted = false;  // all colours are exchanged, on dark cards
  std::vector<Tag> tags;  // in the order of their ids

  // One of its tags as a grid of its own, with a cell of its sheet around it.
  [[nodiscard]] TagGrid grid_of(const Tag& tag) const;
  // The frame of that grid: its origin is the tag's upper left corner.
  [[nodiscard]] static SE3 board_from_grid(const Tag& tag);
  // The tag of a control point; null where it is of none.
  [[nodiscard]] const Tag* tag_of(int id) const noexcept;
  // Whether all tags lie in the plane z = 0.
  [[nodiscard]] bool is_flat() const noexcept;

  [[nodiscard]] std::string text() const;
  [[nodiscard]] Status check() const;
  [[nodiscard]] int count() const noexcept { return 4 * static_cast<int>(tags.size()); }
  [[nodiscard]] std::vector<int> ids() const;
  [[nodiscard]] std::vector<Eigen::Vector3d> points() const;
  [[nodiscard]] std::optional<std::size_t> index_of(int id) const noexcept;
  [[nodiscard]] std::vector<int> neighbours(int id) const;
  [[nodiscard]] double cell_size(int id) const noexcept;
  [[nodiscard]] BoardArea extent() const;
  // A cell is left around the tags.
  [[nodiscard]] BoardArea outline() const;
  [[nodiscard]] std::vector<Relabelling> symmetries() const { return {}; }
  // Where both have a tag: the same one cannot be of two boards.
  [[nodiscard]] bool looks_like(const TagList& other) const noexcept;

  friend bool operator==(const TagList&, const TagList&) = default;
};

}  // namespace calvin
