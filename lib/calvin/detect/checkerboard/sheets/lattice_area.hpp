// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where a lattice lies in the image.
#pragma once

#include "calvin/detect/checkerboard/lattice.hpp"
#include "calvin/detect/checkerboard/sheets/sheet.hpp"
#include "calvin/detect/pyramid.hpp"

namespace calvin::detect {

// Where a lattice lies in the image, and how large its squares are there about, px.
struct LatticeArea {
  Box box;
  float square = 0;

  LatticeArea() = default;
  // In px of a level.
  LatticeArea(const Lattice& lattice, int level);
  [[nodiscard]] bool meets(const Box& other) const;
  // Whether the middle of the other area lies in this one.
  [[nodiscard]] bool has_middle_of(const LatticeArea& other) const;
  // Whether the other area is likely a part of this one.
  [[nodiscard]] bool has(const LatticeArea& other) const;
};

}  // namespace calvin::detect
