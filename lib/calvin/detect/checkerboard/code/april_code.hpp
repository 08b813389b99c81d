// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The tags of an AprilGrid.
#pragma once

#include "calvin/detect/checkerboard/code/code.hpp"
#include "calvin/detect/checkerboard/code/marker_reader.hpp"
#include "calvin/target/april_grid.hpp"

namespace calvin::detect {

// The bits of a cell are those of the tag of which its corner is the upper left one, in rows.
class AprilCode final : public Code {
 public:
  explicit AprilCode(const AprilGrid& board);

  void read(const ImageView& image, const Lattice& lattice,
            std::vector<CodeBit>& bits) const override;
  [[nodiscard]] CodePlace turned(const CodePlace& at, int quarter) const override;
  [[nodiscard]] const MarkerShape* markers() const override { return &shape_; }
  // Where the lines of the lattice are farther apart both ways.
  [[nodiscard]] bool may_hold_marker(const Lattice& lattice, Cell at) const override {
    return lattice.length(at, {1, 0}) > 1 && lattice.length(at, {0, 1}) > 1;
  }
  // With another first tag, or with other columns and rows.
  [[nodiscard]] std::optional<Board> other_board(const ImageView& image, const Lattice& lattice,
                                                 std::span<const CodeBit> bits,
                                                 bool whole) const override;
  // The grid of tags of this family that bits are of, with the measures of this one.
  [[nodiscard]] std::optional<AprilGrid> grid_of(std::span<const CodeBit> bits) const;

 private:
  AprilGrid board_;
  MarkerShape shape_;
};

}  // namespace calvin::detect
