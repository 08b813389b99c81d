// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Corners to a fraction of a pixel, and the lattice as a whole as the judge of each.
#pragma once

#include <optional>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/detect/fit_grid.hpp"
#include "calvin/detect/lattice.hpp"
#include "calvin/detect/pyramid.hpp"
#include "calvin/detect/saddle_fit.hpp"
#include "calvin/detect/stray_corners.hpp"

namespace calvin::detect {

// A fit of each node of a lattice. Keeps its memory.
class Refinement {
 public:
  // Takes a lattice from px of a level of the pyramid to px of the image. Its nodes are fitted in
  // the level first, if so wished; guessed ones are left behind.
  void to_image(const Pyramid& pyramid, int level, Lattice& lattice, bool fitted);

  // Removes the guessed nodes of a lattice that are no corners of the image.
  void look_at_guesses(const ImageView& image, Lattice& lattice);

  // Whether the outermost nodes of a whole board are corners of the image: a quick look. Moves the
  // others along with them.
  [[nodiscard]] bool confirm(const ImageView& image, Lattice& lattice) const;

  // Fits every node in the image; removes those that do not stand the test, each by itself and
  // beside the others of its row and column. False where most fall.
  [[nodiscard]] bool refine(const ImageView& image, Lattice& lattice);

  // The same for a lattice that lies as the one with these fits did in the frame before, to a pixel
  // or so. False where a node falls.
  [[nodiscard]] bool refine_again(const ImageView& image, const FitGrid& before, Lattice& lattice);

  [[nodiscard]] const FitGrid& fits() const { return fits_; }

  [[nodiscard]] const SaddleFit& at(Cell c) const { return fits_.at(c); }

  // Of the edges of a refined lattice, px, 1 sigma: across the direction in which it is larger, in
  // the median.
  [[nodiscard]] double blur(const Lattice& lattice);

 private:
  void begin(const Lattice& lattice);
  SaddleFit& fit(Cell c) { return fits_.at(c); }
  [[nodiscard]] SaddleFit quick_fit(const ImageView& image, const Lattice& lattice, Cell c,
                                    float radius, float width, int steps) const;
  [[nodiscard]] SaddleFit first_fit(const ImageView& image, const Lattice& lattice, Cell c) const;
  [[nodiscard]] SaddleFit last_fit(const ImageView& image, const Lattice& lattice, Cell c) const;
  // Puts the fits in the place of the lattice's nodes and removes those that do not stand the test.
  template <typename F>
  void improve(Lattice& lattice, F fit_again);
  void drop_misfits(Lattice& lattice);
  void drop_uncertain(Lattice& lattice);
  // Fits those nodes once more that were lost though their neighbours tell where they are.
  void look_again(const ImageView& image, Lattice& lattice);

  FitGrid fits_;
  std::vector<Cell> cells_;  // the nodes to begin with
  float usual_noise_ = 0;    // the median, of the contrast
  StrayCorners stray_corners_;
};

}  // namespace calvin::detect
