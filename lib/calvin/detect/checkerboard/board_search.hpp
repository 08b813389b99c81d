// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Lattices of corners in one level of an image pyramid.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/detect/checkerboard/corner_graph.hpp"
#include "calvin/detect/checkerboard/corners/corner.hpp"
#include "calvin/detect/checkerboard/corners/saddle_points.hpp"
#include "calvin/detect/checkerboard/lattice.hpp"

namespace calvin::detect {

// The limits of a search.
struct SearchOptions {
  std::uint8_t threshold = 5;             // least response of a corner, grey levels
  int most_points = 600;                  // peaks of the response that are looked at
  int least_nodes = 9;                    // of a lattice
  std::size_t most_groups = 4;            // lattices in an image
  float reach = 144;                      // px, the largest distance between neighbours
  Surroundings surroundings;              // of the corners of any board that is looked for
  std::vector<std::vector<Pixel>> taken;  // convex polygons in which corners are left out
};

// Keeps its memory.
class BoardSearch {
 public:
  // Finds the corners of an image (of step 1), which has to stay until the last lattice, and who is
  // whose neighbour.
  void detect_corners(const ImageView& image, const SearchOptions& options);

  // Moves to the next lattice of at least `least_nodes` corners, the largest first, its stray
  // corners removed; false where none is left.
  [[nodiscard]] bool next(Lattice& lattice);
  // How many corners were found, of lattices and of nothing.
  [[nodiscard]] int corners() const { return static_cast<int>(corners_.size()); }
  // How many corners the next lattice links; 0 where none is left.
  [[nodiscard]] int next_size() const {
    return next_group_ < groups_.size() ? groups_[next_group_].size : 0;
  }
  // The box around all corners that are linked with the current lattice, also those beyond its
  // reach.
  [[nodiscard]] const Box& box() const { return groups_[next_group_ - 1].box; }

  // Adds the nodes that are missing inside of a lattice and next to it, until it has `enough`. With
  // `guessing`, also nodes that cannot be seen but have neighbours on two sides.
  static void complete(const ImageView& image, Lattice& lattice, int enough, bool guessing);

 private:
  struct Group {
    int first = 0;  // corner
    int size = 0;
    Box box;
  };
  void find_groups();
  // Of the corners of a group, where the lines of a board are not alike far apart: the one whose
  // links tell best which are the longer steps.
  [[nodiscard]] int clearest_corner() const;
  void fill(const Group& group, Lattice& lattice);

  ImageView image_;  // of detect_corners()
  SearchOptions options_;
  SaddleSearch saddle_search_;
  CornerGraph graph_;
  std::vector<Corner> corners_;
  std::vector<Group> groups_;
  std::size_t next_group_ = 0;
  std::vector<int> queue_;
  std::vector<bool> seen_;
  std::vector<Cell> cell_;
};

}  // namespace calvin::detect
