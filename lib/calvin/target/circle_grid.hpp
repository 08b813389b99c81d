// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// CircleGrid: discs in columns and rows, some of which may be marks by which parts of the board are
// known; AsymmetricCircleGrid: discs of which every other row is shifted by half a disc.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/observation.hpp"
#include "calvin/core/result.hpp"
#include "calvin/target/grid.hpp"

namespace calvin {

// How a disc of a grid differs from the others.
enum class DiscMark { kNone, kRing, kLarge };

// Diameters, of the distance between discs that are next to each other. Detection needs none of
// them: they are what is printed.
inline constexpr double kDiscDiameter = 0.5;
inline constexpr double kLargeDiscDiameter = 0.75;
inline constexpr double kRingHole = 0.25;

// Control points are the centres of the discs. What the functions answer is said of Board, in
// target/board.hpp.
struct CircleGrid {
  int cols = 0;
  int rows = 0;
  double pitch = 0;              // m, from a centre to the next one
  std::vector<GridPlace> rings;  // discs with a hole, row by row
  std::vector<GridPlace> large;  // larger discs, row by row
  bool inverted = false;         // light discs on dark ground

  [[nodiscard]] DiscMark mark(GridPlace p) const noexcept;
  [[nodiscard]] bool has_marks() const noexcept { return !rings.empty() || !large.empty(); }

  [[nodiscard]] std::string text() const;
  [[nodiscard]] Status check() const;
  [[nodiscard]] Grid grid() const noexcept { return {cols, rows, pitch, 0}; }
  [[nodiscard]] BoardArea outline() const noexcept;
  [[nodiscard]] std::vector<Relabelling> symmetries() const;
  [[nodiscard]] bool looks_like(const CircleGrid& other) const noexcept;

  [[nodiscard]] CircleGrid with_cells_of(double side) const {
    return {cols, rows, side, rings, large, inverted};
  }

  friend bool operator==(const CircleGrid&, const CircleGrid&) = default;
};

// As OpenCV has it: disc `col` of row `row` is at x = (2 col + row % 2) pitch, y = row pitch; its
// id is row * cols + col.
struct AsymmetricCircleGrid {
  int cols = 0;           // discs in a row
  int rows = 0;           // of either kind
  double pitch = 0;       // m, from a row to the next
  bool inverted = false;  // light discs on dark ground

  // Row by row, as if rows were not shifted.
  [[nodiscard]] Grid unshifted() const noexcept { return {cols, rows, pitch, 0}; }
  [[nodiscard]] int count() const noexcept { return unshifted().count(); }
  // The centre of a disc, in pitches.
  [[nodiscard]] GridPlace half_steps(int id) const noexcept {
    const GridPlace p = unshifted().place(id);
    return {2 * p.col + p.row % 2, p.row};
  }

  [[nodiscard]] std::string text() const;
  [[nodiscard]] Status check() const;
  [[nodiscard]] std::vector<int> ids() const;
  [[nodiscard]] std::vector<Eigen::Vector3d> points() const;
  [[nodiscard]] std::optional<std::size_t> index_of(int id) const noexcept;
  [[nodiscard]] std::vector<int> neighbours(int id) const;
  [[nodiscard]] double cell_size(int id) const noexcept;
  [[nodiscard]] BoardArea extent() const noexcept;
  [[nodiscard]] BoardArea outline() const noexcept;
  [[nodiscard]] std::vector<Relabelling> symmetries() const;
  [[nodiscard]] bool looks_like(const AsymmetricCircleGrid& other) const noexcept {
    return cols == other.cols && rows == other.rows && inverted == other.inverted;
  }

  [[nodiscard]] AsymmetricCircleGrid with_cells_of(double side) const noexcept;

  friend bool operator==(const AsymmetricCircleGrid&, const AsymmetricCircleGrid&) = default;
};

}  // namespace calvin
