// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Corners to a fraction of a pixel: fits of all nodes of a lattice, tested against each other.
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/detect/checkerboard/corners/saddle_fit.hpp"
#include "calvin/detect/checkerboard/fits/fit_grid.hpp"
#include "calvin/detect/checkerboard/fits/node_fit.hpp"
#include "calvin/detect/checkerboard/fits/stray_corners.hpp"
#include "calvin/detect/checkerboard/lattice.hpp"
#include "calvin/detect/pyramid.hpp"

namespace calvin::detect {

// A fit of each node of a lattice. Keeps its memory.
class Refinement {
 public:
  // Takes a lattice from px of a level of the pyramid to px of the image. With `fitted`, its nodes
  // are fitted in the level first; guessed nodes are removed.
  void to_image(const Pyramid& pyramid, int level, Lattice& lattice, bool fitted);

  // Whether the four outermost nodes of a whole board are corners of the image. Moves all other
  // nodes along with them.
  [[nodiscard]] bool confirm(const ImageView& image, Lattice& lattice) const;

  // Fits every node in the image; removes nodes that fail the tests, of the fit by itself and
  // beside the other nodes of its row and column. False where most nodes fail. `board`: the cells
  // of a board of which nearly all is there; in noise, its corners are looked for where they were
  // not seen, too.
  [[nodiscard]] bool refine(const ImageView& image, Lattice& lattice,
                            std::span<const Cell> board = {});

  // refine() for a lattice that lies as the lattice of the fits `before` did in the frame before,
  // to a pixel or so. False where a node fails.
  [[nodiscard]] bool refine_again(const ImageView& image, const FitGrid& before, Lattice& lattice);

  // Fits a node that was added to a refined lattice beside another one, `near`, as the others were
  // fitted last. False where it is not like them.
  [[nodiscard]] bool add(const ImageView& image, Cell c, Cell near, Lattice& lattice);

  // Whether noise is so strong that corners are told with the help of their neighbours only.
  [[nodiscard]] bool in_noise() const { return in_noise_; }

  // Fits a node that was put into a refined lattice, not in noise, beside one that has a fit,
  // `near`: with its bends, in as large a window. False where that is no corner like the others.
  [[nodiscard]] bool add(const ImageView& image, const Lattice& lattice, Cell c, Cell near);

  // The last fits once more, as nodes that were added tell how the edges bend at the ends of lines;
  // of these, nodes that fail are removed. False where another one fails; all is as it was then.
  [[nodiscard]] bool refine_added(const ImageView& image, std::span<const Cell> added,
                                  Lattice& lattice);

  [[nodiscard]] const FitGrid& fits() const { return fits_; }

  [[nodiscard]] const SaddleFit& at(Cell c) const { return fits_.at(c); }

  // Makes all sigmas of a refined lattice so many times larger.
  void widen(float factor, Lattice& lattice) {
    lattice.for_each([&](Cell c, const Node& /*node*/) {
      fit(c).sigma *= factor;
      lattice.at(c).sigma *= factor;
    });
  }

  // Makes the sigmas at the ends of lines that are cut off contain how uncertain bends are there.
  void widen_ends(Lattice& lattice) {
    detect::widen_ends(lattice, fits_);
    lattice.for_each([&](Cell c, const Node& /*node*/) { lattice.at(c).sigma = fit(c).sigma; });
  }

  // The blur of the edges of a refined lattice, px, 1 sigma: the median over its nodes, of the
  // edges along rows or along columns, whichever is larger.
  [[nodiscard]] double blur(const Lattice& lattice);

 private:
  static constexpr float kLeastSwingShare = 0.25F;  // of the median
  static constexpr float kNoisy = 1.5F;         // of the median: something else is in the window
  static constexpr float kMostResidual = 0.9F;  // of the contrast

  void begin(const Lattice& lattice);
  // Fits the nodes roughly, in px of a level of the pyramid.
  void fit_in_level(const ImageView& level, const Lattice& lattice);
  SaddleFit& fit(Cell c) { return fits_.at(c); }
  [[nodiscard]] SaddleFit last_fit(const ImageView& image, const Lattice& lattice, Cell c) const;
  [[nodiscard]] Slack slack(const Lattice& lattice);
  // Whether first fits tell so little that what neighbours let expect has to help.
  [[nodiscard]] bool is_in_noise(const Lattice& lattice);
  // The last fits of a lattice in noise, from where its nodes were found.
  void refine_in_noise(const ImageView& image, Lattice& lattice);
  // `sigma`: px, of the place, which is not expected with 0.
  [[nodiscard]] SaddleFit expected_fit(const ImageView& image, const Lattice& lattice, Cell c,
                                       float sigma = 0) const;
  // Fits all nodes by fit_again(cell), moves them there and removes nodes that fail the tests.
  template <typename F>
  void refit(Lattice& lattice, F fit_again) {
    lattice.for_each([&](Cell c, const Node& /*node*/) {
      fit(c) = fit_again(c);
      if (!std::isfinite(fit(c).noise)) lattice.remove(c);
    });
    drop_misfits(lattice);
    lattice.for_each([&](Cell c, const Node& /*node*/) { take(fit(c), lattice.at(c)); });
  }
  // Sets the bends of large squares anew by what windows of two sizes tell. False where that does
  // not matter.
  [[nodiscard]] bool correct_bends_in(const ImageView& image, Lattice& lattice);
  // The most noise of a corner, of the contrast.
  [[nodiscard]] float most_noise() const;
  void drop_misfits(Lattice& lattice);
  void drop_uncertain(Lattice& lattice);
  [[nodiscard]] SaddleFit lost_fit(const ImageView& image, const Lattice& lattice, Cell c,
                                   const SaddleFit& near, float sigma);
  // A corner that the lattice has not.
  struct Lost {
    Cell cell;
    bool seen = false;  // and lost in the fits
    Pixel place;        // where it is expected, in noise alone
    float sigma = 0;    // px, of that
  };
  [[nodiscard]] std::vector<Lost> lost_corners(const Lattice& lattice, std::span<const Cell> board);
  // `usual_residual`: the median of the board's residuals, grey levels; 0 where it does not count.
  [[nodiscard]] bool is_recovered(const SaddleFit& f, const Lost& lost, const Node& node,
                                  float usual_residual) const;
  void recover(const ImageView& image, Lattice& lattice, const Lost& lost, float usual_residual);
  // Fits removed nodes once more where others predict them.
  void recover_lost(const ImageView& image, Lattice& lattice, std::span<const Cell> board);

  FitGrid fits_;
  FitGrid inner_fits_;          // in smaller windows
  std::vector<Cell> cells_;     // of the nodes to begin with
  std::vector<Cell> unfitted_;  // those whose fit in a smaller level has failed
  float usual_noise_ = 0;       // median of noise over contrast
  bool in_noise_ = false;
  float usual_along_ = 1;  // px, median width of the edges, in noise alone
  float usual_down_ = 1;
  StrayCorners stray_corners_;
};

}  // namespace calvin::detect
