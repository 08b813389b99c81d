// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where a board will be in the next frame of a video.
#pragma once

#include <cstdint>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/detect/checkerboard/board_match.hpp"
#include "calvin/detect/checkerboard/fits/fit_grid.hpp"
#include "calvin/detect/checkerboard/lattice.hpp"
#include "calvin/detect/search_again.hpp"
#include "calvin/target/grid.hpp"

namespace calvin::detect {

// Follows the corners of a board that was seen whole, each at its own speed. A part of a board is
// not followed: what comes into view is better looked for. Keeps its memory.
class Tracker {
 public:
  explicit Tracker(const Grid& grid);

  // Takes a whole board with its fits in px of an image at `timestamp` ns (or kNoTimestamp), as it
  // was found by a search of the whole image or by following it.
  void remember(const Lattice& lattice, const FitGrid& fits, const GridAlignment& alignment,
                ImageSize size, std::uint64_t timestamp, bool searched);
  void forget() { frames_ = 0; }

  // Where the board is expected to be, its control point 0 in the cell {1, 0}. False where no board
  // was remembered, and once a second, when the whole image is to be searched.
  [[nodiscard]] bool predict(ImageSize size, std::uint64_t timestamp, Lattice& lattice) const;

  // The last fits of the predicted lattice; empty where the lattice lay otherwise when it was
  // fitted.
  [[nodiscard]] const FitGrid& fits() const { return fits_; }

 private:
  Grid grid_;
  ImageSize size_;
  int frames_ = 0;    // remembered in a row, up to 2
  int followed_ = 0;  // frames since the last search
  std::uint64_t searched_ = kNoTimestamp;
  std::uint64_t times_[2] = {kNoTimestamp, kNoTimestamp};  // the last one, the one before
  std::vector<Node> nodes_[2];                             // likewise, by control point
  FitGrid fits_;                                           // of the last one
};

}  // namespace calvin::detect
