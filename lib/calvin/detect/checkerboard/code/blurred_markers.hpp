// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What all markers of a board say together about where it lies, where blur has run the bits of each
// into one another.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/detect/checkerboard/board_match.hpp"
#include "calvin/detect/checkerboard/code/code.hpp"
#include "calvin/detect/checkerboard/lattice.hpp"

namespace calvin::detect {

// Keeps its memory.
class BlurredMarkers {
 public:
  // Takes the markers of the squares that a lattice has all corners of; none where they are too few
  // to tell what is common to all of them.
  void take(const ImageView& image, const Lattice& lattice, const Code& code);

  // nats: how unlikely markers with random bits are to look so much like those of a board that lies
  // in a way, by Hoeffding's bound. 0 where some markers contradict the others: of another board of
  // the same markers, some lie as they do on this one.
  [[nodiscard]] double evidence(const Code& code, const GridAlignment& alignment) const;

 private:
  // Of the markers that lie on a board in a way.
  struct Sum {
    int markers = 0;
    double right = 0;    // the weights of light bits, less those of dark ones
    double squares = 0;  // of that of each marker
  };

  void read(const ImageView& image, const Lattice& lattice, const Code& code);
  void weigh();
  [[nodiscard]] Sum compare(const Code& code, const GridAlignment& alignment) const;
  [[nodiscard]] std::size_t bits() const { return weights_.size() / squares_.size(); }

  std::vector<Cell> squares_;   // of the markers that were read
  std::vector<float> weights_;  // of the bits of each marker, in rows: the lighter, the larger
  // Where the bits are on a board that lies turned by so many quarters.
  std::array<std::vector<CodePlace>, 4> turned_;
};

}  // namespace calvin::detect
