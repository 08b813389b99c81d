// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A sheet of a board that was found in a picture: several may show the same board.
#pragma once

#include <cstddef>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/detect/checkerboard/board_match.hpp"
#include "calvin/detect/checkerboard/fits/fit_grid.hpp"
#include "calvin/detect/checkerboard/lattice.hpp"
#include "calvin/target/grid.hpp"

namespace calvin::detect {

// The lattice and the fits are in px of the image.
struct Sheet {
  Sheet(int reach, const Surroundings& surroundings) : lattice(reach, surroundings) {}

  std::size_t wanted = 0;  // which of the boards that are looked for it shows
  bool searched = false;   // found by a search of the whole image, not where it was predicted
  bool whole = false;      // every corner of the board was found
  Lattice lattice;
  FitGrid fits;
  GridAlignment alignment;
  Observation observation;     // the corners alone
  std::vector<Pixel> outline;  // px, see outline_of()

  [[nodiscard]] Pixel center() const;  // px, of its corners
};

// A convex polygon, px, around the corners of a sheet and about half a square more: no corner of
// another sheet is in it.
[[nodiscard]] std::vector<Pixel> outline_of(const Observation& corners, const Grid& grid);

// The polygon in px of a level of the pyramid.
[[nodiscard]] std::vector<Pixel> in_level(const std::vector<Pixel>& outline, int level);

// Whether a lattice, in px of a level, belongs to a sheet: it lies on the sheet, or it goes on with
// the grid of a sheet that something hides in part.
[[nodiscard]] bool is_of_sheet(const Sheet& sheet, const Lattice& lattice, int level);

}  // namespace calvin::detect
