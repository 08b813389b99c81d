// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which corners of a board the corners of a lattice are, by the code between them.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/detect/checkerboard/board_match.hpp"
#include "calvin/detect/checkerboard/code/blurred_markers.hpp"
#include "calvin/detect/checkerboard/code/code.hpp"
#include "calvin/detect/checkerboard/lattice.hpp"
#include "calvin/target/grid.hpp"

namespace calvin::detect {

// Tells each node of a lattice that is a board with dots what is on its edges.
void set_dots(const Code& code, const GridAlignment& alignment, Lattice& lattice);

// How many of the bits that were seen lie in a part of a lattice, by a table of sums over all
// rectangles that begin in the first cell: no more of them can speak for a place of the board.
class BitArea {
 public:
  void set(std::span<const CodeBit> bits);

  // Of the bits in a range of cells, which may reach beyond them on any side.
  [[nodiscard]] int within(const CellRange& range) const;

 private:
  // The bits in rows and columns before these, from the first cell on.
  [[nodiscard]] int& before(int cols, int rows) {
    return sums_[static_cast<std::size_t>(rows * (cells_.cols() + 1) + cols)];
  }
  [[nodiscard]] int before(int cols, int rows) const {
    return sums_[static_cast<std::size_t>(rows * (cells_.cols() + 1) + cols)];
  }

  CellRange cells_;  // of the bits
  std::vector<int> sums_;
};

// Keeps its memory.
class CodeMatch {
 public:
  // As match_board() in board_match.hpp, for a board with a code: no labelling is ambiguous.
  // kWrongBoard for one of which the code says that it is larger, and for a whole grid without this
  // code.
  [[nodiscard]] Match match(const ImageView& image, const Grid& grid, const Code& code,
                            Lattice& lattice);

 private:
  // How many bits of each family were seen, and how many of them were as they are on the board.
  struct Count {
    std::array<int, Code::kFamilies> seen{};
    std::array<int, Code::kFamilies> right{};
    int light = 0;  // of those that were right
    int markers = 0;
    int wrong_markers = 0;  // of them
    // The marker whose bits are being counted: those of a cell follow each other.
    struct {
      Cell cell;
      int seen = 0;  // bits
      int right = 0;
    } marker;
    void end_marker();
    [[nodiscard]] double evidence(const Code& code) const;
  };
  // The bits as they are on a board that lies turned by so many quarters.
  struct TurnedBits {
    std::vector<CodeBit> bits;
    BitArea area;
  };
  // A way to lay the board over the lattice, and how sure it is.
  struct Candidate {
    GridAlignment alignment;
    double evidence = 0;
  };
  [[nodiscard]] static Count count(const Code& code, std::span<const CodeBit> turned, Cell shift);
  [[nodiscard]] Match another_board(const ImageView& image, const Grid& grid, const Code& code,
                                    const Lattice& lattice) const;
  void turn(const Code& code);
  [[nodiscard]] const TurnedBits& turned(const GridAlignment& alignment) const;
  // How many of the turned bits lie on the board.
  [[nodiscard]] int bits_within(const Code& code, const GridAlignment& alignment) const;
  void add_candidate(const GridAlignment& alignment, double evidence);
  [[nodiscard]] bool is_convincing() const;
  void compare(const Grid& grid, const Code& code, const Lattice& lattice);
  void compare_blurred(const ImageView& image, const Grid& grid, const Code& code,
                       const Lattice& lattice);

  std::vector<CodeBit> bits_;
  std::array<TurnedBits, 4> turned_;
  BlurredMarkers blurred_;
  Candidate best_;
  double next_best_ = 0;  // evidence
  int candidates_ = 0;
};

}  // namespace calvin::detect
