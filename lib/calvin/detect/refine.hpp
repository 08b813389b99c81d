// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Corners to a fraction of a pixel, and the lattice as a whole as the judge of each.
#pragma once

#include <optional>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/detect/lattice.hpp"
#include "calvin/detect/pyramid.hpp"
#include "calvin/detect/saddle_fit.hpp"

namespace calvin::detect {

// A fit of each node of a lattice. Keeps its memory.
class Refinement {
 public:
  // Takes a lattice from px of a level of the pyramid to px of the image. Its nodes are fitted in
  // the level first, if so wished; guessed ones are left behind.
  void to_image(const Pyramid& pyramid, int level, Lattice& lattice, bool fitted);

  // Removes the guessed nodes of a lattice that are no corners of the image.
  void look_at_guesses(const ImageView& image, Lattice& lattice);

  // Fits every node in the image; removes those that do not stand the test. False where most fall.
  [[nodiscard]] bool refine(const ImageView& image, Lattice& lattice);

  [[nodiscard]] const SaddleFit& at(Cell c) const { return fits_[index(c)]; }

 private:
  void begin(const Lattice& lattice);
  [[nodiscard]] std::size_t index(Cell c) const {
    return static_cast<std::size_t>((c.row - extent_.first.row) * extent_.cols() + c.col -
                                    extent_.first.col);
  }
  SaddleFit& fit(Cell c) { return fits_[index(c)]; }
  [[nodiscard]] SaddleFit first_fit(const ImageView& image, const Lattice& lattice, Cell c) const;
  [[nodiscard]] SaddleFit last_fit(const ImageView& image, const Lattice& lattice, Cell c) const;
  void set_bends(const Lattice& lattice);
  void set_slopes(const Lattice& lattice);
  void drop_misfits(Lattice& lattice);

  Extent extent_;
  std::vector<SaddleFit> fits_;
  float usual_noise_ = 0;  // the median, of the contrast
  std::vector<float> sorted_;
};

}  // namespace calvin::detect
