// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A board as a scene: the polygon that a pixel covers is cut at the edges of the cells and at the
// rims of the discs. Internal.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "calvin/synth/cuts.hpp"
#include "calvin/synth/disc_index.hpp"
#include "calvin/synth/pixel_polygon.hpp"
#include "calvin/target/artwork/artwork.hpp"

namespace calvin::synth {

// What a place of the board plane shows.
enum class Ink : std::uint8_t { kDark, kLight, kBackground };

// The grey levels of a scene.
struct SceneLevels {
  double dark = 0;
  double light = 0;
  double background = 0;

  [[nodiscard]] double of(Ink ink) const noexcept {
    return ink == Ink::kDark ? dark : ink == Ink::kLight ? light : background;
  }
};

class Scene {
 public:
  // What a ray meets: a cell of the sheet, or one just outside of it; kNothing where it does not
  // meet the board plane.
  struct Cell {
    int col;
    int row;
    friend bool operator==(const Cell&, const Cell&) = default;
  };
  static constexpr int kNothing = -2;

  explicit Scene(const Artwork& artwork);

  [[nodiscard]] static Cell nothing() { return {kNothing, kNothing}; }
  [[nodiscard]] Cell cell_at(double x, double y) const { return {x_.cell_of(x), y_.cell_of(y)}; }

  // `corners` returns the PixelCorners of the pixel that sees these cells.
  template <typename Corners>
  [[nodiscard]] double mean(const SceneLevels& levels, const Corners& corners,
                            const std::array<Cell, 4>& seen) const {
    if (seen[0] == seen[1] && seen[0] == seen[2] && seen[0] == seen[3] && is_one_ink(seen[0])) {
      return levels.of(ink(seen[0]));
    }
    return mean_of_parts(levels, corners(), seen);
  }

 private:
  // Cells that a pixel may touch, the last ones included.
  struct CellRange {
    int left, top, right, bottom;
  };
  using Discs = std::span<const Artwork::Disc* const>;

  [[nodiscard]] Ink ink(Cell cell) const {
    if (cell.col == kNothing) return Ink::kBackground;
    return inks_[static_cast<std::size_t>(cell.row + 1) * stride_ +
                 static_cast<std::size_t>(cell.col + 1)];
  }
  // Whether a cell has no discs over it.
  [[nodiscard]] bool is_one_ink(Cell cell) const {
    return discs_.is_empty() || ink(cell) == Ink::kBackground;
  }
  [[nodiscard]] bool is_one_ink(const CellRange& range) const;
  [[nodiscard]] double mean_of_parts(const SceneLevels& levels, const PixelCorners& corners,
                                     const std::array<Cell, 4>& seen) const;
  [[nodiscard]] double mean_of_discs(const SceneLevels& levels, const Polygon& polygon,
                                     const CellRange& range, Discs discs) const;
  [[nodiscard]] double mean_of_cells(const SceneLevels& levels, const Polygon& polygon,
                                     const CellRange& range) const;
  [[nodiscard]] double mean_of_column(const SceneLevels& levels, Polygon column, int col, int top,
                                      int bottom) const;

  Cuts x_;
  Cuts y_;
  std::size_t stride_;
  std::vector<Ink> inks_;  // of the cells of the sheet, and of a ring of background around it
  DiscIndex discs_;
};

}  // namespace calvin::synth
