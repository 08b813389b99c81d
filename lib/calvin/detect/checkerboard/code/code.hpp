// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The code that is printed on a board and names its corners: what it is where, and how it is read
// where the corners of a lattice let it be expected. No marker is searched in the picture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/detect/checkerboard/lattice.hpp"
#include "calvin/target/board.hpp"

namespace calvin::detect {

struct MarkerShape;

// A bit of a code: the how manieth of those that belong to a cell. On a board, cells are counted as
// control points are.
struct CodePlace {
  Cell cell;
  int index = 0;
};

// A bit that was seen in a cell of a lattice.
struct CodeBit {
  CodePlace at;
  bool light = false;
};

class Code {
 public:
  Code(const Code&) = delete;
  Code& operator=(const Code&) = delete;
  virtual ~Code() = default;

  // Reads what a picture shows of the code; bits that are neither light nor dark are left out.
  // Appends to `bits`.
  virtual void read(const ImageView& image, const Lattice& lattice,
                    std::vector<CodeBit>& bits) const = 0;

  // The same bit about the node of cell {0, 0}, where the x of its board runs along +col, +row,
  // -col, -row of the lattice.
  [[nodiscard]] virtual CodePlace turned(const CodePlace& at, int quarter) const = 0;

  // Another board that a lattice is, by what is printed on it; `bits` are what was read of it.
  // `whole` where no line of corners can follow on any side. Lengths are those of the board of this
  // code. Absent where that is not certain.
  [[nodiscard]] virtual std::optional<Board> other_board(const ImageView& /*image*/,
                                                         const Lattice& /*lattice*/,
                                                         std::span<const CodeBit> /*bits*/,
                                                         bool /*whole*/) const {
    return std::nullopt;
  }

  // Which of its codes a bit belongs to: a PuzzleBoard has two of them.
  static constexpr std::size_t kFamilies = 2;
  [[nodiscard]] std::size_t family(int index) const {
    return static_cast<std::size_t>(index % families_);
  }

  // Whether the bits are dots: bit 0 between the corner of its cell and the next of the row, bit 1
  // between it and the next of the column.
  [[nodiscard]] virtual bool has_dots() const { return false; }

  // How the markers look that the board has in some of its squares; null where it has none.
  [[nodiscard]] virtual const MarkerShape* markers() const { return nullptr; }
  // Whether the square of a lattice may hold one whose upper left corner is the node of a cell.
  [[nodiscard]] virtual bool may_hold_marker(const Lattice& /*lattice*/, Cell /*at*/) const {
    return false;
  }

  // How many light bits have to be right: where nearly all are dark, a sheet without a code would
  // have most bits right.
  [[nodiscard]] virtual int fewest_light() const { return 0; }

  // Whether the square outside control point 0, up and to the left of it, is dark.
  [[nodiscard]] bool begins_dark() const { return begins_dark_; }

  // The cells outside of which there are no bits.
  [[nodiscard]] CellRange cells() const {
    return {{-kBeyond, -kBeyond}, {cols_ + kBeyond - 1, rows_ + kBeyond - 1}};
  }
  // 1 where the board has a light bit, -1 where it has a dark one, 0 where it has none.
  [[nodiscard]] int at(const CodePlace& place) const {
    const Cell c = place.cell;
    if (c.col < -kBeyond || c.row < -kBeyond || c.col >= cols_ + kBeyond ||
        c.row >= rows_ + kBeyond) {
      return 0;
    }
    return bits_[index(place)];
  }

 protected:
  static constexpr int kBeyond = 1;  // cells

  Code(const Grid& grid, int bits_of_cell, int families, bool begins_dark)
      : cols_(grid.cols),
        rows_(grid.rows),
        bits_of_cell_(bits_of_cell),
        families_(families),
        begins_dark_(begins_dark),
        bits_(static_cast<std::size_t>((grid.cols + 2 * kBeyond) * (grid.rows + 2 * kBeyond) *
                                       bits_of_cell)) {}

  void set(const CodePlace& place, bool light) {
    bits_[index(place)] = static_cast<std::int8_t>(light ? 1 : -1);
  }

 private:
  [[nodiscard]] std::size_t index(const CodePlace& place) const {
    const Cell c = place.cell;
    return static_cast<std::size_t>(((c.row + kBeyond) * (cols_ + 2 * kBeyond) + c.col + kBeyond) *
                                        bits_of_cell_ +
                                    place.index);
  }

  int cols_;
  int rows_;
  int bits_of_cell_;
  int families_;
  bool begins_dark_;
  std::vector<std::int8_t> bits_;
};

// Null for a board without a code.
[[nodiscard]] std::shared_ptr<const Code> code_of(const Board& board);

}  // namespace calvin::detect
