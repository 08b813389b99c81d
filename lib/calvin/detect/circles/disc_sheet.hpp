// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The discs of one sheet at full resolution: fits of all of them, tested against each other, and
// the observation that comes of them.
#pragma once

#include <vector>

#include "calvin/core/observation.hpp"
#include "calvin/detect/circles/circle_pattern.hpp"
#include "calvin/detect/circles/disc_fit.hpp"
#include "calvin/detect/circles/disc_lattice.hpp"
#include "calvin/detect/maps/lens_map.hpp"

namespace calvin::detect {

// Which marks discs may have.
struct MarkKinds {
  bool rings = false;
  bool large = false;
};

// Fits the discs of a lattice, of which each lies to a part of its radius, in an image (of step 1);
// takes out those that are none and adds those that are missing within its extent.
class DiscSheet {
 public:
  // False where less than `least` discs are there. `marks`: those that there may be.
  [[nodiscard]] bool fit(const ImageView& image, const DiscLattice& lattice, int least,
                         const MarkKinds& marks);
  // Adds discs one step beyond the extent; false where there are none.
  [[nodiscard]] bool grow(const ImageView& image);

  // False for the squares of a checkerboard.
  [[nodiscard]] bool are_round(const ImageView& image) const;

  // Whether a lattice may be one of discs, by some of them: far quicker than a fit of all, where
  // there are none.
  [[nodiscard]] static bool may_be_discs(const ImageView& image, const DiscLattice& lattice);

  // What the discs show, of the board or not.
  [[nodiscard]] const DiscLattice& lattice() const { return lattice_; }
  [[nodiscard]] std::vector<SeenMark> marks(const ImageView& image) const;

  // Fits every disc once more with what its neighbours tell; the control points of the board are
  // the images of the discs' centres. Without control points where the discs do not lie on one
  // sheet.
  [[nodiscard]] Observation observe(const ImageView& image, const CirclePattern& pattern,
                                    const CellMap& map);

 private:
  struct Fitted {
    Cell cell;
    DiscFit fit;
  };
  void fit_one(const ImageView& image, Cell cell, const Ellipse& start, bool is_ring);
  void add_missing(const ImageView& image, int around);
  // Adds what is missing of a board.
  void complete(const ImageView& image, const CirclePattern& pattern, const CellMap& map);
  [[nodiscard]] bool add_expected(const ImageView& image, Cell cell,
                                  const DiscLattice::Expectation& expected, DiscMark mark);
  void drop_unlike();
  // Of the discs, in their order.
  struct Places {
    std::vector<Pixel> board;  // steps
    std::vector<Pixel> image;  // px
  };
  [[nodiscard]] Places places(const CirclePattern& pattern, const CellMap& map) const;
  // How far rims leave their ellipses as squares do, in the median, of what discs may have.
  [[nodiscard]] double squareness(const ImageView& image) const;
  bool drop_strays(const Places& at, const LensMap& lens);
  [[nodiscard]] std::vector<Pixel> centres(const CirclePattern& pattern, const CellMap& map,
                                           const Pixel& middle);
  // The slope of the light at a disc, by the lighter grey level of those around it.
  void set_slope(Fitted& disc) const;

  MarkKinds may_be_;
  double usual_width_ = DiscFit().width;  // px, of the last disc that was fitted
  DiscLattice lattice_{0};
  std::vector<Fitted> discs_;
};

}  // namespace calvin::detect
