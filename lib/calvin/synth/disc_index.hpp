// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The discs of an artwork by their places. Internal.
#pragma once

#include <cstddef>
#include <vector>

#include "calvin/target/artwork/artwork.hpp"

namespace calvin::synth {

// A raster over the board, in each square of which the discs that reach into it are listed.
class DiscIndex {
 public:
  explicit DiscIndex(std::vector<Artwork::Disc> discs);
  DiscIndex(const DiscIndex&) = delete;  // it points to its own discs
  DiscIndex& operator=(const DiscIndex&) = delete;
  ~DiscIndex() = default;

  [[nodiscard]] bool is_empty() const noexcept { return discs_.empty(); }

  // Those whose bounding squares meet an area, the last painted first.
  void find(const BoardArea& area, std::vector<const Artwork::Disc*>& found) const;

 private:
  // A range of squares of the raster.
  struct Range {
    int left, top, right, bottom;
  };
  [[nodiscard]] Range range_of(const BoardArea& area) const noexcept;
  [[nodiscard]] std::size_t square(int col, int row) const noexcept {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols_) +
           static_cast<std::size_t>(col);
  }

  std::vector<Artwork::Disc> discs_;
  BoardArea area_;
  double step_ = 1;  // m
  int cols_ = 0;
  int rows_ = 0;
  std::vector<std::vector<const Artwork::Disc*>> squares_;
};

}  // namespace calvin::synth
