// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Polynomial surfaces over all nodes of a lattice.
#pragma once

#include <span>

#include "calvin/detect/checkerboard/lattice.hpp"
#include "calvin/detect/surface.hpp"

namespace calvin::detect {

// A place so many mean steps along the way of a step, or behind.
[[nodiscard]] inline LatticePlace moved(const LatticePlace& from, Cell step, double by) {
  return {from.col + by * step.col, from.row + by * step.row};
}

// A surface without values.
template <int kDegree>
[[nodiscard]] Surface<kDegree> flat(const Lattice& lattice) {
  const CellRange extent = lattice.extent();
  return {lattice.place(extent.first), lattice.place(extent.last)};
}

template <int kDegree>
[[nodiscard]] Surface<kDegree> surface_over(const Lattice& lattice,
                                            std::span<const PlacedValue> values, double variance) {
  const Surface<kDegree> none = flat<kDegree>(lattice);
  Surface<kDegree> all = none;
  for (const PlacedValue& v : values) all.add(v);
  return surface_through<kDegree>(none, all, values, variance);
}

}  // namespace calvin::detect
