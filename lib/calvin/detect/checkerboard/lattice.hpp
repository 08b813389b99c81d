// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Corners in rows and columns, some of them missing: a flat array around the first one. The lines
// of a lattice are alike far apart, or two steps of different lengths follow each other in turn.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "calvin/detect/checkerboard/corners/corner.hpp"
#include "calvin/detect/checkerboard/surroundings.hpp"
#include "calvin/detect/surface.hpp"

namespace calvin::detect {

// A corner that has a place in a lattice. `along` and `down` are the directions of its edges
// towards the next corner of the row and of the column; cross(along, down) > 0.
struct Node {
  float x = 0;
  float y = 0;
  Direction along;
  Direction down;
  float contrast = 0;  // grey levels
  float width = 1;     // px, the blur of the edges as far as known
  float sigma = 0;     // px, of the place, once it was fitted
  float misfit = 0;    // of the last prune(), in parts of the spacing
  // Of the edges towards the next corners around, as in kAround: 1 where there is a light dot, -1
  // where there is a dark one, 0 where there is none or nobody knows.
  std::array<std::int8_t, 4> dots{};
  bool used = false;
  bool guessed = false;  // lies where its neighbours let it expect, and was not looked at yet
  bool refused = false;  // was looked at and is no corner, see Lattice::refuse()
};

struct Cell {
  int col = 0;
  int row = 0;
  friend Cell operator+(Cell a, Cell b) { return {a.col + b.col, a.row + b.row}; }
  friend Cell operator-(Cell a, Cell b) { return {a.col - b.col, a.row - b.row}; }
  friend bool operator==(const Cell&, const Cell&) = default;
};
[[nodiscard]] inline Cell operator*(int s, Cell c) { return {s * c.col, s * c.row}; }
inline constexpr std::array<Cell, 4> kAround = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

// Where a node is expected.
struct Expected {
  float x = 0;
  float y = 0;
  float spacing = 0;  // px to the nearest next line, by the nodes that it is expected from
};

// The range of columns and rows of nodes, both ends included; empty where first > last.
struct CellRange {
  Cell first = {0, 0};
  Cell last = {-1, -1};
  [[nodiscard]] int cols() const { return last.col - first.col + 1; }
  [[nodiscard]] int rows() const { return last.row - first.row + 1; }
};

// A part of an image, px.
struct Box {
  float left = 0;
  float top = 0;
  float right = -1;
  float bottom = -1;

  void add(float x, float y) {
    const bool first = right < left;
    left = first ? x : std::min(left, x);
    right = first ? x : std::max(right, x);
    top = first ? y : std::min(top, y);
    bottom = first ? y : std::max(bottom, y);
  }
};

class Lattice {
 public:
  // Nodes up to `reach` rows and columns from the first one.
  explicit Lattice(int reach, const Surroundings& surroundings = {});

  [[nodiscard]] const Surroundings& surroundings() const { return surroundings_; }
  void set_blurred(bool blurred) { surroundings_.blurred = blurred; }

  // Whether the step from column 0 to column 1 is the longer one, where steps differ. Where columns
  // are farther apart after an even one, rows are so after an odd one: a square between four even
  // nodes is bright, and not as wide as it is high.
  void set_long_first(bool long_first) {
    shift_ = long_first ? 1 - surroundings_.gap : surroundings_.gap - 1;
  }
  [[nodiscard]] bool has_even_steps() const { return surroundings_.gap == 1; }
  // In mean steps: odd columns are shifted from the middle between even ones, odd rows as far the
  // other way.
  [[nodiscard]] float place(int line, bool is_col) const {
    const float shift = is_col ? shift_ : -shift_;
    return static_cast<float>(line) + ((line & 1) != 0 ? shift : 0);
  }
  [[nodiscard]] LatticePlace place(Cell c) const {
    return {static_cast<double>(place(c.col, true)), static_cast<double>(place(c.row, false))};
  }
  // The length of a step of one cell along a line, in mean steps.
  [[nodiscard]] float length(Cell from, Cell step) const {
    if (has_even_steps()) return 1;
    return step.row == 0 ? std::abs(place(from.col + step.col, true) - place(from.col, true))
                         : std::abs(place(from.row + step.row, false) - place(from.row, false));
  }

  void clear();
  [[nodiscard]] bool in_reach(Cell c) const {
    return c.col >= -reach_ && c.col <= reach_ && c.row >= -reach_ && c.row <= reach_;
  }
  [[nodiscard]] bool has(Cell c) const { return in_reach(c) && nodes_[index(c)].used; }
  [[nodiscard]] const Node& at(Cell c) const { return nodes_[index(c)]; }
  [[nodiscard]] Node& at(Cell c) { return nodes_[index(c)]; }
  void put(Cell c, const Node& node);
  void remove(Cell c);
  // Removes a node and remembers that there is no corner where it lay.
  void refuse(Cell c);
  // Whether a node was refused about where another one is expected in its cell.
  [[nodiscard]] bool was_refused(Cell c, const Expected& at) const;
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] CellRange extent() const;  // of the nodes that are there

  // Whether a corner of a cell's colours has its bright square between +along and +down; else
  // between -along and +down. The first node put decides for all.
  [[nodiscard]] static bool is_even(Cell c) { return ((c.col + c.row) & 1) == 0; }

  // Where the nodes around a cell let its node be expected. Absent where too few are there.
  [[nodiscard]] std::optional<Expected> expect(Cell c) const;

  // Removes, worst first, nodes that lie further than `share` of the spacing from where they are
  // expected; then nodes that have fewer than two neighbours.
  void prune(float share);

  template <typename F>
  void for_each(F f) const {
    const CellRange e = touched_;  // as it is before `f` puts any
    for (int row = e.first.row; row <= e.last.row; ++row) {
      for (int col = e.first.col; col <= e.last.col; ++col) {
        if (has({col, row})) f(Cell{col, row}, at({col, row}));
      }
    }
  }

 private:
  [[nodiscard]] std::size_t index(Cell c) const {
    return static_cast<std::size_t>((c.row + reach_) * (2 * reach_ + 1) + c.col + reach_);
  }
  [[nodiscard]] int neighbours(Cell c) const;
  [[nodiscard]] float misfit(Cell c) const;
  struct Votes;
  void add_extrapolation(Cell c, Cell step, Votes& votes) const;

  int reach_;
  Surroundings surroundings_;
  float shift_ = 0;  // mean steps, of odd columns
  int count_ = 0;
  CellRange touched_;  // all nodes lie within; removing does not shrink it
  std::vector<Node> nodes_;
};

}  // namespace calvin::detect
